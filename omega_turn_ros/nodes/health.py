"""What a node says about itself: counters, throttled warnings and diagnostics."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Mapping

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

WARN_EVERY = 2.0  # [s] per topic of complaint
PUBLISH_EVERY = 1.0  # [s]


class Freshness:
    """Whether something has arrived lately, on a steady clock; stale until the first arrival.

    Args:
        timeout: [s]; 0 never goes stale once something has arrived.
    """

    def __init__(self, timeout: float = 0.0) -> None:
        self.timeout = timeout
        self._last: float | None = None

    def mark(self) -> None:
        """Note an arrival."""
        self._last = time.monotonic()

    @property
    def fresh(self) -> bool:
        """Whether the last arrival is within the timeout."""
        return self._last is not None and (self.timeout == 0.0 or self.age <= self.timeout)

    @property
    def age(self) -> float:
        """Time since the last arrival [s], infinite before the first."""
        return math.inf if self._last is None else time.monotonic() - self._last


class Health:
    """Counts refused inputs, warns about them without flooding, publishes diagnostics.

    Args:
        node: the node that speaks.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._refused: Counter[str] = Counter()
        self._spoke: dict[str, float] = {}
        self._publisher = node.create_publisher(DiagnosticArray, 'diagnostics', 10)

    def ready(self, what: str) -> None:
        """Say once, at the end of the start, what the node works with."""
        self._node.get_logger().info(f'{self._node.get_name()} ready: {what}')

    def refuse(self, topic: str, reason: str) -> None:
        """Count a message that was dropped whole and warn, throttled per topic."""
        self._refused[topic] += 1
        self.warn(topic, f'{topic}: message dropped: {reason}')

    def warn(self, key: str, text: str) -> None:
        """Log a warning, at most one per key and WARN_EVERY."""
        if self._due(key):
            self._node.get_logger().warning(text)

    def note(self, key: str, text: str) -> None:
        """Log an information, at most one per key and WARN_EVERY."""
        if self._due(key):
            self._node.get_logger().info(text)

    def _due(self, key: str) -> bool:
        now = time.monotonic()
        if now - self._spoke.get(key, -math.inf) < WARN_EVERY:
            return False
        self._spoke[key] = now
        return True

    @property
    def refused(self) -> dict[str, int]:
        """Dropped messages per topic."""
        return dict(self._refused)

    def publish(
        self, problems: list[str], values: Mapping[str, object], stamp: Time | None = None
    ) -> None:
        """Publish one DiagnosticArray.

        Args:
            problems: what is wrong right now; empty means OK.
            values: facts, in order.
            stamp: time of the facts; None for the node's clock.
        """
        status = DiagnosticStatus(name=self._node.get_fully_qualified_name())
        status.level = DiagnosticStatus.WARN if problems else DiagnosticStatus.OK
        status.message = '; '.join(problems) or 'OK'
        status.hardware_id = self._node.get_namespace()
        facts = dict(values)
        facts.update({f'refused {topic}': n for topic, n in self._refused.items()})
        status.values = [KeyValue(key=k, value=_text(v)) for k, v in facts.items()]
        message = DiagnosticArray(status=[status])
        message.header.stamp = stamp or self._node.get_clock().now().to_msg()
        self._publisher.publish(message)


def steady_clock() -> Clock:
    """Clock for watchdogs: neither simulated time nor the system clock's steps touch it."""
    return Clock(clock_type=ClockType.STEADY_TIME)


def _text(value: object) -> str:
    return f'{value:.6g}' if isinstance(value, float) else str(value)
