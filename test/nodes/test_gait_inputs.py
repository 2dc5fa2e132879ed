"""What the gait node does with joint states, odometry and amplitude offsets, good and bad."""

from __future__ import annotations

import ast
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from ros_graph import Graph
from sensor_msgs.msg import JointState
from turner import BRISK, ROBOT, STEP, Turner, amplitudes, silence

from omega_turn_ros.nodes.time import nanoseconds_of

MakeTurner = Callable[..., Turner]

POSTURE = np.linspace(-0.5, 0.4, ROBOT.n_joints)
TIMEOUT = 0.1  # [s] for every input in the tests of lost inputs
NEVER = 60.0


def entries(message: JointState, keep: list[int]) -> JointState:
    """The message with these joints only, in this order."""
    message.name = [message.name[i] for i in keep]
    message.position = [message.position[i] for i in keep]
    return message


def with_value(message: JointState, value: float) -> JointState:
    message.position[3] = value
    return message


def renamed(message: JointState, joint: int, name: str) -> JointState:
    message.name[joint] = name
    return message


ALL = list(range(ROBOT.n_joints))
EXTRA = [*ALL, 0]
BAD_STATES: dict[str, Callable[[JointState], JointState]] = {
    'nan': lambda m: with_value(m, math.nan),
    'infinity': lambda m: with_value(m, -math.inf),
    'short': lambda m: JointState(header=m.header, name=m.name, position=m.position[:-1]),
    'long': lambda m: JointState(header=m.header, name=m.name, position=[*m.position, 0.0]),
    'without positions': lambda m: JointState(header=m.header, name=m.name),
    'without names': lambda m: JointState(header=m.header, position=m.position),
    'empty': lambda m: JointState(header=m.header),
    'missing joint': lambda m: entries(m, ALL[:-1]),
    'renamed joint': lambda m: renamed(m, 3, 'arm'),
    'extra joint': lambda m: renamed(entries(m, EXTRA), ROBOT.n_joints, 'arm'),
    'doubled joint': lambda m: entries(m, EXTRA),
    'doubled for another': lambda m: entries(m, [*ALL[:-1], 0]),
}


@pytest.mark.parametrize('spoil', BAD_STATES.values(), ids=BAD_STATES)
def test_bad_joint_states_are_dropped_whole_and_counted(
    graph: Graph, spoil: Callable[[JointState], JointState]
) -> None:
    turner = Turner(graph, posture=POSTURE)
    sent = 0

    def spoiled(message: JointState) -> JointState:
        nonlocal sent
        sent += 1
        return spoil(message)

    turner.robot.spoil['joint_states'] = spoiled
    turner.start_turn(0.5)
    graph.spin_until(lambda: turner.user.refused('gait_node', 'joint_states') >= 3, 'refusals')
    assert not turner.watch.messages
    del turner.robot.spoil['joint_states']
    assert turner.wait_for_commands(1)[0] == pytest.approx(POSTURE, abs=0.03)

    turner.wait_for_cycle()
    turner.robot.spoil['joint_states'] = spoiled
    before = sent
    graph.spin_until(lambda: sent >= before + 3, 'bad joint states')
    del turner.robot.spoil['joint_states']
    turner.wait_for_end()
    assert turner.user.refused('gait_node', 'joint_states') == sent


@pytest.mark.parametrize('order', [ALL[::-1], ALL[5:] + ALL[:5]], ids=['reversed', 'rotated'])
def test_joint_states_are_read_by_name_in_any_order(graph: Graph, order: list[int]) -> None:
    turner = Turner(graph, posture=POSTURE)
    turner.robot.spoil['joint_states'] = lambda message: entries(message, order)
    assert turner.wait_for_commands(5) == pytest.approx(np.tile(POSTURE, (5, 1)))
    turner.start_turn(0.5)
    turner.wait_for_end()
    assert turner.user.refused('gait_node', 'joint_states') == 0


def test_an_order_that_changes_between_messages_is_followed(graph: Graph) -> None:
    turner = Turner(graph, posture=POSTURE)
    orders = [ALL, ALL[::-1]]
    said = []

    def alternate(message: JointState) -> JointState:
        said.append(message)
        return entries(message, orders[len(said) % 2])

    turner.robot.spoil['joint_states'] = alternate
    assert turner.wait_for_commands(10) == pytest.approx(np.tile(POSTURE, (10, 1)))
    assert turner.user.refused('gait_node', 'joint_states') == 0


def test_joints_of_others_pass_where_they_are_ignored(graph: Graph) -> None:
    def with_arm(message: JointState) -> JointState:
        message.name.insert(0, 'arm')
        message.position.insert(0, math.nan)
        return message

    turner = Turner(graph, posture=POSTURE, ignore_unknown_joints=True)
    turner.robot.spoil['joint_states'] = with_arm
    assert turner.wait_for_commands(5) == pytest.approx(np.tile(POSTURE, (5, 1)))
    turner.start_turn(0.5)
    turner.wait_for_end()


def test_a_robot_that_lies_beyond_its_limits_is_commanded_inside_them(graph: Graph) -> None:
    beyond = np.zeros(ROBOT.n_joints)
    beyond[4] = ROBOT.position_limit + 0.05
    turner = Turner(graph, posture=beyond)
    first = turner.wait_for_commands(1)[0]
    assert first[4] == pytest.approx(ROBOT.position_limit)


def test_lost_joint_states_freeze_the_command_until_they_return(make_turner: MakeTurner) -> None:
    turner = make_turner(state_timeout=TIMEOUT, **BRISK)
    turner.start_turn(1.0)
    turner.wait_for_cycle()
    turner.robot.spoil['joint_states'] = silence
    before = len(turner.watch.messages)
    turner.user.wait_for_problem('gait_node', 'joint_states stale')
    frozen = turner.wait_for_commands(30)
    assert (frozen == frozen[0]).all()
    assert np.abs(frozen[0]).max() > 0.1
    moved = np.any(np.diff(turner.watch.positions[before:], axis=0), axis=1).sum()
    assert moved <= TIMEOUT / STEP + 5
    assert turner.user.remaining[-1] not in (0.0, 1.0)

    del turner.robot.spoil['joint_states']
    turner.wait_for_end()
    turner.graph.spin_until(lambda: turner.user.health['gait_node'].message == 'OK', 'health')


@pytest.mark.parametrize('heard_before', [False, True])
def test_a_turn_without_joint_states_is_dropped_and_never_begins(
    make_turner: MakeTurner, heard_before: bool
) -> None:
    turner = make_turner(start_timeout=0.1)
    if heard_before:
        turner.wait_for_commands(5)
    said = turner.robot.time
    turner.robot.spoil['joint_states'] = silence
    if heard_before:
        turner.graph.spin_until(lambda: turner.robot.time > said, 'the last answer')
        turner.user.fact('gait_node', 'mode')  # by then nothing is on its way
    turner.user.turn(1.0)
    remaining = turner.user.remaining
    turner.graph.spin_until(lambda: remaining[-2:] == [1.0, 0.0], 'the end of the wait')
    assert turner.user.refused('gait_node', 'turn_angle') == 1
    turner.robot.spoil.clear()
    assert not turner.wait_for_commands(50).any()
    turner.start_turn(0.5)  # the next is welcome


def test_a_turn_under_way_is_never_dropped(make_turner: MakeTurner) -> None:
    turner = make_turner(start_timeout=2.0)
    turner.start_turn(1.0)
    turner.wait_for_cycle()
    turner.robot.spoil['joint_states'] = silence
    lost = time.monotonic()
    turner.graph.spin_until(lambda: time.monotonic() > lost + 2.5, 'more than start_timeout')
    turner.robot.spoil.clear()
    assert turner.user.refused('gait_node', 'turn_angle') == 0
    assert turner.user.remaining[-1] != 0.0


def test_lost_odom_lets_the_prediction_end_the_turn(make_turner: MakeTurner) -> None:
    turner = make_turner(turns=True, heading_feedback='odom', odom_timeout=TIMEOUT, **BRISK)
    turner.start_turn(1.0)
    turner.wait_for_cycle()
    turner.robot.spoil['odom'] = silence
    turner.user.wait_for_problem('gait_node', 'odom stale: heading predicted')
    turner.wait_for_end()
    # Blind since some way into the cycle: as good as the prediction, under a busy clock.
    assert turner.robot.heading == pytest.approx(1.0, abs=math.radians(20.0))


@pytest.mark.parametrize('components', [(math.nan,) * 4, (0.0,) * 4, (0.0, 0.0, math.inf, 1.0)])
def test_an_orientation_that_is_none_is_dropped_and_counted(
    make_turner: MakeTurner, components: tuple[float, ...]
) -> None:
    turner = make_turner(turns=True, heading_feedback='odom', **BRISK)

    def spoil(message: Odometry) -> Odometry:
        q = message.pose.pose.orientation
        q.x, q.y, q.z, q.w = components
        return message

    turner.start_turn(0.8)
    turner.wait_for_cycle()
    turner.robot.spoil['odom'] = spoil
    turner.graph.spin_until(lambda: turner.user.refused('gait_node', 'odom') >= 3, 'refusals')
    del turner.robot.spoil['odom']
    turner.wait_for_end()
    assert turner.robot.heading == pytest.approx(0.8, abs=math.radians(1.5))


def test_a_heading_that_jumps_is_no_turn(make_turner: MakeTurner) -> None:
    turner = make_turner(turns=True, heading_feedback='odom')
    turner.start_turn(0.8)
    turner.wait_for_cycle()
    turner.robot.heading += 2.0  # the tracker has found another north
    turner.wait_for_end()
    assert turner.robot.heading - 2.0 == pytest.approx(0.8, abs=math.radians(1.5))
    assert turner.user.fact('gait_node', 'heading jumps left out') == '1'


BAD_AMPLITUDES: dict[str, JointState] = {
    'nan': amplitudes(math.nan, 0.0),
    'infinity': amplitudes(0.0, math.inf),
    'beyond the bound': amplitudes(0.0, -0.31),
    'unknown wave': JointState(name=['forward', 'tidal'], position=[0.1, 0.1]),
    'missing wave': JointState(name=['forward'], position=[0.1]),
    'doubled wave': JointState(name=['forward', 'forward'], position=[0.1, 0.1]),
    'third wave': JointState(name=['forward', 'turning', 'tidal'], position=[0.1, 0.1, 0.1]),
    'short': JointState(name=['forward', 'turning'], position=[0.1]),
    'empty': JointState(),
}


def offsets_told(turner: Turner) -> tuple[float, float]:
    """Amplitude offsets in force, by the next diagnostics."""
    told = ast.literal_eval(turner.user.fact('gait_node', 'amplitude offsets [rad]'))
    return float(told[0]), float(told[1])


@pytest.mark.parametrize('bad', BAD_AMPLITUDES.values(), ids=BAD_AMPLITUDES)
def test_bad_wave_amplitudes_are_dropped_whole_and_counted(
    make_turner: MakeTurner, bad: JointState
) -> None:
    turner = make_turner(use_compliance=True, offset_limit=0.3, **BRISK)
    turner.start_turn(0.7)
    turner.wait_for_cycle()
    turner.user.send('wave_amplitudes', bad)
    turner.graph.spin_until(
        lambda: turner.user.refused('gait_node', 'wave_amplitudes') == 1, 'refusal'
    )
    assert offsets_told(turner) == (0.0, 0.0)


def test_wave_amplitudes_change_the_gait_at_a_bounded_rate_and_fade_when_they_stop(
    make_turner: MakeTurner,
) -> None:
    rate = 1.0
    turner = make_turner(use_compliance=True, amplitude_timeout=TIMEOUT, offset_rate=rate, **BRISK)
    reports = turner.user.hear(DiagnosticArray, 'diagnostics')
    turner.robot.offsets = (0.2, -0.1)
    turner.robot.spoil['wave_amplitudes'] = lambda m: JointState(
        header=m.header, name=m.name[::-1], position=m.position[::-1]
    )
    turner.graph.spin_until(lambda: offsets_told(turner) == (0.2, -0.1), 'the offsets')
    turner.robot.offsets = None
    turner.graph.spin_until(lambda: offsets_told(turner) == (0.0, 0.0), 'offsets back at 0')

    history = []
    for status, stamp in ((r.status[0], nanoseconds_of(r.header.stamp)) for r in reports):
        (told,) = (v.value for v in status.values if v.key == 'amplitude offsets [rad]')
        history.append((stamp * 1e-9, *ast.literal_eval(told)))
    steps = np.diff(np.array(history), axis=0)
    assert (np.abs(steps[:, 1:]).max(axis=1) <= rate * (steps[:, 0] + 3 * STEP)).all()
    assert turner.user.refused('gait_node', 'wave_amplitudes') == 0


def test_wave_amplitudes_bend_the_body_as_far_as_they_say(make_turner: MakeTurner) -> None:
    def peak(offsets: tuple[float, float], below: str, **parameters: Any) -> float:
        turner = make_turner(below, **{'use_compliance': True, **parameters})
        turner.robot.offsets = offsets
        turner.start_turn(0.5)
        turner.wait_for_end()
        return float(np.abs(turner.watch.positions).max())

    plain = peak((0.0, 0.0), 'plain')
    assert peak((0.3, 0.0), 'pushed') - plain == pytest.approx(0.3, abs=0.15)
    assert peak((0.3, 0.0), 'deaf', use_compliance=False) == plain


def rolled(message: Odometry) -> Odometry:
    """The same heading, upside down: half a roll before the turn."""
    q = message.pose.pose.orientation
    q.x, q.y, q.z, q.w = q.w, q.z, 0.0, 0.0
    return message


@pytest.mark.parametrize('feedback', ['odom', 'none'])
def test_robot_on_its_back_is_told_to_turn_the_other_way_round_if_odom_counts(
    graph: Graph, feedback: str
) -> None:
    first = []
    for way in (lambda message: message, rolled):
        turner = Turner(graph, f'robot{len(first)}', heading_feedback=feedback)
        turner.robot.spoil['odom'] = way
        turner.start_turn(1.0)
        turner.wait_for_cycle()
        first.append(turner.watch.positions)
    count = min(len(commands) for commands in first)
    sign = -1.0 if feedback == 'odom' else 1.0
    np.testing.assert_allclose(first[1][:count], sign * first[0][:count], atol=1e-9)
