"""The admittance node: joint efforts in, amplitude offsets out."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from rcl_interfaces.msg import Log
from ros_graph import Graph, User
from sensor_msgs.msg import JointState
from turner import ROBOT, STEP, Turner

from omega_turn_ros.nodes.admittance_node import AdmittanceNode
from omega_turn_ros.nodes.gait_node import WAVES
from omega_turn_ros.nodes.time import stamp_of

PUSHED = 0  # index of joint_1, the first yaw joint
PUSH, DEAD_BAND, STIFFNESS, LIMIT = 1.7, 0.1, 8.0, 0.35  # [N m, N m, N m/rad, rad]
TAU_FORWARD = 0.5 * math.pi - 2.0 * math.pi * 1.5 / 8  # joint_1 on the crest of the forward wave
TAU_TURNING = -2.0 * math.pi * 1.0 / 8  # and on the node of the turning wave

# The law of the paper read straight; the node's own pushes back.
YIELDING = {'torque_scale': [1.0, 1.0], 'dead_band': DEAD_BAND, 'offset_limit': LIMIT}


class Compliant:
    """An admittance node that is told states and phases one instant at a time.

    Args:
        graph: the graph to live on.
        below: their namespace.
        parameters: of the node; its efforts do not get stale unless told otherwise.
    """

    def __init__(self, graph: Graph, below: str = '', **parameters: Any) -> None:
        self.graph, self.user = graph, User(graph, below)
        graph.add(AdmittanceNode, below, **{'effort_timeout': 60.0, **YIELDING, **parameters})
        self.heard: list[JointState] = []
        self.user.node.create_subscription(JointState, 'wave_amplitudes', self._check, 10_000)
        self.efforts = np.zeros(ROBOT.n_joints)
        self.time, self.step = 0, 2 * STEP
        self.spoil: dict[str, Callable[[JointState], JointState]] = {}

    @property
    def offsets(self) -> tuple[float, float]:
        """The newest offsets of (forward, turning) [rad]."""
        forward, turning = self.heard[-1].position
        return forward, turning

    def _check(self, message: JointState) -> None:
        assert list(message.name) == list(WAVES)
        assert np.isfinite(message.position).all() and np.isfinite(message.velocity).all()
        assert np.abs(message.position).max() <= LIMIT + 1e-9
        assert np.abs(message.velocity).max() <= 1.0 + 1e-9
        if self.heard:
            step = np.abs(np.array(message.position) - self.heard[-1].position).max()
            assert step <= 0.1 * 1.0 + 1e-9  # at most the watchdog's longest step
        self.heard.append(message)

    def tell(self, playing: float = 1.0) -> None:
        """Send one instant: phases at this rate [rad/s], then states."""
        self.time += round(self.step * 1e9)
        phases = JointState(name=list(WAVES), position=[TAU_FORWARD, TAU_TURNING])
        phases.velocity = [playing, playing]
        states = JointState(name=list(ROBOT.joint_names), effort=self.efforts.tolist())
        states.position = states.velocity = [0.0] * ROBOT.n_joints
        for topic, message in (('wave_phases', phases), ('joint_states', states)):
            message.header.stamp = stamp_of(self.time)
            self.user.send(topic, self.spoil.get(topic, lambda m: m)(message))

    def run(self, seconds: float, playing: float = 1.0) -> tuple[float, float]:
        """Send instants for so long, each answered, and return the last offsets [rad]."""
        for _ in range(round(seconds / self.step)):
            before = len(self.heard)
            self.tell(playing)
            self.graph.spin_until(lambda b=before: len(self.heard) > b, 'wave_amplitudes')
        return self.offsets


def pushed(compliant: Compliant, torque: float = PUSH) -> None:
    """Let something outside push joint_1 [N m]: its actuator answers the other way."""
    compliant.efforts[PUSHED] = -torque


@pytest.mark.parametrize('sign', [1, -1])
def test_a_push_moves_the_wave_it_acts_on_by_push_over_stiffness(graph: Graph, sign: int) -> None:
    compliant = Compliant(graph, effort_sign=sign)
    pushed(compliant, sign * PUSH)
    forward, turning = compliant.run(10.0)
    assert forward == pytest.approx((PUSH - DEAD_BAND) / STIFFNESS, rel=0.01)
    assert turning == pytest.approx(0.0, abs=1e-6)
    pushed(compliant, 0.0)
    assert compliant.run(10.0) == pytest.approx((0.0, 0.0), abs=1e-3)


def test_waves_and_joints_are_read_by_name_in_any_order(graph: Graph) -> None:
    def reverse(message: JointState) -> JointState:
        message.name = message.name[::-1]
        for field in ('position', 'velocity', 'effort'):
            setattr(message, field, getattr(message, field)[::-1])
        return message

    compliant = Compliant(graph)
    pushed(compliant)
    straight = compliant.run(0.5)
    assert straight[0] > 0.01
    compliant = Compliant(graph, 'reversed')
    pushed(compliant)
    compliant.spoil = {'joint_states': reverse, 'wave_phases': reverse}
    assert compliant.run(0.5) == pytest.approx(straight, abs=1e-12)


@pytest.mark.parametrize('push', [50.0, -50.0, 1e308])
def test_no_push_moves_a_wave_beyond_its_bound(graph: Graph, push: float) -> None:
    compliant = Compliant(graph)
    pushed(compliant, push)
    forward, _ = compliant.run(2.0)
    assert forward == pytest.approx(math.copysign(LIMIT, push))
    compliant.user.wait_for_problem('admittance_node', 'amplitude offset at its bound')


def test_a_bound_lets_go_as_soon_as_the_push_ends(graph: Graph) -> None:
    compliant = Compliant(graph)
    pushed(compliant, 50.0)
    assert compliant.run(2.0)[0] == pytest.approx(LIMIT)
    pushed(compliant, 0.0)
    assert compliant.run(1.5)[0] < 0.8 * LIMIT
    assert compliant.run(10.0) == pytest.approx((0.0, 0.0), abs=1e-3)


BAD_EFFORTS: dict[str, Callable[[JointState], JointState]] = {
    'empty': lambda m: JointState(
        header=m.header, name=m.name, position=m.position, velocity=m.velocity
    ),
    'nan': lambda m: JointState(
        header=m.header,
        name=m.name,
        position=m.position,
        velocity=m.velocity,
        effort=[math.nan] * ROBOT.n_joints,
    ),
    'short': lambda m: JointState(
        header=m.header,
        name=m.name,
        position=m.position,
        velocity=m.velocity,
        effort=m.effort[:-1],
    ),
    'without velocities': lambda m: JointState(
        header=m.header, name=m.name, position=m.position, effort=m.effort
    ),
    'nothing at all': lambda m: JointState(header=m.header),
}


@pytest.mark.parametrize('spoil', BAD_EFFORTS.values(), ids=BAD_EFFORTS)
def test_bad_efforts_are_dropped_whole_and_counted(
    graph: Graph, spoil: Callable[[JointState], JointState]
) -> None:
    compliant = Compliant(graph)
    pushed(compliant)
    before = compliant.run(0.5)
    compliant.spoil['joint_states'] = spoil
    for _ in range(3):
        compliant.tell()
    graph.spin_until(
        lambda: compliant.user.refused('admittance_node', 'joint_states') == 3, 'refusals'
    )
    assert compliant.offsets[0] <= before[0]
    compliant.spoil.clear()
    assert compliant.run(0.5)[0] > 0.01


def test_a_robot_without_efforts_still_turns(graph: Graph) -> None:
    turner = Turner(graph, use_compliance=True, lock_step=False, clock=True)
    graph.add(AdmittanceNode, **YIELDING)
    turner.robot.spoil['joint_states'] = BAD_EFFORTS['empty']
    turner.start_turn(0.5)
    turner.wait_for_end()
    assert turner.user.refused('admittance_node', 'joint_states') > 100
    assert turner.user.refused('gait_node', 'joint_states') == 0
    turner.user.wait_for_problem('admittance_node', 'efforts stale')


BAD_PHASES: dict[str, Callable[[JointState], JointState]] = {
    'nan': lambda m: JointState(header=m.header, name=m.name, position=[math.nan, 0.0]),
    'unknown wave': lambda m: JointState(
        header=m.header, name=['forward', 'tidal'], position=[0.0, 0.0], velocity=[1.0, 1.0]
    ),
    'without rates': lambda m: JointState(header=m.header, name=m.name, position=m.position),
    'empty': lambda m: JointState(header=m.header),
}


@pytest.mark.parametrize('spoil', BAD_PHASES.values(), ids=BAD_PHASES)
def test_bad_phases_are_dropped_whole_and_counted(
    graph: Graph, spoil: Callable[[JointState], JointState]
) -> None:
    compliant = Compliant(graph)
    pushed(compliant)
    compliant.spoil['wave_phases'] = spoil
    assert compliant.run(0.2) == (0.0, 0.0)
    assert compliant.user.refused('admittance_node', 'wave_phases') == len(compliant.heard)
    compliant.spoil.clear()
    assert compliant.run(0.5)[0] > 0.01


def test_no_wave_no_offset(graph: Graph) -> None:
    compliant = Compliant(graph)
    pushed(compliant)
    assert compliant.run(0.5, playing=0.0) == (0.0, 0.0)
    assert compliant.run(1.0)[0] > 0.05
    assert compliant.run(1.0, playing=0.0) == (0.0, 0.0)


def test_lost_efforts_let_the_offsets_fade_at_a_bounded_rate(graph: Graph) -> None:
    compliant = Compliant(graph, relax_rate=0.5, effort_timeout=1.0)
    compliant.user.wait_for_problem('admittance_node', 'efforts stale')
    pushed(compliant)
    assert compliant.run(5.0)[0] > 0.15
    told = len(compliant.heard)
    graph.spin_until(lambda: compliant.offsets == (0.0, 0.0), 'offsets back at 0')
    fading = np.array([m.position for m in compliant.heard[told - 1 :]])
    assert len(fading) >= 4
    assert np.abs(np.diff(fading, axis=0)).max() <= 0.5 * 0.1 + 1e-9
    compliant.user.wait_for_problem('admittance_node', 'efforts stale')


def test_the_log_tells_how_long_efforts_were_lost_and_once_that_they_are_back(
    graph: Graph,
) -> None:
    compliant = Compliant(graph, effort_timeout=0.5)
    log = compliant.user.hear(Log, '/rosout')
    lost = r'no efforts for 0\.[5-9] s: amplitude offsets relax to 0'
    pushed(compliant)
    compliant.run(1.0)
    compliant.graph.spin_until(lambda: any(re.fullmatch(lost, m.msg) for m in log), lost)
    compliant.run(0.5)
    graph.spin_until(lambda: any(m.msg == 'efforts are back' for m in log), 'efforts are back')
    assert sum(m.msg == 'efforts are back' for m in log) == 1


@pytest.mark.parametrize('jump', [100.0, -0.5], ids=['forward', 'backward'])
def test_stamps_that_jump_move_no_offset_further_than_one_step(graph: Graph, jump: float) -> None:
    compliant = Compliant(graph)
    pushed(compliant)
    before = np.array(compliant.run(1.0))
    compliant.time += round(jump * 1e9)
    after = np.array(compliant.run(compliant.step))
    assert np.abs(after - before).max() <= 0.025 * 1.0
    assert compliant.user.fact('admittance_node', 'clock jumps') == '1'
    assert compliant.run(1.0)[0] > before[0]


@pytest.mark.parametrize(
    ('name', 'value'),
    [('stiffness', [2.0, 2.0]), ('mass', [0.1, 0.1]), ('damping', [0.0, 0.0]), ('gait', 'offset')],
)
def test_a_live_change_of_the_law_moves_no_offset_at_once(
    graph: Graph, name: str, value: Any
) -> None:
    compliant = Compliant(graph)
    pushed(compliant)
    before = np.array(compliant.run(2.0))
    result = compliant.user.set_parameter('admittance_node', name, value)
    assert result.successful, result.reason
    after = np.array(compliant.run(compliant.step))
    assert np.abs(after - before).max() <= compliant.step * 1.0
    compliant.run(0.5)


def test_a_tare_takes_the_mean_effort_at_rest_for_zero(graph: Graph) -> None:
    compliant = Compliant(graph)
    compliant.efforts[PUSHED] = -PUSH  # as a push would, but it is the sensor's bias
    untared = compliant.run(0.5)
    assert abs(untared[0]) > 0.05
    compliant.run(3.0, playing=0.0)
    noise = [0.3, -0.3]
    for k in range(50):
        compliant.efforts[PUSHED] = -PUSH + noise[k % 2]
        compliant.run(compliant.step, playing=0.0)
    assert compliant.offsets == (0.0, 0.0)
    assert '1.7 N m' in compliant.user.call('admittance_node/tare').message
    compliant.efforts[PUSHED] = -PUSH
    assert compliant.run(0.5) == (0.0, 0.0)
    compliant.efforts[PUSHED] -= PUSH
    assert compliant.run(0.5) == pytest.approx(untared, rel=0.1)


@pytest.mark.parametrize('why', ['a cycle plays', 'it moves', 'the clock jumps'])
def test_a_robot_that_does_not_rest_is_not_tared(graph: Graph, why: str) -> None:
    compliant = Compliant(graph)
    compliant.efforts[PUSHED] = -PUSH

    def moving(message: JointState) -> JointState:
        message.velocity = [1.0] * ROBOT.n_joints
        return message

    if why == 'it moves':
        compliant.spoil['joint_states'] = moving
    compliant.run(1.5, playing=float(why == 'a cycle plays'))
    if why == 'the clock jumps':
        compliant.time += 900 * 10**9
        compliant.run(10 * compliant.step, playing=0.0)
    answer = compliant.user.call('admittance_node/tare', succeeds=False)
    assert '50 efforts at rest' in answer.message
