"""The PyBullet bridge as a ROS node: commands, services, clock."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from ros_graph import Graph, User
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from turner import ROBOT

from omega_turn_ros.nodes.time import nanoseconds_of, stamp_of
from omega_turn_sim_bridge.bridge_node import PyBulletBridge

NAMES = list(ROBOT.joint_names)
TARGET = np.where(np.arange(ROBOT.n_joints) % 2 == 0, np.linspace(0.1, 0.5, ROBOT.n_joints), 0.0)
TAIL = ROBOT.n_joints - 2  # index of the last yaw joint
REACHED = 0.03  # [rad] from the target, by a motor that works against friction


class Bridged:
    """A bridge, as fast as it can unless told otherwise, and its user.

    Args:
        graph: the graph to live on.
        parameters: of the bridge.
    """

    def __init__(self, graph: Graph, **parameters: Any) -> None:
        self.graph, self.user = graph, User(graph)
        self.states = self.user.hear(JointState, 'joint_states')
        self.odom = self.user.hear(Odometry, 'odom')
        self.clock = self.user.hear(Clock, '/clock')
        self.node = graph.add(PyBulletBridge, **{'real_time_factor': 0.0, **parameters})

    @property
    def posture(self) -> np.ndarray:
        """The newest reading [rad], shape (n_joints,)."""
        return np.array(self.states[-1].position)

    def stamps(self) -> list[int]:
        """Stamps of all readings so far [ns]."""
        return [nanoseconds_of(m.header.stamp) for m in self.states]

    def command(self, target: np.ndarray, stamp: int = 0) -> None:
        """Send one command [rad]."""
        message = JointState(name=NAMES, position=target.tolist())
        message.header.stamp = stamp_of(stamp)
        self.user.send('joint_commands', message)

    def wait_for_readings(self, count: int) -> None:
        """Wait for so many more readings."""
        before = len(self.states)
        self.graph.spin_until(lambda: len(self.states) >= before + count, f'{count} readings')

    def wait_for_posture(self, target: np.ndarray) -> None:
        """Wait until the robot has come to a posture [rad]."""
        self.graph.spin_until(
            lambda: self.states and np.abs(self.posture - target).max() < REACHED, 'the posture'
        )


BAD_COMMANDS: dict[str, JointState] = {
    'nan': JointState(name=NAMES, position=[math.nan] + [0.8] * 15),
    'infinity': JointState(name=NAMES, position=[0.8] * 15 + [math.inf]),
    'short': JointState(name=NAMES, position=[0.8] * 15),
    'long': JointState(name=NAMES, position=[0.8] * 17),
    'missing joint': JointState(name=NAMES[:-1], position=[0.8] * 15),
    'unknown joint': JointState(name=[*NAMES[:-1], 'arm'], position=[0.8] * 16),
    'doubled joint': JointState(name=[*NAMES, NAMES[0]], position=[0.8] * 17),
    'empty': JointState(),
}


@pytest.mark.parametrize('bad', BAD_COMMANDS.values(), ids=BAD_COMMANDS)
@pytest.mark.parametrize('lock_step', [False, True], ids=['free', 'lock_step'])
def test_bad_commands_are_dropped_whole_and_counted(
    graph: Graph, bad: JointState, lock_step: bool
) -> None:
    bridged = Bridged(graph, lock_step=lock_step, lock_step_timeout=0.1)
    for _ in range(2):
        bridged.user.send('joint_commands', bad)
    graph.spin_until(
        lambda: bridged.user.refused('pybullet_bridge', 'joint_commands') == 2, 'refusals'
    )
    bridged.wait_for_readings(3)
    assert np.abs(bridged.posture).max() < REACHED
    bridged.command(TARGET)
    graph.spin_until(lambda: np.abs(bridged.posture).max() > REACHED, 'a robot that obeys')


def test_commands_are_read_by_name_in_any_order(graph: Graph) -> None:
    bridged = Bridged(graph, command_timeout=60.0)
    bridged.user.send(
        'joint_commands', JointState(name=NAMES[::-1], position=TARGET[::-1].tolist())
    )
    bridged.wait_for_posture(TARGET)


def test_readings_are_complete_and_stamped_alike(graph: Graph) -> None:
    bridged = Bridged(graph, body_frame='snake')
    bridged.wait_for_readings(5)
    graph.spin_until(lambda: len(bridged.odom) >= 5 and len(bridged.clock) >= 5, 'odom and clock')
    for state in bridged.states[:5]:
        assert list(state.name) == NAMES
        assert state.header.frame_id == 'snake'
        for field in (state.position, state.velocity, state.effort):
            assert len(field) == len(NAMES) and np.isfinite(field).all()
    assert (bridged.odom[0].header.frame_id, bridged.odom[0].child_frame_id) == ('odom', 'snake')
    stamps = [o.header.stamp for o in bridged.odom]
    stamps_of_states = [s.header.stamp for s in bridged.states]
    # A listener may join between two topics of one instant; from there on they agree.
    assert set(map(nanoseconds_of, stamps)) & set(map(nanoseconds_of, stamps_of_states))
    assert np.allclose(np.diff(bridged.stamps()), 10_000_000)
    assert np.allclose(np.diff([nanoseconds_of(c.clock) for c in bridged.clock]), 10_000_000)


def test_without_a_clock_of_its_own_it_stamps_with_the_time_of_day(graph: Graph) -> None:
    bridged = Bridged(graph, publish_clock=False, real_time_factor=1.0)
    bridged.wait_for_readings(10)
    now = bridged.user.node.get_clock().now().nanoseconds
    assert abs(now - bridged.stamps()[-1]) < 60e9
    assert bridged.user.node.count_publishers('/clock') == 0
    assert not bridged.clock


def test_reset_lays_the_robot_straight_at_the_origin_and_time_goes_on(graph: Graph) -> None:
    bridged = Bridged(graph, command_timeout=60.0)
    bridged.command(TARGET)
    bridged.wait_for_posture(TARGET)
    before = bridged.stamps()[-1]
    bridged.user.call('pybullet_bridge/reset')
    bridged.wait_for_posture(np.zeros(ROBOT.n_joints))
    graph.spin_until(
        lambda: nanoseconds_of(bridged.odom[-1].header.stamp) > before + 50_000_000, 'odom'
    )
    pose = bridged.odom[-1].pose.pose
    assert math.hypot(pose.position.x, pose.position.y) < 0.02
    assert abs(pose.orientation.z) < 0.01
    assert np.all(np.diff(bridged.stamps()) > 0)


@pytest.mark.parametrize('lock_step', [False, True], ids=['free', 'lock_step'])
def test_pause_halts_time_and_resume_lets_it_go_on(graph: Graph, lock_step: bool) -> None:
    bridged = Bridged(graph, start_paused=True, lock_step=lock_step, lock_step_timeout=0.1)
    bridged.user.wait_for_problem('pybullet_bridge', 'paused')
    assert len(set(bridged.stamps())) <= 1

    bridged.user.call('pybullet_bridge/resume')
    bridged.wait_for_readings(3)
    bridged.user.call('pybullet_bridge/pause')
    bridged.user.wait_for_problem('pybullet_bridge', 'paused')
    halted = float(bridged.user.fact('pybullet_bridge', 'simulated time [s]'))
    bridged.command(TARGET, bridged.stamps()[-1])
    for _ in range(5):
        assert float(bridged.user.fact('pybullet_bridge', 'simulated time [s]')) == halted

    bridged.user.call('pybullet_bridge/resume')
    bridged.command(TARGET, bridged.stamps()[-1])
    graph.spin_until(lambda: np.abs(bridged.posture).max() > REACHED, 'a robot that obeys')
    assert bridged.stamps()[-1] * 1e-9 > halted


def test_the_last_command_holds_while_it_is_young(graph: Graph) -> None:
    bridged = Bridged(graph, command_timeout=60.0)
    bridged.command(TARGET)
    bridged.wait_for_posture(TARGET)
    bridged.user.wait_for_fact('pybullet_bridge', 'refused joint_commands', '')
    assert bridged.user.health['pybullet_bridge'].message == 'OK'
    bridged.wait_for_readings(50)
    bridged.wait_for_posture(TARGET)


def test_after_the_timeout_the_posture_is_held_and_the_old_command_forgotten(
    graph: Graph,
) -> None:
    # In lock step each reading without an answer comes later than the timeout of the command.
    bridged = Bridged(graph, lock_step=True, lock_step_timeout=0.2, command_timeout=0.1, rate=20.0)
    bridged.wait_for_readings(1)
    wag = np.zeros(ROBOT.n_joints)
    wag[TAIL] = 1.5
    while bridged.posture[TAIL] < 0.3:
        bridged.command(wag, bridged.stamps()[-1])
        bridged.wait_for_readings(1)
    bridged.user.wait_for_problem('pybullet_bridge', 'no commands: posture held')
    last = bridged.stamps()[-1]
    graph.spin_until(lambda: bridged.stamps()[-1] >= last + 600_000_000, 'a servo at rest')
    assert 0.2 < bridged.posture[TAIL] < 1.0


def test_lock_step_waits_for_the_answer_and_asks_again(graph: Graph) -> None:
    bridged = Bridged(graph, lock_step=True, lock_step_timeout=60.0)
    bridged.wait_for_readings(3)
    assert set(bridged.stamps()) == {0}
    bridged.command(TARGET, stamp=12345)  # answers another question
    bridged.wait_for_readings(1)
    assert set(bridged.stamps()) == {0}
    bridged.command(TARGET, stamp=0)
    graph.spin_until(lambda: set(bridged.stamps()) == {0, 10_000_000}, 'the next reading')


def test_lock_step_goes_on_alone_when_nobody_answers(graph: Graph) -> None:
    bridged = Bridged(graph, lock_step=True, lock_step_timeout=0.3)
    graph.spin_until(lambda: len(set(bridged.stamps())) >= 3, 'readings')


def test_noise_is_drawn_from_the_seed(graph: Graph) -> None:
    def first_readings(seed: int) -> list[Callable[..., Any]]:
        bridged = Bridged(graph, position_noise=0.01, seed=seed, start_paused=True)
        bridged.user.call('pybullet_bridge/resume')
        bridged.wait_for_readings(3)
        first = next(list(s.position) for s in bridged.states if s.header.stamp.nanosec == 0)
        graph.remove(bridged.node)
        return first

    assert first_readings(1) == first_readings(1)
    assert first_readings(1) != first_readings(2)
