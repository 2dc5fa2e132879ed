"""What going to rest costs in heading, whichever gait it is; without numba, for the nodes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import ConvergenceError
from omega_turn_ros.gaits.gait import Gait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.feet import Feet
from omega_turn_ros.mechanics.posture import unbend_heading
from omega_turn_ros.mechanics.resting_chain import RestingChain
from omega_turn_ros.mechanics.resting_motion import lie_down_heading
from omega_turn_ros.mechanics.shuffle import shuffle_heading
from omega_turn_ros.robot import LeggedRobot, Robot

Array = NDArray[np.float64]


def heading_to_rest(robot: Robot, gait: Gait) -> Callable[[Array], float]:
    """Return what tells the heading change [rad] of leaving a posture of the gait for rest.

    It takes the angles of the joints the gait moves [rad], shape (N,). A robot that would roll
    over has no heading to predict: 0.
    """
    if isinstance(robot, LeggedRobot):
        feet, rest = Feet(robot, 'static'), gait.on(robot).rest
        return lambda posture: shuffle_heading(feet, posture, rest)
    if isinstance(gait, WaveGait):
        planar = PlanarChain.of_robot(robot)
        return lambda yaw: unbend_heading(planar, yaw)
    lifted, played = RestingChain(robot), gait.on(robot)

    def lie_down(posture: Array) -> float:
        try:
            return lie_down_heading(lifted, posture, played.waypoint(posture))
        except ConvergenceError:
            return 0.0

    return lie_down
