"""PyBullet's physics clients, with a window or without."""

from __future__ import annotations

import os
import sys

from omega_turn_ros.errors import SimulationError
from omega_turn_sim_bridge.engine import pybullet

VIEW_DISTANCE, VIEW_PITCH = 1.5, -60.0  # [body lengths], [deg]: all of a turn, seen from above


def open_client(gui: bool, body_length: float) -> int:
    """Open a physics client; close it with `pybullet.disconnect`.

    Args:
        gui: show a window, which looks down on the robot.
        body_length: of the robot [m].

    Returns:
        PyBullet's id of the client.

    Raises:
        SimulationError: PyBullet has no client to give, or DISPLAY is not set. Where it names a
            display that is not there, PyBullet itself ends the process, with a line that says so.
    """
    if gui and sys.platform == 'linux' and not os.environ.get('DISPLAY'):
        raise SimulationError('a window needs a display: DISPLAY is not set')
    client: int = pybullet.connect(pybullet.GUI if gui else pybullet.DIRECT)
    if client < 0:
        raise SimulationError('PyBullet gave no physics client')
    if gui:
        # The panels beside the scene are for PyBullet's own demos.
        pybullet.configureDebugVisualizer(pybullet.COV_ENABLE_GUI, 0, physicsClientId=client)
        pybullet.resetDebugVisualizerCamera(
            VIEW_DISTANCE * body_length, 0.0, VIEW_PITCH, (0.0, 0.0, 0.0), physicsClientId=client
        )
    return client
