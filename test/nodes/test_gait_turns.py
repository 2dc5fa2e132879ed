"""What the gait node does with `turn_angle`, and what it says on `turn_remaining`."""

from __future__ import annotations

import math
import re
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest
from rcl_interfaces.msg import Log
from rclpy.qos import QoSProfile, ReliabilityPolicy
from ros_graph import Graph, User
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from turner import BRISK, ROBOT, STEP, CommandWatch, FakeRobot, Turner

from omega_turn_ros.gaits.limits import JointLimits

MakeTurner = Callable[..., Turner]
ROSOUT = QoSProfile(depth=1000)
ODOM = {'turns': True, 'heading_feedback': 'odom'}


@pytest.mark.parametrize('angle', [0.5 * math.pi, -0.3])
def test_the_robot_ends_straight_at_the_angle_asked_for(
    make_turner: MakeTurner, angle: float
) -> None:
    turner = make_turner(**ODOM)
    turner.start_turn(angle)
    turner.wait_for_end()
    assert turner.robot.heading == pytest.approx(angle, abs=math.radians(1.0))
    assert np.abs(turner.watch.positions).max() > 0.3


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_an_angle_that_is_no_turn_is_dropped_and_counted(
    make_turner: MakeTurner, bad: float
) -> None:
    turner = make_turner()
    turner.user.turn(bad)
    turner.graph.spin_until(lambda: turner.user.refused('gait_node', 'turn_angle') == 1, 'refusal')
    assert not turner.wait_for_commands(10).any()
    turner.start_turn(0.5)
    turner.wait_for_end()
    assert turner.user.refused('gait_node', 'turn_angle') == 1


def test_of_two_angles_at_once_the_newest_wins(make_turner: MakeTurner) -> None:
    turner = make_turner(**ODOM)
    publisher = turner.user.publisher('turn_angle', Float64)
    publisher.publish(Float64(data=1.0))
    publisher.publish(Float64(data=-0.4))
    turner.graph.spin_until(lambda: -0.4 in turner.user.remaining, 'the second angle')
    turner.wait_for_end()
    assert turner.robot.heading == pytest.approx(-0.4, abs=math.radians(1.0))


@pytest.mark.parametrize('second', [-0.6, 2.0])
def test_a_new_angle_under_way_counts_from_the_heading_then(
    make_turner: MakeTurner, second: float
) -> None:
    turner = make_turner(**ODOM)
    turner.start_turn(1.2)
    turner.wait_for_cycle()
    before = turner.robot.heading
    turner.start_turn(second)
    turner.wait_for_end()
    # The robot moves on for the step or two it takes to be heard.
    assert turner.robot.heading - before == pytest.approx(second, abs=math.radians(3.0))


def test_zero_ends_the_turn_and_straightens_the_body(make_turner: MakeTurner) -> None:
    turner = make_turner()
    turner.start_turn(1.2)
    turner.wait_for_cycle()
    before = len(turner.user.remaining)
    turner.user.turn(0.0)
    turner.graph.spin_until(lambda: len(turner.user.remaining) > before, 'turn_remaining')
    turner.wait_for_end()
    assert not turner.wait_for_commands(20).any()


def test_the_log_tells_how_a_turn_ended(make_turner: MakeTurner) -> None:
    turner = make_turner(**ODOM)
    log = turner.user.hear(Log, '/rosout', ROSOUT)

    def wait_for_line(pattern: str) -> None:
        turner.graph.spin_until(lambda: any(re.fullmatch(pattern, m.msg) for m in log), pattern)

    turner.start_turn(0.5)
    turner.wait_for_end()
    wait_for_line(r'turn ended, [01]\.\d deg (short|too far)')
    turner.start_turn(1.2)
    turner.user.turn(0.0)
    wait_for_line('turn ended on request')


def test_an_angle_sent_before_the_robot_is_there_waits_for_it(graph: Graph) -> None:
    turner = Turner(graph)
    turner.robot.spoil['joint_states'] = lambda message: None
    turner.start_turn(0.5)
    assert turner.user.fact('gait_node', 'mode') == 'waiting for joint_states'
    assert not turner.watch.messages
    del turner.robot.spoil['joint_states']
    turner.wait_for_end()
    assert np.abs(turner.watch.positions).max() > 0.3


@pytest.mark.parametrize('parameters', [{}, BRISK], ids=['lock_step', 'timer'])
def test_what_remains_is_the_whole_angle_first_and_exactly_zero_last(
    make_turner: MakeTurner, parameters: dict[str, object]
) -> None:
    turner = make_turner(**parameters)
    turner.wait_for_commands(15)
    turner.user.turn(0.7)
    turner.graph.spin_until(lambda: turner.user.remaining[-1:] not in ([], [0.0]), 'the start')
    assert turner.user.remaining == [0.0, 0.7]
    turner.wait_for_end()
    assert 0.1 < np.median(turner.user.remaining) < 0.7  # it has told of the way between
    late = User(turner.graph)
    turner.graph.spin_until(lambda: late.remaining, 'the latched zero')
    assert late.remaining == [0.0]


def test_a_late_subscriber_is_told_what_remains_in_mid_turn(make_turner: MakeTurner) -> None:
    turner = make_turner()
    turner.start_turn(1.2)
    turner.wait_for_cycle()
    late = User(turner.graph)
    turner.graph.spin_until(lambda: late.remaining, 'the latched angle')
    assert 0.0 < abs(late.remaining[0]) < 1.2


def test_a_flood_of_angles_leaves_the_rate_and_the_newest_wins(make_turner: MakeTurner) -> None:
    turner = make_turner(**BRISK)
    publisher = turner.user.publisher('turn_angle', Float64)
    angles = np.linspace(-1.0, 1.0, 1500)

    def flood() -> None:
        for angle in angles:
            publisher.publish(Float64(data=float(angle)))
            time.sleep(0.001)

    def commands_per_second(done: Callable[[], object]) -> float:
        began, before = time.monotonic(), len(turner.watch.messages)
        turner.graph.spin_until(done, 'the time to be up')
        return (len(turner.watch.messages) - before) / (time.monotonic() - began)

    turner.wait_for_commands(1)
    deadline = time.monotonic() + 1.0
    calm = commands_per_second(lambda: time.monotonic() > deadline)
    flooder = threading.Thread(target=flood)
    flooder.start()
    flooded = commands_per_second(lambda: not flooder.is_alive())
    flooder.join()
    assert flooded > 0.4 * calm
    turner.graph.spin_until(lambda: 1.0 in turner.user.remaining, 'the newest angle')
    turner.wait_for_end()
    assert turner.user.refused('gait_node', 'turn_angle') == 0


def test_stop_freezes_the_command_until_reset_and_reset_alone_moves_nothing(
    make_turner: MakeTurner,
) -> None:
    turner = make_turner()
    turner.start_turn(1.2)
    turner.wait_for_cycle()
    turner.user.call('gait_node/stop')
    turner.graph.spin_until(lambda: turner.user.remaining[-1] == 0.0, 'turn_remaining 0.0')
    turner.wait_for_commands(2)  # of before the stop may still have been on their way
    frozen = turner.watch.newest
    assert np.abs(frozen).max() > 0.5
    turner.user.wait_for_problem('gait_node', 'stopped: call reset')

    turner.user.turn(-0.5)
    turner.graph.spin_until(lambda: turner.user.refused('gait_node', 'turn_angle') == 1, 'refusal')
    assert (turner.wait_for_commands(20) == frozen).all()
    turner.user.call('gait_node/reset')
    turner.user.wait_for_fact('gait_node', 'mode', 'holding')
    assert (turner.wait_for_commands(20) == frozen).all()
    assert turner.user.remaining[-1] == 0.0

    turner.start_turn(-0.5)
    turner.wait_for_end()


def test_stop_before_the_robot_is_there_holds_it_where_it_lies(graph: Graph) -> None:
    posture = np.linspace(-0.5, 0.5, ROBOT.n_joints)
    turner = Turner(graph, posture=posture)
    turner.robot.spoil['joint_states'] = lambda message: None
    turner.start_turn(0.5)
    turner.user.call('gait_node/stop')
    del turner.robot.spoil['joint_states']
    assert (turner.wait_for_commands(20) == posture).all()
    assert turner.user.remaining[-1] == 0.0


def test_lock_step_answers_each_reading_once(make_turner: MakeTurner) -> None:
    turner = make_turner()
    turner.start_turn(0.5)
    turner.wait_for_end()
    stamps = [(m.header.stamp.sec, m.header.stamp.nanosec) for m in turner.watch.messages]
    # The robot asks twice only where an answer is slow in coming.
    assert len(stamps) < 1.2 * len(set(stamps))


@pytest.mark.parametrize('reliability', list(ReliabilityPolicy)[1:3])
def test_commands_reach_reliable_and_best_effort_listeners(
    graph: Graph, reliability: ReliabilityPolicy
) -> None:
    turner = Turner(graph)
    qos = QoSProfile(depth=10, reliability=reliability)
    heard = turner.user.hear(JointState, 'joint_commands', qos)
    graph.spin_until(lambda: heard, 'a command')


def test_the_watch_sees_every_broken_limit(graph: Graph) -> None:
    user = User(graph)
    limits = JointLimits(position=1.0, velocity=2.0, step=0.5)
    zero = np.zeros(ROBOT.n_joints)

    def command(value: float, rate: float = 0.0, seconds: float = STEP) -> JointState:
        message = JointState(name=list(ROBOT.joint_names))
        message.position = (zero + value).tolist()
        message.velocity = (zero + rate).tolist()
        message.header.stamp.nanosec = round(seconds * 1e9)
        return message

    CommandWatch(user.node, limits, zero).check(command(0.02))
    for message in (
        command(0.021),
        command(math.nan),
        command(0.0, rate=2.1),
        command(0.0, rate=math.nan),
        JointState(name=['joint_1'], position=[0.0], velocity=[0.0]),
    ):
        with pytest.raises(AssertionError):
            CommandWatch(user.node, limits, zero).check(message)
    watch = CommandWatch(user.node, limits, zero + 0.999)
    with pytest.raises(AssertionError):
        watch.check(command(1.001))
    watch.check(command(0.999))
    with pytest.raises(AssertionError):
        watch.check(command(0.998, seconds=STEP))  # the same stamp leaves no time to move


def test_a_turn_goes_on_at_the_same_pace_with_a_robot_that_is_heard_best_effort(
    graph: Graph,
) -> None:
    turner = Turner(graph, **BRISK)
    turner.robot.spoil['joint_states'] = lambda message: None
    best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    other = FakeRobot(graph, stepped=False, state_qos=best_effort)
    turner.start_turn(0.7)
    turner.wait_for_end()
    assert other.posture == pytest.approx(turner.watch.newest, abs=1e-3)


def test_cycles_that_get_nowhere_with_motors_straining_are_reported_as_a_jam(
    make_turner: MakeTurner,
) -> None:
    turner = make_turner(heading_feedback='odom')  # whose heading stays as it is
    turner.robot.efforts[4] = -ROBOT.effort_limit
    turner.start_turn(1.5)
    turner.user.wait_for_problem('gait_node', 'jammed')
    assert int(turner.user.fact('gait_node', 'cycles in a jam')) >= 1
    turner.user.turn(0.0)
    turner.wait_for_end()
