"""A gait node that turns a fake robot while a watch checks every command."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.qos import QoSProfile
from ros_graph import DEEP, Graph, User
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.trajectory import heading_along
from omega_turn_ros.nodes.gait_node import WAVES, GaitNode
from omega_turn_ros.nodes.qos import COMMAND, STATE
from omega_turn_ros.nodes.time import nanoseconds_of, stamp_of
from omega_turn_ros.robot import Robot, load_robot

Array = NDArray[np.float64]

ROBOT = load_robot('limbless16')
STEP = 0.01  # [s] between two commands of a gait node at its default rate
LONGEST_STEP = 2.5 * STEP  # [s] a gait node moves on for at most, however late it wakes
ROUNDING = 1e-9
TURN_PATIENCE = 120.0  # [s] for a turn that takes 2 s on an idle core

# As fast as the robot's own joint speed allows, for tests that run on the robot's time.
QUICK = {'period': 4.5, 'move_velocity': 2.5}
# A turn in about 2 s, for tests that run on the wall clock.
BRISK = {
    'period': 1.0,
    'move_velocity': 8.0,
    'phase_ramp_time': 0.1,
    'velocity_limit': 15.0,
    'step_limit': 0.3,
    'lock_step': False,
}


class CommandWatch:
    """Records `joint_commands` and fails the test at the first that breaks a limit.

    Args:
        node: that listens.
        limits: to be kept.
        start: posture before the first command [rad], shape (n_joints,).
        robot: that is commanded.
    """

    def __init__(
        self, node: Node, limits: JointLimits, start: Array, robot: Robot = ROBOT
    ) -> None:
        self.limits, self.robot = limits, robot
        self.messages: list[JointState] = []
        self._last, self._stamp = start, -1
        node.create_subscription(JointState, 'joint_commands', self.check, DEEP)

    @property
    def positions(self) -> Array:
        """All commands so far [rad], shape (n_commands, n_joints)."""
        return np.array([m.position for m in self.messages]).reshape(-1, self.robot.n_joints)

    @property
    def newest(self) -> Array:
        """The last command, or the posture before the first [rad], shape (n_joints,)."""
        return self._last

    def check(self, message: JointState) -> None:
        """Compare one command with the one before it."""
        stamp = nanoseconds_of(message.header.stamp)
        seconds = STEP if self._stamp < 0 else (stamp - self._stamp) * 1e-9
        dt = min(max(seconds, 0.0), LONGEST_STEP)
        now, rates = np.array(message.position), np.array(message.velocity)
        assert list(message.name) == list(self.robot.joint_names)
        assert now.shape == rates.shape == (self.robot.n_joints,)
        assert np.isfinite(now).all() and np.isfinite(rates).all()
        step = np.abs(now - self._last).max()
        assert np.abs(now).max() <= self.limits.position + ROUNDING
        assert step <= self.limits.step + ROUNDING
        assert step <= self.limits.velocity * dt + ROUNDING
        assert np.abs(rates).max() <= self.limits.velocity * (1.0 + 1e-6)
        self._last, self._stamp = now, stamp
        self.messages.append(message)


class FakeRobot:
    """A robot that goes at once where it is told, on ground as the quasi-static model has it.

    Attributes:
        posture: joint angles [rad], shape (n_joints,).
        efforts: what its joints report [N m], shape (n_joints,).
        offsets: amplitude offsets of (forward, turning) it asks for [rad]; None for silence.
        heading: of its mean body axis [rad].
        time: its clock [ns].
        spoil: topic -> what to send instead of the honest message; None for silence.

    Args:
        graph: the graph to live on.
        below: its namespace.
        posture: at the start [rad], shape (n_joints,).
        stepped: move its time on by one step with each answer to its last message, and ask again
            where none comes; otherwise the wall clock drives it.
        clock: publish its time on /clock.
        turns: work out its heading.
        state_qos: of what it publishes.
    """

    def __init__(
        self,
        graph: Graph,
        below: str = '',
        posture: Array | None = None,
        stepped: bool = True,
        clock: bool = False,
        turns: bool = False,
        state_qos: QoSProfile = STATE,
    ) -> None:
        self.posture = np.zeros(ROBOT.n_joints) if posture is None else np.array(posture, float)
        self.efforts = np.zeros(ROBOT.n_joints)
        self.offsets: tuple[float, float] | None = None
        self.heading, self.time = 0.0, 0
        self.spoil: dict[str, Callable[[Any], Any]] = {}
        self._stepped, self._turns, self._answered = stepped, turns, True
        self._chain = PlanarChain.of_robot(ROBOT)
        self.node = node = graph.add(_robot_node, below)
        self._states = node.create_publisher(JointState, 'joint_states', state_qos)
        self._odom = node.create_publisher(Odometry, 'odom', state_qos)
        self._amplitudes = node.create_publisher(JointState, 'wave_amplitudes', state_qos)
        self._clock = node.create_publisher(Clock, '/clock', STATE) if clock else None
        node.create_subscription(JointState, 'joint_commands', self._on_command, COMMAND)
        node.create_timer(0.05 if stepped else STEP, self._on_timer)

    def _on_command(self, message: JointState) -> None:
        self.obey(np.array(message.position), nanoseconds_of(message.header.stamp))

    def obey(self, target: Array, stamp: int) -> None:
        """Go to the target [rad]; when stepped, move time on if that answers the last message."""
        if self._turns:
            yaw = ROBOT.yaw_indices
            path = np.stack([self.posture[yaw], target[yaw]])
            self.heading += float(heading_along(self._chain, path)[-1])
        self.posture = target
        if self._stepped and stamp == self.time:
            self._answered = True
            self._advance()

    def _on_timer(self) -> None:
        if self._stepped and self._answered:
            self._answered = False  # commands drive it; look again later
        elif self._stepped and self._clock is None:
            self._publish()
        else:
            self._advance()

    def _advance(self) -> None:
        self.time += round(STEP * 1e9)
        self._publish()

    def states(self) -> JointState:
        """Return what an honest robot says now."""
        message = JointState(name=list(ROBOT.joint_names), position=self.posture.tolist())
        message.velocity, message.effort = [0.0] * ROBOT.n_joints, self.efforts.tolist()
        message.header.stamp = stamp_of(self.time)
        return message

    def _publish(self) -> None:
        stamp = stamp_of(self.time)
        if self._clock is not None:
            self._clock.publish(Clock(clock=stamp))
        if self.offsets is not None:
            self._say(self._amplitudes, amplitudes(*self.offsets, stamp=stamp))
        odom = Odometry()
        odom.header.stamp = stamp
        odom.pose.pose.orientation.z = math.sin(0.5 * self.heading)
        odom.pose.pose.orientation.w = math.cos(0.5 * self.heading)
        self._say(self._odom, odom)
        self._say(self._states, self.states())

    def _say(self, publisher: Any, message: Any) -> None:
        topic = publisher.topic_name.rsplit('/', 1)[-1]
        said = self.spoil[topic](message) if topic in self.spoil else message
        if said is not None:
            publisher.publish(said)


def amplitudes(forward: float, turning: float, **header: Any) -> JointState:
    """Offsets of the two wave amplitudes [rad] as a message."""
    message = JointState(name=list(WAVES), position=[forward, turning], velocity=[0.0, 0.0])
    message.header.stamp = header.get('stamp', message.header.stamp)
    return message


def silence(message: Any) -> None:
    """Spoil: say nothing."""


class Turner:
    """A gait node, a robot that obeys it, its user and a watch over its commands.

    Args:
        graph: the graph to live on.
        below: their namespace.
        posture: of the robot at the start [rad], shape (n_joints,).
        clock: the robot publishes /clock and the gait node goes by it.
        turns: the robot works out its heading.
        parameters: of the gait node; in lock step and QUICK unless told otherwise.
    """

    def __init__(
        self,
        graph: Graph,
        below: str = '',
        posture: Array | None = None,
        clock: bool = False,
        turns: bool = False,
        **parameters: Any,
    ) -> None:
        parameters = {'lock_step': not clock, 'use_compliance': False, **QUICK, **parameters}
        self.graph = graph
        self.user = User(graph, below)
        stepped = clock or parameters['lock_step']
        self.robot = FakeRobot(graph, below, posture, stepped, clock, turns)
        limits = JointLimits(
            parameters.get('position_limit', ROBOT.position_limit),
            parameters.get('velocity_limit', ROBOT.velocity_limit),
            parameters.get('step_limit', 0.1),
        )
        start = np.clip(self.robot.posture, -limits.position, limits.position)
        self.watch = CommandWatch(self.user.node, limits, start)
        self.node = graph.add(GaitNode, below, use_sim_time=clock, **parameters)

    def start_turn(self, angle: float) -> None:
        """Ask for a turn [rad] and wait until it has been accepted."""
        remaining, before = self.user.remaining, len(self.user.remaining)
        self.user.turn(angle)
        self.graph.spin_until(lambda: angle in remaining[before:], f'turn_remaining {angle}')

    def wait_for_commands(self, count: int) -> Array:
        """Wait for so many more commands and return them [rad], shape (count, n_joints)."""
        before = len(self.watch.messages)
        self.graph.spin_until(
            lambda: len(self.watch.messages) >= before + count, f'{count} commands'
        )
        return self.watch.positions[before : before + count]

    def wait_for_cycle(self) -> None:
        """Wait until a cycle has bent the body far beyond its start shape."""
        self.graph.spin_until(lambda: np.abs(self.watch.newest).max() > 0.8, 'a cycle')

    def wait_for_end(self) -> None:
        """Wait until the turn is over and the robot lies straight."""
        self.graph.spin_until(lambda: self.user.remaining[-1:] == [0.0], 'the end', TURN_PATIENCE)
        self.graph.spin_until(lambda: not self.watch.newest.any(), 'a straight body')


def _robot_node(**options: Any) -> Node:
    return Node('fake_robot', **options)
