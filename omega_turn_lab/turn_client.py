"""The node behind `omega_turn turn`: sends one turn, hears what becomes of it."""

from __future__ import annotations

import math
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.event_handler import QoSLivelinessChangedInfo, SubscriptionEventCallbacks
from rclpy.node import Node
from std_msgs.msg import Float64

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.messages import JAMMED, STATES_STALE, heading_of
from omega_turn_ros.nodes.qos import REMAINING_INPUT, REQUEST, STATE, STATE_INPUT

DELIVERY = Duration(seconds=1)  # for a last word to arrive


class TurnClient(Node):
    """Publishes one turn and hears what becomes of it, and what others command.

    Args:
        context: rclpy context.
        options: passed on to `rclpy.node.Node`.

    Attributes:
        remaining: what the gait node said last [rad]; None before its first word.
        asked: the angle sent [rad].
        left: what remained last that was not 0.0, or the angle sent [rad].
        accepted: the gait node has taken up the turn.
        started: since then it has had joint_states, or has made progress.
        gone: the gait node lived, and lives no more.
        jammed: the gait node says the last cycle got nowhere.
        jams: how often it began to say so since the turn was sent.
        other: what another client commanded after us [rad]; None for nothing.
    """

    def __init__(self, context: Context, **options: Any) -> None:
        super().__init__('omega_turn_client', context=context, **options)
        self.remaining: float | None = None
        self.asked = self.left = 0.0
        self.accepted = self.started = self.gone = self.jammed = False
        self.jams = 0
        self.other: float | None = None
        self._sent: list[float] = []
        self._own_heard = False
        self._heading: float | None = None
        self._heading_change = 0.0
        self._publisher = self.create_publisher(Float64, 'turn_angle', REQUEST)
        # Before turn_remaining: who took over is known before the angle is that of another turn.
        self.create_subscription(Float64, 'turn_angle', self._on_angle, REQUEST)
        alive = SubscriptionEventCallbacks(liveliness=self._on_liveliness)
        self.create_subscription(
            Float64, 'turn_remaining', self._on_remaining, REMAINING_INPUT, event_callbacks=alive
        )
        self.create_subscription(Odometry, 'odom', self._on_odom, STATE_INPUT)
        self.create_subscription(DiagnosticArray, 'diagnostics', self._on_health, STATE)

    @property
    def connected(self) -> bool:
        """Whether a gait node has spoken and all who listen, it among them, will hear us."""
        speakers, listeners = (
            [(info.node_namespace, info.node_name) for info in infos]
            for infos in (
                self.get_publishers_info_by_topic('turn_remaining'),
                self.get_subscriptions_info_by_topic('turn_angle'),
            )
        )
        heard = self._publisher.get_subscription_count() >= len(listeners)
        return self.remaining is not None and heard and not set(speakers).isdisjoint(listeners)

    @property
    def over(self) -> bool:
        """Whether our turn has ended in some way."""
        return self.gone or self.other is not None or (self.accepted and self.remaining == 0.0)

    @property
    def heading_change(self) -> float | None:
        """Measured since the turn was sent [rad]; None without odom."""
        return None if self._heading is None else self._heading_change

    def send(self, angle: float) -> None:
        """Publish a turn [rad]."""
        if angle != 0.0:
            self.asked = self.left = angle
            self.accepted = self.started = self.jammed = False
            self.jams = 0
            self._heading_change = 0.0
        self._sent.append(angle)
        self._publisher.publish(Float64(data=angle))

    def cancel(self) -> None:
        """End our turn, unless another client has taken over."""
        if self.other is None and not self.gone:
            self.end()

    def end(self) -> None:
        """End the turn under way and see the request delivered, if anybody still listens."""
        self.send(0.0)
        self._publisher.wait_for_all_acked(DELIVERY)

    def _on_angle(self, message: Float64) -> None:
        if message.data in self._sent:
            self._sent.remove(message.data)
            self._own_heard = True
        elif self._own_heard and self.other is None:
            self.other = message.data

    def _on_remaining(self, message: Float64) -> None:
        self.remaining = message.data
        if self.other is None and message.data != 0.0:
            self.left, self.accepted = message.data, True
            self.started = self.started or message.data != self.asked

    def _on_liveliness(self, event: QoSLivelinessChangedInfo) -> None:
        self.gone = event.alive_count == 0 and event.alive_count_change < 0

    def _on_health(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if not status.name.endswith('/gait_node'):
                continue
            if STATES_STALE not in status.message:
                self.started = self.started or self.accepted
            jammed = JAMMED in status.message
            self.jams += jammed and not self.jammed
            self.jammed = jammed

    def _on_odom(self, message: Odometry) -> None:
        try:
            heading = heading_of(message)
        except BadInputError:
            return
        if self._heading is not None:
            self._heading_change += math.remainder(heading - self._heading, math.tau)
        self._heading = heading
