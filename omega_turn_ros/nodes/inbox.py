"""Subscriptions that a control tick reads, rather than callbacks that interrupt it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Generic, TypeVar

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.qos import QoSProfile

Message = TypeVar('Message')


class _NeverExecuted(CallbackGroup):
    """A group the executor never waits for: its subscriptions are polled."""

    def can_execute(self, entity: object) -> bool:
        return False

    def beginning_execution(self, entity: object) -> bool:
        return False

    def ending_execution(self, entity: object) -> None:
        return None


class Inbox(Generic[Message]):
    """Messages of one topic, handed out when asked for.

    Without `on_arrival` the executor is not woken by a message at all: the middleware keeps the
    newest `depth`, and `drain` takes them. That spares a 100 Hz node one executor round per
    message, and a flood costs no more than `depth` messages per tick. With `on_arrival` each
    message wakes the executor, which calls it.

    Args:
        node: the subscribing node.
        message_type: ROS message class.
        topic: relative name.
        qos: its depth bounds what one `drain` returns.
        on_arrival: called after each message has been stored.
        raw: hand out serialised bytes instead of messages.
    """

    def __init__(
        self,
        node: Node,
        message_type: type[Message],
        topic: str,
        qos: QoSProfile,
        on_arrival: Callable[[], None] | None = None,
        raw: bool = False,
    ) -> None:
        self._stored: deque[Message] = deque(maxlen=qos.depth)
        self._on_arrival = on_arrival
        group = _NeverExecuted() if on_arrival is None else None
        self._depth = qos.depth
        self._subscription = node.create_subscription(
            message_type, topic, self._store, qos, callback_group=group, raw=raw
        )

    def drain(self) -> list[Message]:
        """Return the messages since the last call, oldest first."""
        if self._on_arrival is not None:
            messages = list(self._stored)
            self._stored.clear()
            return messages
        messages = []
        subscription = self._subscription
        with subscription.handle:
            for _ in range(self._depth):
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
                if taken is None:
                    break
                messages.append(taken[0])
        return messages

    @property
    def topic(self) -> str:
        """Resolved topic name."""
        return str(self._subscription.topic_name)

    def _store(self, message: Message) -> None:
        self._stored.append(message)
        if self._on_arrival is not None:
            self._on_arrival()
