"""What the executable calls: a signal during the heavy imports ends it like any later one."""

from __future__ import annotations

from omega_turn_ros.nodes.start import end_at_once


def pybullet_bridge() -> int:
    """Run the bridge; return the exit code."""
    end_at_once()
    from omega_turn_sim_bridge.bridge_node import main

    return main()
