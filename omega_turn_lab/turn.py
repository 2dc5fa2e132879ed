"""`omega_turn turn`: command nodes that already run, show progress, stop on Ctrl-C."""

from __future__ import annotations

import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64
from tqdm import tqdm

import omega_turn_lab.ros_environment  # noqa: F401  (first: it may restart the interpreter)
from omega_turn_lab.live import NodeError
from omega_turn_ros.nodes.qos import LATCHED, REQUEST
from omega_turn_ros.nodes.runner import ENDINGS


class TurnClient(Node):
    """Publishes one turn and follows `turn_remaining`.

    Args:
        context: rclpy context.
        options: passed on to `rclpy.node.Node`.
    """

    def __init__(self, context: Context, **options: Any) -> None:
        super().__init__('omega_turn_client', context=context, **options)
        self.remaining: float | None = None
        self._publisher = self.create_publisher(Float64, 'turn_angle', REQUEST)
        self.create_subscription(Float64, 'turn_remaining', self._on_remaining, LATCHED)

    @property
    def connected(self) -> bool:
        """Whether a gait node listens and has spoken."""
        return self.count_subscribers('turn_angle') > 0 and self.remaining is not None

    def send(self, angle: float) -> None:
        """Publish a turn [rad]."""
        self._publisher.publish(Float64(data=angle))

    def _on_remaining(self, message: Float64) -> None:
        self.remaining = message.data


def run_turn(deg: float, namespace: str, domain_id: int | None, timeout: float) -> int:
    """Command a turn and wait for its end.

    Args:
        deg: turn [deg], + = counter-clockwise.
        namespace: of the gait node, '' for none.
        domain_id: DDS domain; None takes ROS_DOMAIN_ID or 0.
        timeout: for the gait node to appear and to accept [s].

    Returns:
        0 when the turn has ended, 130 when Ctrl-C ended it.

    Raises:
        NodeError: no gait node, or it did not accept the turn.
    """
    context = Context()
    rclpy.init(
        context=context, domain_id=domain_id, signal_handler_options=SignalHandlerOptions.NO
    )
    client = TurnClient(context, namespace=namespace)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(client)
    # A flag, not KeyboardInterrupt: that would break into the middle of rclpy.
    interrupted = threading.Event()
    old = {s: signal.signal(s, lambda *_: interrupted.set()) for s in ENDINGS}
    try:
        _wait(executor, lambda: client.connected, timeout, _missing(domain_id), interrupted)
        client.send(math.radians(deg))
        if deg != 0.0:
            what = 'the gait node to accept the turn (stopped? call gait_node/reset)'
            _wait(executor, lambda: client.remaining != 0.0, timeout, what, interrupted)
        _follow(executor, client, abs(deg), interrupted)
        if interrupted.is_set():
            client.send(0.0)
            _wait(executor, lambda: client.remaining == 0.0, timeout, 'the turn to end')
            print('turn ended on request', file=sys.stderr)
            return 130
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)
        client.destroy_node()
        context.try_shutdown()
    print(f'turned {deg:+.1f} deg')
    return 0


def _missing(domain_id: int | None) -> str:
    domain = domain_id if domain_id is not None else os.environ.get('ROS_DOMAIN_ID', '0')
    return (
        f'a gait node on domain {domain} (does it run? the launch file uses the domain it prints: '
        'pass it with --domain-id)'
    )


def _wait(
    executor: SingleThreadedExecutor,
    condition: Callable[[], bool],
    timeout: float,
    what: str,
    interrupted: threading.Event | None = None,
) -> None:
    end = time.monotonic() + timeout
    while not condition() and not (interrupted is not None and interrupted.is_set()):
        if time.monotonic() > end:
            raise NodeError(f'waited {timeout:g} s in vain for {what}')
        executor.spin_once(timeout_sec=0.05)


def _follow(
    executor: SingleThreadedExecutor,
    client: TurnClient,
    size_deg: float,
    interrupted: threading.Event,
) -> None:
    bar_format = '{desc} {percentage:3.0f}%|{bar}| {n:.1f}/{total:.1f} deg [{elapsed}]'
    with tqdm(total=size_deg, desc='turning', bar_format=bar_format, mininterval=0.2) as bar:
        while client.remaining != 0.0 and not interrupted.is_set():
            executor.spin_once(timeout_sec=0.1)
            left = abs(math.degrees(client.remaining or 0.0))
            bar.n = min(max(size_deg - left, 0.0), size_deg)
            bar.update(0)
        if client.remaining == 0.0:
            bar.n = size_deg
        bar.refresh()
