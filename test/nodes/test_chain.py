"""The whole chain on real physics: gait node, admittance node and bridge in lock step."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from rclpy.node import Node
from ros_graph import Graph, User
from sensor_msgs.msg import JointState
from turner import ROBOT, CommandWatch

from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.nodes.admittance_node import AdmittanceNode
from omega_turn_ros.nodes.gait_node import GaitNode
from omega_turn_ros.nodes.messages import heading_of
from omega_turn_ros.nodes.time import nanoseconds_of
from omega_turn_sim_bridge.bridge_node import PyBulletBridge

RATE = {'rate': 50.0, 'lock_step': True}  # half the messages of the default rate
BRIDGE = {**RATE, 'lock_step_timeout': 60.0, 'start_paused': True}
PHYSICS_PATIENCE = 200.0  # [s] for a run that takes 15 s on an idle core


class Chain:
    """Three nodes in lock step, paused at the start, and their user.

    Args:
        graph: the graph to live on.
        below: their namespace.
    """

    def __init__(self, graph: Graph, below: str = '') -> None:
        self.graph, self.user = graph, User(graph, below)
        # The bridge first: what it says before the others are there reaches none of them.
        self.bridge = graph.add(PyBulletBridge, below, **BRIDGE)
        self.states: list[JointState] = self.user.hear(JointState, 'joint_states')
        self.odom: list[Odometry] = self.user.hear(Odometry, 'odom')
        limits = JointLimits(ROBOT.position_limit, ROBOT.velocity_limit, 0.1)
        self.watch = CommandWatch(self.user.node, limits, np.zeros(ROBOT.n_joints))
        self.nodes: list[Node] = [
            graph.add(AdmittanceNode, below, lock_step=True),
            graph.add(GaitNode, below, heading_feedback='odom', **RATE),
        ]

    def start_turn(self, angle: float) -> None:
        """Ask for a turn [rad] before time begins, then let it begin."""
        self.user.turn(angle)
        self.graph.spin_until(lambda: angle in self.user.remaining, 'an accepted turn')
        self.user.call('pybullet_bridge/resume')

    def wait_until(self, seconds: float) -> None:
        """Wait for a reading of that simulated time [s]."""
        self.graph.spin_until(
            lambda: (
                self.states
                and nanoseconds_of(self.states[-1].header.stamp) >= round(seconds * 1e9)
            ),
            f'{seconds} simulated seconds',
            PHYSICS_PATIENCE,
        )

    def headings(self) -> np.ndarray:
        """Heading of each odom message [rad, continuous]."""
        return np.unwrap([heading_of(message) for message in self.odom])


@pytest.mark.slow
def test_a_turn_by_ninety_degrees_ends_within_two(graph: Graph) -> None:
    chain = Chain(graph)
    chain.start_turn(0.5 * math.pi)
    graph.spin_until(lambda: chain.user.remaining[-1] == 0.0, 'the end', PHYSICS_PATIENCE)
    headings = chain.headings()
    assert headings[-1] - headings[0] == pytest.approx(0.5 * math.pi, abs=math.radians(2.0))
    assert np.abs(chain.watch.positions).max() > 1.0


@pytest.mark.slow
def test_lock_step_runs_are_the_same_to_the_last_bit(graph: Graph) -> None:
    def run(below: str) -> list[tuple[Any, ...]]:
        chain = Chain(graph, below)
        chain.start_turn(0.5 * math.pi)
        chain.wait_until(4.0)
        for node in (chain.bridge, *chain.nodes):
            graph.remove(node)
        readings = {
            nanoseconds_of(m.header.stamp): (*m.position, *m.velocity, *m.effort)
            for m in chain.states
        }
        return [readings[stamp] for stamp in sorted(readings) if stamp <= 4e9]

    first = run('first')
    assert len(first) == 201
    assert np.abs(np.array(first)[:, : ROBOT.n_joints]).max() > 1.0
    assert run('second') == first
