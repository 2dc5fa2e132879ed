"""Sidewinding over real topics on real physics: the gait node and the bridge in lock step."""

from __future__ import annotations

import math

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from ros_graph import Graph, User
from turner import ROBOT, CommandWatch, Turner

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.nodes.admittance_node import AdmittanceNode
from omega_turn_ros.nodes.gait_node import GaitNode
from omega_turn_ros.nodes.messages import heading_of
from omega_turn_sim_bridge.bridge_node import PyBulletBridge

RATE = {'rate': 50.0, 'lock_step': True}
PHYSICS_PATIENCE = 200.0  # [s] for a run that takes 15 s on an idle core


@pytest.mark.slow
def test_a_turn_by_ninety_degrees_ends_within_two(graph: Graph) -> None:
    user = User(graph)
    graph.add(PyBulletBridge, **RATE, lock_step_timeout=60.0, start_paused=True)
    odom: list[Odometry] = user.hear(Odometry, 'odom')
    limits = JointLimits(ROBOT.position_limit, ROBOT.velocity_limit, 0.1)
    watch = CommandWatch(user.node, limits, np.zeros(ROBOT.n_joints))
    # It waits for no wave_amplitudes, though compliance is on: it has no amplitudes to change.
    graph.add(GaitNode, gait='sidewinding', heading_feedback='odom', **RATE)
    user.turn(0.5 * math.pi)
    graph.spin_until(lambda: 0.5 * math.pi in user.remaining, 'an accepted turn')
    user.call('pybullet_bridge/resume')
    graph.spin_until(lambda: user.remaining[-1] == 0.0, 'the end', PHYSICS_PATIENCE)
    headings = np.unwrap([heading_of(message) for message in odom])
    assert headings[-1] - headings[0] == pytest.approx(0.5 * math.pi, abs=math.radians(2.0))
    assert np.abs(watch.positions[:, 1::2]).max() > 0.1  # it did lift itself


def test_the_gait_is_changed_between_turns_and_stopped_like_any_other(graph: Graph) -> None:
    turner = Turner(graph)
    assert turner.user.set_parameter('gait_node', 'gait', 'sidewinding').successful
    turner.start_turn(1.0)
    graph.spin_until(lambda: np.abs(turner.watch.newest[1::2]).max() > 0.1, 'a lifted body')
    assert not turner.user.set_parameter('gait_node', 'gait', 'omega').successful
    turner.user.call('gait_node/stop')
    held = turner.wait_for_commands(5)
    assert (held == held[0]).all()
    turner.user.call('gait_node/reset')
    turner.start_turn(-0.4)
    turner.wait_for_end()


def test_admittance_refuses_a_gait_without_amplitudes(graph: Graph) -> None:
    with pytest.raises(BadInputError, match=r"^gait: got 'sidewinding'.*yield"):
        graph.add(AdmittanceNode, gait='sidewinding')
