"""Parameters, clocks and command types of the gait node."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from ros_graph import Graph, User
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import JointTrajectory
from turner import BRISK, ROBOT, STEP, Turner

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.admittance_node import ADMITTANCE_PARAMETERS, AdmittanceNode
from omega_turn_ros.nodes.gait_node import GaitNode
from omega_turn_ros.nodes.gait_parameters import GAIT_PARAMETERS
from omega_turn_ros.nodes.parameters import ParameterSpec
from omega_turn_ros.nodes.time import nanoseconds_of
from omega_turn_sim_bridge.bridge_node import PyBulletBridge
from omega_turn_sim_bridge.bridge_parameters import BRIDGE_PARAMETERS

MakeTurner = Callable[..., Turner]

TABLES = {
    'gait_node': (GaitNode, GAIT_PARAMETERS),
    'admittance_node': (AdmittanceNode, ADMITTANCE_PARAMETERS),
    'pybullet_bridge': (PyBulletBridge, BRIDGE_PARAMETERS),
}
SPECS = [
    pytest.param(spec, id=f'{node}.{spec.name}')
    for node, (_, table) in TABLES.items()
    for spec in table
]


def wrong_values(spec: ParameterSpec) -> list[Any]:
    """Values of the wrong type or just out of bounds."""
    if isinstance(spec.default, bool):
        return [1, 'true']
    if isinstance(spec.default, str):
        return [1, True, *(['anything else'] if spec.choices else [])]
    assert spec.low is not None and spec.high is not None
    wrong = [spec.low - 1, spec.high + 1, float('nan'), float('inf'), True]
    if isinstance(spec.default, list):
        count = len(spec.default)
        lists = [[value] * count for value in wrong]
        return [*lists, [spec.high] * (count + 1), [], spec.high, 'text']
    return [*wrong, 'text', *([0.5] if isinstance(spec.default, int) else [])]


@pytest.mark.parametrize('spec', SPECS)
def test_every_parameter_is_described_bounded_and_right_by_default(spec: ParameterSpec) -> None:
    assert len(spec.description) > 10 and spec.description.endswith('.')
    assert spec.check(spec.default) == spec.default
    for value in wrong_values(spec):
        with pytest.raises(BadInputError, match=f'parameter {spec.name}'):
            spec.check(value)


@pytest.mark.parametrize('node', TABLES)
def test_every_parameter_is_served_with_its_description(graph: Graph, node: str) -> None:
    make, table = TABLES[node]
    made = graph.add(make)
    user = User(graph)
    for spec in table:
        descriptor = made.describe_parameter(spec.name)
        assert spec.description in descriptor.description
        assert spec.unit in descriptor.description
        assert descriptor.additional_constraints == spec.expected
        assert descriptor.read_only is spec.read_only
    served = user.get_parameters(node, [spec.name for spec in table])
    for spec, value in zip(table, served, strict=True):
        assert spec.check(value) == spec.default


@pytest.mark.parametrize(
    ('node', 'name', 'value', 'expected'),
    [
        ('gait_node', 'period', 0.1, '[0.5, 600] [s]'),
        ('gait_node', 'period', 'fast', '[0.5, 600] [s]'),
        ('gait_node', 'period', 2.0, 'at least'),
        ('gait_node', 'offset_rate', float('nan'), '[0.001, 10]'),
        ('gait_node', 'max_corrections', 1.5, 'an integer in [0, 1000]'),
        ('gait_node', 'heading_feedback', 'compass', "['none', 'odom']"),
        ('gait_node', 'use_compliance', 1, 'true or false'),
        ('gait_node', 'gait', 'moonwalk', 'omega'),
        ('admittance_node', 'mass', [1.0, -1.0], '[0.0001, 1e+06]'),
        ('admittance_node', 'mass', [1.0], '2 numbers'),
        ('admittance_node', 'gait', 'moonwalk', 'omega'),
        ('pybullet_bridge', 'command_timeout', -0.5, '[0, 60]'),
        ('pybullet_bridge', 'real_time_factor', 1e4, '[0, 1000]'),
    ],
)
def test_a_wrong_value_is_refused_with_name_value_and_range(
    graph: Graph, node: str, name: str, value: Any, expected: str
) -> None:
    make, _ = TABLES[node]
    graph.add(make)
    user = User(graph)
    before = user.get_parameters(node, [name])
    result = user.set_parameter(node, name, value)
    assert not result.successful
    assert name in result.reason
    assert repr(value) in result.reason
    assert expected in result.reason
    assert user.get_parameters(node, [name]) == before


@pytest.mark.parametrize(
    ('node', 'name', 'value'),
    [
        ('gait_node', 'lock_step', True),
        ('admittance_node', 'robot', 'limbless16'),
        ('pybullet_bridge', 'friction', 0.4),
    ],
)
def test_what_is_fixed_at_the_start_says_so(
    graph: Graph, node: str, name: str, value: Any
) -> None:
    graph.add(TABLES[node][0])
    result = User(graph).set_parameter(node, name, value)
    assert not result.successful
    assert 'read-only' in result.reason and name in result.reason


@pytest.mark.parametrize(
    ('node', 'parameters', 'expected'),
    [
        ('gait_node', {'period': 3.0}, 'period.*3.0.*at least 4'),
        ('gait_node', {'step_limit': 0.01}, 'step_limit.*0.01.*at least 0.01'),
        ('gait_node', {'position_limit': 1.0}, 'gait.*omega.*within 1.0 rad'),
        ('gait_node', {'robot': 'centipede'}, 'robot.*centipede.*limbless16'),
        ('admittance_node', {'gait': 'moonwalk'}, 'gait.*moonwalk.*omega'),
        ('pybullet_bridge', {'rate': 300.0}, 'physics_rate.*200.*multiple of rate = 300'),
        ('pybullet_bridge', {'terrain': 'swamp'}, 'terrain.*swamp.*flat'),
    ],
)
def test_settings_that_do_not_fit_together_make_no_node(
    graph: Graph, node: str, parameters: dict[str, Any], expected: str
) -> None:
    with pytest.raises(BadInputError, match=expected):
        graph.add(TABLES[node][0], **parameters)


def test_an_integer_will_do_for_a_number(graph: Graph) -> None:
    turner = Turner(graph, period=5, velocity_limit=3)
    turner.wait_for_commands(1)
    assert turner.user.set_parameter('gait_node', 'period', 8).successful
    assert turner.user.set_parameter('gait_node', 'move_velocity', 2).successful
    turner.start_turn(0.4)
    turner.wait_for_end()


def test_the_gait_changes_between_turns_only(graph: Graph) -> None:
    turner = Turner(graph)
    turner.start_turn(1.0)
    turner.wait_for_cycle()
    refused = turner.user.set_parameter('gait_node', 'gait', 'offset')
    assert not refused.successful
    assert "gait: got 'offset', expected no change during a turn" in refused.reason
    assert turner.user.get_parameters('gait_node', ['gait']) == ['omega']
    turner.wait_for_end()
    reached = np.abs(turner.watch.positions).max(axis=0)

    accepted = turner.user.set_parameter('gait_node', 'gait', 'offset')
    assert accepted.successful, accepted.reason
    before = len(turner.watch.messages)
    turner.start_turn(0.9)
    turner.wait_for_end()
    again = np.abs(turner.watch.positions[before:]).max(axis=0)
    assert np.abs(again - reached).max() > 0.1


def test_a_new_period_holds_from_then_on(graph: Graph) -> None:
    turner = Turner(graph, period=4.5)

    def seconds_of_turn() -> float:
        before = len(turner.watch.messages)
        turner.start_turn(0.8)
        turner.wait_for_end()
        return len(turner.watch.messages[before:]) * STEP

    quick = seconds_of_turn()
    assert turner.user.set_parameter('gait_node', 'period', 7.0).successful
    assert seconds_of_turn() - quick == pytest.approx(2.5, abs=0.3)
    turner.start_turn(0.8)
    turner.wait_for_cycle()
    assert turner.user.set_parameter('gait_node', 'period', 4.5).successful
    turner.wait_for_end()


def test_a_change_under_way_does_not_halt_the_turn(graph: Graph) -> None:
    turner = Turner(graph, **BRISK, state_timeout=60.0)  # however late a busy machine is
    said = 0

    def seldom(message: JointState) -> JointState | None:
        nonlocal said
        said += 1
        return message if said % 10 == 0 else None

    turner.robot.spoil['joint_states'] = seldom
    turner.start_turn(1.2)
    turner.wait_for_cycle()
    before = len(turner.watch.messages)
    for timeout in (5.0, 6.0, 7.0):
        assert turner.user.set_parameter('gait_node', 'odom_timeout', timeout).successful
    assert turner.user.remaining[-1] != 0.0
    moved = np.any(np.diff(turner.watch.positions[before:], axis=0), axis=1)
    assert moved.size > 0 and moved.all()
    turner.wait_for_end()


def test_a_joint_limit_inside_the_present_posture_is_refused(graph: Graph) -> None:
    posture = np.zeros(ROBOT.n_joints)
    posture[2] = 1.4
    turner = Turner(graph, posture=posture, gait='omega_60')
    turner.wait_for_commands(5)
    refused = turner.user.set_parameter('gait_node', 'position_limit', 1.2)
    assert not refused.successful
    assert 'position_limit: got 1.2, expected at least 1.4' in refused.reason
    turner.start_turn(0.2)
    turner.wait_for_end()
    assert turner.user.set_parameter('gait_node', 'position_limit', 1.2).successful
    turner.watch.limits = type(turner.watch.limits)(1.2, ROBOT.velocity_limit, 0.1)
    turner.start_turn(0.2)
    turner.wait_for_end()


@pytest.mark.parametrize('jump', [100.0, -100.0], ids=['forward', 'backward'])
@pytest.mark.parametrize('bent', [0.02, 0.8], ids=['bending', 'cycling'])
def test_a_clock_that_jumps_breaks_no_limit_and_no_turn(
    graph: Graph, jump: float, bent: float
) -> None:
    turner = Turner(graph, clock=True)
    turner.robot.time = 200 * 10**9
    turner.start_turn(0.9)
    graph.spin_until(lambda: np.abs(turner.watch.newest).max() > bent, 'motion')
    turner.robot.time += round(jump * 1e9)
    before = len(turner.watch.messages)
    turner.wait_for_end()
    first = nanoseconds_of(turner.watch.messages[0].header.stamp)
    last = nanoseconds_of(turner.watch.messages[-1].header.stamp)
    assert last * 1e-9 == pytest.approx(turner.robot.time * 1e-9, abs=1.0)
    assert np.sign(last - first) == np.sign(jump)
    assert len(turner.watch.messages) > before + 100
    assert turner.user.fact('gait_node', 'clock jumps') == '1'


def test_every_command_type_carries_the_same_positions(graph: Graph) -> None:
    def turn(interface: str, message_type: type, topic: str, below: str) -> list[Any]:
        turner = Turner(graph, below, command_interface=interface)
        heard = turner.user.hear(message_type, topic)

        def obey(message: Any) -> None:
            points = getattr(message, 'points', None)
            target = points[0].positions if points else message.data
            turner.robot.obey(np.array(target), turner.robot.time)

        if message_type is not JointState:
            turner.user.node.create_subscription(message_type, topic, obey, 10)
        turner.robot.spoil['joint_states'] = lambda message: None
        turner.start_turn(0.6)  # before the first reading, so all runs are the same
        del turner.robot.spoil['joint_states']
        graph.spin_until(lambda: turner.user.remaining[-1] == 0.0, 'the end')
        return heard

    states = turn('joint_state', JointState, 'joint_commands', 'a')
    points = turn('joint_trajectory', JointTrajectory, 'joint_trajectory', 'b')
    arrays = turn('position_array', Float64MultiArray, 'position_commands', 'c')
    positions = np.array([m.position for m in states])
    count = min(len(states), len(points), len(arrays))  # all have heard the end
    assert np.abs(positions[:count]).max() > 0.3
    assert np.abs(positions[count - 1]).max() < 1e-3
    assert np.array_equal(positions[:count], [m.points[0].positions for m in points[:count]])
    assert np.array_equal(positions[:count], [m.data for m in arrays[:count]])
    for state, point in zip(states[:count], points[:count], strict=True):
        assert list(point.joint_names) == list(state.name) == list(ROBOT.joint_names)
        assert point.header.stamp == state.header.stamp
        assert list(point.points[0].velocities) == list(state.velocity)
        due = point.points[0].time_from_start
        assert len(point.points) == 1 and due.sec + due.nanosec * 1e-9 == pytest.approx(STEP)


def test_moves_keep_the_step_limit_and_arrive_all_the_same(graph: Graph) -> None:
    posture = np.zeros(ROBOT.n_joints)
    posture[6] = 1.2
    turner = Turner(graph, posture=posture, velocity_limit=50.0, move_velocity=20.0)
    turner.wait_for_commands(1)
    turner.user.turn(0.0)
    graph.spin_until(lambda: not turner.watch.newest.any(), 'a straight body')
    assert np.abs(np.diff(turner.watch.positions, axis=0)).max() > 0.05  # and do not dawdle


def test_the_joint_limit_holds_where_offsets_would_bend_over_it(graph: Graph) -> None:
    turner = Turner(graph, use_compliance=True)
    turner.robot.offsets = (0.5, 0.5)
    turner.start_turn(3.2)  # two cycles as large as can be
    turner.wait_for_end()
    assert np.abs(turner.watch.positions).max() == pytest.approx(ROBOT.position_limit)
    assert int(turner.user.fact('gait_node', 'commands limited')) > 5
