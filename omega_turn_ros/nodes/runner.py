"""One ending for every node: exit code 0 on SIGINT and SIGTERM, 2 on bad settings."""

from __future__ import annotations

import gc
import os
import re
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Sequence

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from omega_turn_ros.errors import OmegaTurnError, RosArgumentsError
from omega_turn_ros.nodes.pacing import Paced, spin_paced

ENDINGS = {signal.SIGINT, signal.SIGTERM}
SAME = 1.0  # [s] within which a second signal is the first again: a terminal's and launch's own


def init_ros(
    args: Sequence[str] | None, context: Context | None = None, domain_id: int | None = None
) -> None:
    """Start ROS 2 without its signal handlers.

    Args:
        args: command line; None takes `sys.argv`.
        context: to start; None for the default one.
        domain_id: DDS domain; None takes ROS_DOMAIN_ID or 0.

    Raises:
        RosArgumentsError: ROS 2 refuses the arguments, a parameter file or the domain.
    """
    try:
        rclpy.init(
            args=None if args is None else list(args),
            context=context,
            domain_id=domain_id,
            signal_handler_options=SignalHandlerOptions.NO,
        )
    except (rclpy_implementation.RCLError, rclpy_implementation.UnknownROSArgsError) as error:
        places = r', at [^,]+:\d+'  # in the source of rcl
        text = ' '.join(re.sub(places, '', str(error)).split())
        raise RosArgumentsError(text.removeprefix('failed to initialize rcl: ')) from error


def run_node(make_node: Callable[[], Node], args: Sequence[str] | None = None) -> int:
    """Spin one node until it is told to stop.

    Signals wake a thread of their own. So none interrupts a callback half-way, as
    KeyboardInterrupt or the shutdown of rclpy's own handlers would: the callback under way
    finishes, then the node is destroyed. A second signal, later than SAME, ends the process at
    once.

    Args:
        make_node: builds the node; OmegaTurnError means its settings were refused.
        args: command line for rclpy; None takes `sys.argv`.

    Returns:
        Exit code for the shell.
    """
    reader = _signal_socket()
    ended = threading.Event()
    node: Node | None = None
    try:
        init_ros(args)
        executor = SingleThreadedExecutor()
        threading.Thread(
            target=_wait_for_signal, args=(reader, executor, ended), daemon=True
        ).start()
        node = make_node()
        executor.add_node(node)
        gc.freeze()  # collections in mid-turn need not look through what start-up made
        # Not spin_until_future_complete, which adds a callback to its future each round.
        if isinstance(node, Paced) and node.tick_period is not None:
            spin_paced(node, node.tick_period, executor, ended)
        while not ended.is_set():
            executor.spin_once()
    except ExternalShutdownException:
        pass
    except OmegaTurnError as error:
        print(f'error: {error}', file=sys.stderr)
        return 2
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0


def _signal_socket() -> socket.socket:
    """Socket that receives the number of each of ENDINGS."""
    reader, writer = socket.socketpair()
    writer.setblocking(False)
    # Python's own C handler writes there, whichever thread the signal hits.
    signal.set_wakeup_fd(writer.detach())
    for number in ENDINGS:
        signal.signal(number, _do_nothing)
    return reader


def _do_nothing(number: int, frame: object) -> None:
    """Handler that lets the socket do the work."""


def _wait_for_signal(
    reader: socket.socket, executor: SingleThreadedExecutor, ended: threading.Event
) -> None:
    reader.recv(1)
    first = time.monotonic()
    ended.set()
    executor.create_task(_nothing)  # wakes the executor
    while True:
        number = reader.recv(1)[0]
        if time.monotonic() - first > SAME:
            os._exit(128 + number)


def _nothing() -> None:
    """Task that only makes `spin_once` return."""
