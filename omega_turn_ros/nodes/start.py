"""What the executables call: a signal during the heavy imports ends them like any later one."""

from __future__ import annotations

import os
import signal


def end_at_once() -> None:
    """Let SIGINT and SIGTERM end the process with exit code 0, until a node handles them."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: os._exit(0))


def gait_node() -> int:
    """Run the gait node; return the exit code."""
    end_at_once()
    from omega_turn_ros.nodes.gait_node import main

    return main()


def admittance_node() -> int:
    """Run the admittance node; return the exit code."""
    end_at_once()
    from omega_turn_ros.nodes.admittance_node import main

    return main()
