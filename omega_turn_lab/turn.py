"""`omega_turn turn`: command nodes that already run, show progress, stop on Ctrl-C."""

from __future__ import annotations

import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable

import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidNamespaceException
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from tqdm import tqdm

import omega_turn_lab.ros_environment  # noqa: F401  (first: it may restart the interpreter)
from omega_turn_lab.live import NodeError
from omega_turn_lab.turn_client import TurnClient
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.runner import ENDINGS

# [deg] left at an end that was meant: twice the gait node's usual heading_tolerance.
MEANT = 2.0
HEARSAY = 0.5  # [s] topics are not in order among each other


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
        BadInputError: the namespace is none.
        NodeError: no gait node, it did not accept the turn, or the turn ended early.
    """
    context = Context()
    rclpy.init(
        context=context, domain_id=domain_id, signal_handler_options=SignalHandlerOptions.NO
    )
    # A flag, not KeyboardInterrupt: that would break into the middle of rclpy.
    interrupted = threading.Event()
    old = {s: signal.signal(s, lambda *_: interrupted.set()) for s in ENDINGS}
    try:
        return _turn(_client(context, namespace), deg, timeout, _missing(domain_id), interrupted)
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)
        context.try_shutdown()


def _client(context: Context, namespace: str) -> TurnClient:
    try:
        return TurnClient(context, namespace=namespace)
    except InvalidNamespaceException as error:
        expected = 'letters, digits and _, parts divided by /'
        raise BadInputError('namespace', namespace, expected) from error


def _turn(
    client: TurnClient, deg: float, timeout: float, missing: str, interrupted: threading.Event
) -> int:
    executor = SingleThreadedExecutor(context=client.context)
    executor.add_node(client)
    try:
        _wait(executor, lambda: client.connected, timeout, missing, interrupted)
        if interrupted.is_set():
            raise KeyboardInterrupt
        if deg == 0.0:
            return _end(executor, client, timeout, 0)
        client.send(math.radians(deg))
        what = 'the gait node to accept the turn (stopped? call gait_node/reset)'
        _wait(executor, lambda: client.accepted or client.gone, timeout, what, interrupted)
        _follow(executor, client, abs(deg), interrupted)
        if not client.over:
            return _end(executor, client, timeout, 130)
        if abs(math.degrees(client.left)) > MEANT:
            _hear_out(executor, client)
    finally:
        client.destroy_node()
    if client.jams:
        print('the robot was jammed: motors strained and cycles got nowhere', file=sys.stderr)
    _check_end(client)
    heading = client.heading_change
    measured = '' if heading is None else f', odom measured {math.degrees(heading):+.1f} deg'
    print(f'commanded {deg:+.1f} deg, ended{measured}')
    return 0


def _end(executor: SingleThreadedExecutor, client: TurnClient, timeout: float, code: int) -> int:
    """End the turn under way, of whomever it is, and return the exit code."""
    client.send(0.0)
    left = abs(math.degrees(client.left))
    _wait(executor, lambda: client.remaining == 0.0, timeout, 'the turn to end')
    text = f'turn ended on request, {left:.1f} deg left: the body straightens'
    print(f'{text}, and an unfinished cycle mostly loses its angle', file=sys.stderr)
    return code


def _hear_out(executor: SingleThreadedExecutor, client: TurnClient) -> None:
    """Wait for the command of another client, which may arrive after what it did."""
    left, end = client.left, time.monotonic() + HEARSAY
    while client.other is None and not client.gone and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    client.left = left


def _check_end(client: TurnClient) -> None:
    """Raise NodeError where the turn did not end by itself."""
    left = f'{abs(math.degrees(client.left)):.1f} deg left'
    if client.gone:
        raise NodeError(f'the gait node went away, {left}')
    if client.other is not None:
        other = math.degrees(client.other)
        raise NodeError(f'another client commanded {other:+.1f} deg, {left}')
    if abs(math.degrees(client.left)) > MEANT:
        raise NodeError(f'stopped with {left} (gait_node/stop, or its corrections are used up)')


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
    """Show progress until the turn is over, however it ends."""
    bar_format = '{desc} {percentage:3.0f}%|{bar}| {n:.1f}/{total:.1f} deg [{elapsed}]'
    with tqdm(total=size_deg, desc='turning', bar_format=bar_format, mininterval=0.2) as bar:
        while not client.over and not interrupted.is_set():
            executor.spin_once(timeout_sec=0.1)
            bar.n = min(max(size_deg - abs(math.degrees(client.left)), 0.0), size_deg)
            bar.set_description('jammed' if client.jammed else 'turning', refresh=False)
            bar.update(0)
        bar.refresh()
