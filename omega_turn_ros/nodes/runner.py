"""One ending for every node: exit code 0 on SIGINT and SIGTERM, 2 on bad settings."""

from __future__ import annotations

import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Sequence

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from omega_turn_ros.errors import OmegaTurnError

ENDINGS = {signal.SIGINT, signal.SIGTERM}


def run_node(make_node: Callable[[], Node], args: Sequence[str] | None = None) -> int:
    """Spin one node until it is told to stop.

    Signals wake a thread of their own. So none interrupts a callback half-way, as
    KeyboardInterrupt or the shutdown of rclpy's own handlers would: the callback under way
    finishes, then the node is destroyed. A second signal ends the process at once.

    Args:
        make_node: builds the node; OmegaTurnError means its settings were refused.
        args: command line for rclpy; None takes `sys.argv`.

    Returns:
        Exit code for the shell.
    """
    ended = _future_of_signal()
    node: Node | None = None
    try:
        rclpy.init(
            args=None if args is None else list(args),
            signal_handler_options=SignalHandlerOptions.NO,
        )
        node = make_node()
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin_until_future_complete(ended)
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


def _future_of_signal() -> Future:
    """Future that is done after the first of ENDINGS."""
    ended: Future = Future()
    reader, writer = socket.socketpair()
    writer.setblocking(False)
    # Python's own C handler writes each signal's number here, whichever thread it hits.
    signal.set_wakeup_fd(writer.fileno())
    for number in ENDINGS:
        signal.signal(number, _do_nothing)

    def wait() -> None:
        with reader, writer:
            reader.recv(1)
            ended.set_result(True)
            os._exit(128 + reader.recv(1)[0])

    threading.Thread(target=wait, daemon=True).start()
    return ended


def _do_nothing(number: int, frame: object) -> None:
    """Handler that lets the wake-up socket do the work."""
