"""`omega_turn turn`: command nodes that already run, show progress, stop on Ctrl-C."""

from __future__ import annotations

import math
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence

from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

import omega_turn_lab.ros_environment  # noqa: F401  (first: it may restart the interpreter)
from omega_turn_lab.live import NodeError
from omega_turn_lab.turn_client import TurnClient
from omega_turn_lab.turn_progress import TurnProgress
from omega_turn_ros.nodes.names import check_namespace
from omega_turn_ros.nodes.runner import ENDINGS, init_ros

# [deg] left at an end that was meant: twice the gait node's usual heading_tolerance.
MEANT = 2.0
HEARSAY = 0.5  # [s] topics are not in order among each other
LAST_WORD = 3.0  # [s] for the end of the turn after Ctrl-C; launch waits 5 s, then uses force


def run_turn(
    deg: float, namespace: str, domain_id: int | None, timeout: float, ros_args: Sequence[str] = ()
) -> int:
    """Command a turn and wait for its end.

    Args:
        deg: turn [deg], + = counter-clockwise.
        namespace: of the gait node, '' for none.
        domain_id: DDS domain; None takes ROS_DOMAIN_ID or 0.
        timeout: for the gait node to appear, to accept and to start [s].
        ros_args: what follows `--ros-args`.

    Returns:
        0 when the turn has ended, 130 when Ctrl-C ended it.

    Raises:
        BadInputError: the namespace is none.
        RosArgumentsError: ROS 2 refuses `ros_args` or the domain.
        NodeError: no gait node, it did not accept or start the turn, or the turn ended early.
    """
    namespace = check_namespace(namespace)
    context = Context()
    init_ros(['--ros-args', *ros_args], context, domain_id)
    # A flag, not KeyboardInterrupt: that would break into the middle of rclpy.
    interrupted = threading.Event()
    old = {s: signal.signal(s, lambda *_: interrupted.set()) for s in ENDINGS}
    try:
        client = TurnClient(context, namespace=namespace)
        return _turn(client, deg, timeout, interrupted)
    finally:
        context.try_shutdown()
        for number, handler in old.items():
            signal.signal(number, handler)


def _turn(client: TurnClient, deg: float, timeout: float, interrupted: threading.Event) -> int:
    executor = SingleThreadedExecutor(context=client.context)
    executor.add_node(client)
    try:
        _wait(executor, lambda: client.connected, timeout, _missing(client), interrupted)
        if interrupted.is_set():
            raise KeyboardInterrupt
        if deg == 0.0:
            return _end(executor, client, timeout, 0)
        client.send(math.radians(deg))
        _accompany(executor, client, timeout, interrupted)
        if interrupted.is_set() and (client.gone or not client.over):
            return _end(executor, client, min(timeout, LAST_WORD), 130)
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


def _accompany(
    executor: SingleThreadedExecutor,
    client: TurnClient,
    timeout: float,
    interrupted: threading.Event,
) -> None:
    """Follow a turn from its sending to its end; one given up must not begin later."""
    what = 'the gait node to accept the turn (stopped? call gait_node/reset; clock paused?)'
    try:
        _wait(executor, lambda: client.accepted or client.over, timeout, what, interrupted)
        _follow(executor, client, timeout, interrupted)
    except NodeError:
        client.cancel()
        raise


def _end(executor: SingleThreadedExecutor, client: TurnClient, timeout: float, code: int) -> int:
    """End the turn under way, of whomever it is, and return the exit code."""
    client.end()
    left = abs(math.degrees(client.left))
    what = 'the turn to end (clock paused?)'
    _wait(executor, lambda: client.remaining == 0.0 or client.gone, timeout, what)
    if client.gone:
        print(f'the gait node went away, {left:.1f} deg left', file=sys.stderr)
        return code or 1
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
        raise NodeError(
            f'stopped with {left} (gait_node/stop, no joint_states, or corrections used up)'
        )


def _missing(client: TurnClient) -> str:
    domain, namespace = client.context.get_domain_id(), client.get_namespace()
    return (
        f'a gait node in namespace {namespace} on domain {domain} (does it run? the launch file '
        'uses the domain it prints: pass it with --domain-id, a namespace with --namespace)'
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
    timeout: float,
    interrupted: threading.Event,
) -> None:
    """Show progress until the turn is over, however it ends.

    Raises:
        NodeError: the gait node had no joint_states to begin with within `timeout` [s].
    """
    end = time.monotonic() + timeout
    progress = TurnProgress(abs(math.degrees(client.asked)))
    try:
        while not client.over and not interrupted.is_set():
            executor.spin_once(timeout_sec=0.1)
            progress.show(abs(math.degrees(client.left)), client.jammed)
            if not client.started and time.monotonic() > end:
                raise NodeError(_unmoved(client, timeout))
    finally:
        progress.close()


def _unmoved(client: TurnClient, timeout: float) -> str:
    silent = not client.count_publishers('joint_states')
    why = 'nobody publishes joint_states' if silent else 'refused, see diagnostics? clock paused?'
    return f'nothing moves: {timeout:g} s without good joint_states ({why}); turn cancelled'
