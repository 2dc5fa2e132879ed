"""`omega_turn turn` from the outside, beside a gait node that turns a fake robot."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator

import pytest
from processes import Process
from ros_graph import Graph, User
from sensor_msgs.msg import JointState
from turner import QUICK, FakeRobot, Turner, silence

from omega_turn_ros.nodes.gait_node import GaitNode

MakeTurner = Callable[..., Turner]
ENDED = 'commanded -45.0 deg, ended'


class Command:
    """`omega_turn turn` in a process of its own.

    Args:
        graph: the graph of the gait node.
        arguments: of the command.
    """

    def __init__(self, graph: Graph, *arguments: str) -> None:
        self._graph = graph
        command = [sys.executable, '-m', 'omega_turn_lab.cli', 'turn', *arguments]
        self.process = subprocess.Popen(
            [*command, '--namespace', graph.namespace],
            env={**os.environ, 'ROS_DOMAIN_ID': str(graph.domain_id)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def wait(self, patience: float = 60.0) -> tuple[int, str]:
        """Let the graph run until it ends; return its exit code and its last line."""
        self._graph.spin_until(lambda: self.process.poll() is not None, 'the command', patience)
        out, self.err = self.process.communicate()
        assert 'Traceback' not in self.err
        return self.process.returncode, (out or self.err).splitlines()[-1]


@pytest.fixture
def start(graph: Graph) -> Iterator[Callable[..., Command]]:
    """Starts commands that end with the test."""
    started: list[Command] = []

    def make(*arguments: str) -> Command:
        started.append(Command(graph, *arguments))
        return started[-1]

    yield make
    for command in started:
        command.process.kill()
        command.process.communicate()


def begin(turner: Turner, start: Callable[..., Command]) -> Command:
    """Start a turn of 90 deg and wait until its cycle is under way."""
    command = start('--deg', '90')
    turner.graph.spin_until(lambda: turner.user.remaining[-1:] not in ([], [0.0]), 'the turn')
    turner.wait_for_cycle()
    return command


def test_a_turn_that_ends_by_itself_is_told_with_the_measured_angle(
    make_turner: MakeTurner, start: Callable[..., Command]
) -> None:
    turner = make_turner(turns=True, heading_feedback='odom')
    code, said = start('--deg', '-45').wait()
    assert code == 0
    told = re.fullmatch(re.escape(ENDED) + r', odom measured (-\d+\.\d) deg', said)
    assert told and float(told[1]) == pytest.approx(-45.0, abs=1.1)
    assert turner.user.remaining[-2] != 0.0  # what was left, before the 0.0


def test_a_turn_without_odom_is_told_as_commanded(
    make_turner: MakeTurner, start: Callable[..., Command]
) -> None:
    turner = make_turner()
    turner.robot.spoil['odom'] = lambda message: None
    assert start('--deg', '-45').wait() == (0, ENDED)


def test_a_stop_under_way_is_an_error_that_says_what_was_left(
    make_turner: MakeTurner, start: Callable[..., Command]
) -> None:
    turner = make_turner()
    command = begin(turner, start)
    turner.user.call('gait_node/stop')
    code, said = command.wait()
    left = abs(float(re.findall(r'error: stopped with ([\d.]+) deg left', said)[0]))
    before = next(angle for angle in reversed(turner.user.remaining) if angle)
    assert code == 1 and left == pytest.approx(abs(before) * 57.2958, abs=0.06)


def test_corrections_used_up_are_an_error_that_says_what_was_left(
    make_turner: MakeTurner, start: Callable[..., Command]
) -> None:
    # A robot that never turns, whatever it does.
    make_turner(heading_feedback='odom', max_corrections=0)
    code, said = start('--deg', '20').wait(120.0)
    assert code == 1 and 'error: stopped with 20.0 deg left' in said


def test_a_jam_is_told(make_turner: MakeTurner, start: Callable[..., Command]) -> None:
    turner = make_turner(heading_feedback='odom', max_corrections=2)
    turner.robot.efforts[0] = 5.0
    command = start('--deg', '90')
    code, _ = command.wait(120.0)
    assert code == 1 and 'the robot was jammed' in command.err


@pytest.mark.parametrize('angle', [-0.5, 0.0])
def test_another_client_that_takes_over_is_an_error(
    make_turner: MakeTurner, start: Callable[..., Command], angle: float
) -> None:
    turner = make_turner()
    command = begin(turner, start)
    turner.user.turn(angle)
    code, said = command.wait()
    other = f'error: another client commanded {angle * 57.2958:+.1f} deg, '
    assert code == 1 and re.fullmatch(re.escape(other) + r'\d\d\.\d deg left', said)


@pytest.mark.parametrize('number', [signal.SIGKILL, signal.SIGINT])
def test_a_gait_node_that_dies_under_way_is_an_error_within_seconds(
    graph: Graph, start: Callable[..., Command], number: signal.Signals
) -> None:
    FakeRobot(graph, stepped=False)
    user = User(graph)
    gait = Process(graph.domain_id, graph.namespace, 'gait_node', use_compliance=False)
    try:
        command = start('--deg', '57')
        graph.spin_until(lambda: user.remaining[-1:] not in ([], [0.0]), 'the turn')
        gait.end(number)
        code, said = command.wait(10.0)
    finally:
        gait.close()
    assert code == 1 and re.fullmatch(r'error: the gait node went away, \d\d\.\d deg left', said)


def test_ctrl_c_for_the_gait_node_too_ends_the_command_at_once(
    graph: Graph, start: Callable[..., Command]
) -> None:
    FakeRobot(graph, stepped=False)
    user = User(graph)
    gait = Process(graph.domain_id, graph.namespace, 'gait_node', use_compliance=False)
    try:
        command = start('--deg', '57')
        graph.spin_until(lambda: user.remaining[-1:] not in ([], [0.0]), 'the turn')
        command.process.send_signal(signal.SIGINT)
        gait.end(signal.SIGINT)
        code, said = command.wait(10.0)
    finally:
        gait.close()
    assert code == 130 and re.search(r', \d\d\.\d deg left', said)


def test_a_turn_that_nothing_begins_is_given_up_and_cancelled(
    make_turner: MakeTurner, start: Callable[..., Command]
) -> None:
    turner = make_turner()
    turner.robot.spoil['joint_states'] = silence
    code, said = start('--deg', '20', '--timeout', '8').wait()
    assert code == 1 and 'error: nothing moves: 8 s without good joint_states' in said
    turner.robot.spoil.clear()
    assert not turner.wait_for_commands(50).any()
    assert turner.user.remaining[-1] == 0.0


def test_a_turn_given_up_while_the_clock_stood_still_does_not_begin_later(
    graph: Graph, start: Callable[..., Command]
) -> None:
    gait = graph.add(GaitNode, use_sim_time=True, use_compliance=False, **QUICK)
    user = User(graph)
    code, said = start('--deg', '20', '--timeout', '8').wait()
    assert code == 1 and 'in vain for the gait node to accept the turn' in said
    assert 'clock paused?' in said
    commands = user.hear(JointState, 'joint_commands')
    FakeRobot(graph, clock=True)
    graph.spin_until(lambda: len(commands) > 50, 'commands')
    assert gait.cycles_done == 0 and user.remaining[-1] == 0.0
    assert not any(any(message.position) for message in commands)


def test_ctrl_c_ends_the_turn_and_says_that_the_body_straightens(
    make_turner: MakeTurner, start: Callable[..., Command]
) -> None:
    turner = make_turner()
    command = begin(turner, start)
    command.process.send_signal(signal.SIGINT)
    code, said = command.wait()
    assert code == 130
    assert re.match(r'turn ended on request, \d\d\.\d deg left: the body straightens', said)
    turner.wait_for_end()


@pytest.mark.parametrize(
    ('arguments', 'expected'),
    [
        (['--deg', '10', '--namespace', 'a b'], "error: namespace: got 'a b', expected letters"),
        (
            ['--deg', '10', '--ros-args', '--log-level', 'loud'],
            "error: Couldn't parse log level: '--log-level loud'",
        ),
        (['--deg', 'abc'], 'argument --deg: abc: expected a number [deg]'),
        (['--deg', 'nan'], 'argument --deg: nan: expected a number [deg]'),
        (['--deg', '1e6'], 'argument --deg: 1e6: expected less than 1e6 deg'),
        (['--deg', '1', '--domain-id', '999'], '--domain-id: 999: expected 0..232'),
        (['--deg', '1', '--timeout', '-1'], '--timeout: -1: expected a time > 0 [s]'),
    ],
)
def test_a_wrong_argument_is_refused_in_one_line(arguments: list[str], expected: str) -> None:
    command = [sys.executable, '-m', 'omega_turn_lab.cli', 'turn', *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and expected in done.stderr
    assert 'Traceback' not in done.stderr and 'Warning' not in done.stderr
