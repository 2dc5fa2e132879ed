"""One ending for every node: exit code 0 on SIGINT and SIGTERM, 2 on bad settings."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from omega_turn_ros.errors import OmegaTurnError


def run_node(make_node: Callable[[], Node], args: Sequence[str] | None = None) -> int:
    """Spin one node until it is told to stop.

    Args:
        make_node: builds the node; OmegaTurnError means its settings were refused.
        args: command line for rclpy; None takes `sys.argv`.

    Returns:
        Exit code for the shell.
    """
    node: Node | None = None
    try:
        rclpy.init(args=None if args is None else list(args))
        node = make_node()
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except OmegaTurnError as error:
        print(f'error: {error}', file=sys.stderr)
        return 2
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0
