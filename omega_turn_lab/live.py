"""Running nodes inside this process: one context, one executor thread per node, real topics."""

from __future__ import annotations

import contextlib
import math
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from omega_turn_lab.run_record import RunRecord
from omega_turn_ros.errors import OmegaTurnError
from omega_turn_ros.nodes.health import steady_clock
from omega_turn_ros.nodes.inbox import Inbox
from omega_turn_ros.nodes.messages import heading_of, uprightness_of
from omega_turn_ros.nodes.qos import LATCHED, STATE
from omega_turn_ros.nodes.time import nanoseconds_of
from omega_turn_ros.robot import Robot

POLL = 0.02  # [s] between two looks at a condition
LOOK_EVERY = 0.05  # [s] between two looks at the topics; watching must not slow the run
QUEUE = 1000  # messages kept meanwhile


class NodeError(OmegaTurnError, RuntimeError):
    """A node did not do what it must within its time."""


class Stack:
    """Nodes of one run in one executor, spun by a thread.

    One thread for all is faster than one each: the nodes take turns anyway, and share one
    interpreter lock.

    Args:
        domain_id: DDS domain.
    """

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        self.context.init(domain_id=domain_id)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._nodes: list[Node] = []
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def __enter__(self) -> Stack:
        """Return the stack itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop the thread, then destroy the nodes."""
        self.close()

    def add(self, make_node: Callable[..., Node], **parameters: Any) -> Any:
        """Build a node with parameter values and let it run.

        Args:
            make_node: called with `context` and `parameter_overrides`.
            parameters: start values.
        """
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        node = make_node(context=self.context, parameter_overrides=overrides)
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def close(self) -> None:
        """Stop the thread, destroy the nodes and shut the context down."""
        self._executor.shutdown(timeout_sec=2.0)
        self._thread.join(timeout=5.0)
        for node in self._nodes:
            node.destroy_node()
        self._nodes.clear()
        self.context.try_shutdown()

    def _spin(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            self._executor.spin()


class Observer(Node):
    """Collects what a run looks like from outside.

    Args:
        robot: whose joint order is kept.
        context: rclpy context.
        options: passed on to `rclpy.node.Node`.
    """

    def __init__(self, robot: Robot, context: Context | None = None, **options: Any) -> None:
        super().__init__('omega_turn_observer', context=context, **options)
        self._names = list(robot.joint_names)
        self._odom: list[tuple[int, float, float, float, float]] = []  # with the way up
        self._positions: dict[int, list[float]] = {}
        self._commands: dict[int, list[float]] = {}
        self._remaining_log: list[tuple[int, float]] = []
        self.remaining: float | None = None
        deep = QoSProfile(depth=QUEUE)
        self._inboxes = (
            (Inbox(self, Odometry, 'odom', deep), self._on_odom),
            (Inbox(self, JointState, 'joint_states', deep), self._on_states),
            (Inbox(self, JointState, 'joint_commands', deep), self._on_commands),
            (Inbox(self, Float64, 'turn_remaining', LATCHED), self._on_remaining),
        )
        self.turn_angle = self.create_publisher(Float64, 'turn_angle', STATE)
        self.create_timer(LOOK_EVERY, self._look, clock=steady_clock())

    def _look(self) -> None:
        for inbox, handle in self._inboxes:
            for message in inbox.drain():
                handle(message)

    @property
    def heading(self) -> float:
        """Heading since the first odom, over all turns [rad]."""
        yaw = np.unwrap([row[3] for row in self._odom])
        return float(yaw[-1] - yaw[0]) if self._odom else 0.0

    @property
    def simulated_time(self) -> float:
        """Span of the odom stamps [s]."""
        return (self._odom[-1][0] - self._odom[0][0]) * 1e-9 if self._odom else 0.0

    def record(self, settle: float = math.inf) -> RunRecord:
        """What was seen, sampled at the odom stamps.

        Args:
            settle: leave out what came later than this after the last change of the command
                [s]; a moment that is the same in every run, unlike the one of looking.

        Raises:
            NodeError: no odom or no joint states were seen.
        """
        odom = {row[0]: row[1:] for row in self._odom}
        end = self._last_change() + settle * 1e9
        stamps = [stamp for stamp in sorted(odom) if stamp in self._positions and stamp <= end]
        if len(stamps) < 2:
            raise NodeError('no odom and joint_states were seen')
        pose = np.array([odom[stamp] for stamp in stamps])
        pose, sides = pose[:, :3], np.copysign(1.0, pose[:, 3:])
        pose[:, 2] = np.unwrap(pose[:, 2])
        positions = sides * np.array([self._positions[stamp] for stamp in stamps])
        commands, last = [], self._positions[stamps[0]]
        for stamp in stamps:
            last = self._commands.get(stamp, last)
            commands.append(last)
        time_ = (np.array(stamps) - stamps[0]) * 1e-9
        remaining = self._remaining_at(stamps)
        return RunRecord(time_, pose, positions, np.array(commands), remaining)

    def _last_change(self) -> int:
        """Stamp of the last command that differs from the one before [ns]."""
        stamps = sorted(self._commands)
        for before, after in zip(stamps[-2::-1], stamps[::-1]):
            if self._commands[before] != self._commands[after]:
                return after
        return 0

    def _remaining_at(self, stamps: list[int]) -> np.ndarray:
        log = self._remaining_log or [(0, 0.0)]
        index = np.searchsorted([stamp for stamp, _ in log], stamps, side='right') - 1
        return np.array([log[max(i, 0)][1] for i in index])

    def _on_odom(self, message: Odometry) -> None:
        position = message.pose.pose.position
        stamp = nanoseconds_of(message.header.stamp)
        if not self._odom or stamp > self._odom[-1][0]:
            heading, upright = heading_of(message), uprightness_of(message)
            self._odom.append((stamp, position.x, position.y, heading, upright))

    def _on_states(self, message: JointState) -> None:
        self._positions[nanoseconds_of(message.header.stamp)] = self._ordered(message)

    def _on_commands(self, message: JointState) -> None:
        self._commands[nanoseconds_of(message.header.stamp)] = self._ordered(message)

    def _ordered(self, message: JointState) -> list[float]:
        place = dict(zip(message.name, message.position))
        return [place[name] for name in self._names]

    def _on_remaining(self, message: Float64) -> None:
        self.remaining = message.data
        now = self._odom[-1][0] if self._odom else 0
        self._remaining_log.append((now, message.data))


def wait_until(condition: Callable[[], bool], timeout: float, what: str) -> None:
    """Wait for a condition that other threads bring about.

    Raises:
        NodeError: it did not come true within `timeout` [s].
    """
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            raise NodeError(f'waited {timeout:g} s in vain for {what}')
        time.sleep(POLL)
