"""Services and events that the executor looks for now and then, not in every round."""

from __future__ import annotations

from collections.abc import Container

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.service import Service

ROUNDS_OPEN = 2  # ticks in a row, so that a tick that is always late leaves the others their turn


class SeldomGroup(CallbackGroup):
    """Takes a node's services and publisher events over from its default group.

    The executor builds its wait set anew in each round, two rounds per tick, and every entity
    costs CPU whether it has work or not: nine services and the events of five publishers are a
    sixth of what the 100 Hz gait node spends. Those of a closed group are left out; what arrives
    meanwhile waits in the middleware. They still never run beside others of the default group.

    Args:
        node: its present services and events in the default group are taken.
        prompt: services to leave there.
        every: ticks from one opening to the next; with ROUNDS_OPEN or fewer it stays open.
    """

    def __init__(self, node: Node, prompt: Container[Service], every: int) -> None:
        super().__init__()
        self._group = node.default_callback_group
        self._every, self._count = max(every, 1), 0
        self._open = True
        for entity in (*node.services, *node.waitables):
            # Not the events of polled subscriptions: an unread message would wake the executor.
            if entity.callback_group is self._group and entity not in prompt:
                entity.callback_group = self

    def tick(self) -> None:
        """Count one tick of the node's timer; that opens or closes the group."""
        self._count = (self._count + 1) % self._every
        self._open = self._count < ROUNDS_OPEN

    def open(self) -> None:
        """Open until the next tick. For the case that the ticks have ceased."""
        self._open = True

    def can_execute(self, entity: object) -> bool:
        """Whether the executor may wait for the entity in this round."""
        return self._open and bool(self._group.can_execute(entity))

    def beginning_execution(self, entity: object) -> bool:
        """Ask for leave to run the entity's callback."""
        return bool(self._group.beginning_execution(entity))

    def ending_execution(self, entity: object) -> None:
        """Note that the entity's callback has ended."""
        self._group.ending_execution(entity)
