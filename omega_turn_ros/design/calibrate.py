"""Calibrate a gait: the heading it gives over amplitude scale and phase, by force balance."""

from __future__ import annotations

import numpy as np

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.calibration import Calibration
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.mechanics.trajectory import straight_path
from omega_turn_ros.robot import Robot

SCALES = 41
PHASES = 24  # table columns per cycle
STEPS_PER_PHASE = 15  # integration steps between two columns
POINTS_PER_LINK = 8


def calibrate(gait: WaveGait, robot: Robot) -> Calibration:
    """Integrate the gait at every amplitude scale (quasi-static, isotropic Coulomb friction).

    Args:
        gait: scale +1 must turn counter-clockwise.
        robot: whose planar chain is used.

    Raises:
        BadInputError: the gait turns clockwise or not at all.
    """
    motion = QuasiStatic(PlanarChain.of_robot(robot, POINTS_PER_LINK))
    start = straightest_phase(gait, robot.n_yaw)
    steps = PHASES * STEPS_PER_PHASE
    path = gait.angles(start + 2.0 * np.pi * np.arange(steps + 1) / steps, robot.n_yaw)
    bending = straight_path(0.0 * path[0], path[0])
    scales = np.linspace(0.0, 1.0, SCALES)
    heading = np.zeros((SCALES, PHASES + 1))
    bend = np.zeros(SCALES)
    for k in range(1, SCALES):
        heading[k] = motion.heading_along(scales[k] * path)[::STEPS_PER_PHASE]
        bend[k] = motion.turn(scales[k] * bending)
    peak = float(np.abs(np.diff(path, axis=0)).max() * steps / (2.0 * np.pi))
    return Calibration(start, scales, heading, bend, peak, robot.n_yaw)


def straightest_phase(gait: WaveGait, n_joints: int) -> float:
    """Phase at which the largest joint angle of the cycle is smallest [rad]."""
    samples = 2880
    largest = np.abs(gait.sampled(n_joints, samples)).max(axis=1)
    return float(2.0 * np.pi * largest.argmin() / samples)


def make_library_gait(name: str, description: str, gait: WaveGait, robot: Robot) -> LibraryGait:
    """Calibrate a gait that keeps its limits, and make it turn counter-clockwise.

    Raises:
        BadInputError: it bends a joint beyond the robot's limit, or does not turn.
    """
    theta_max = float(np.abs(gait.sampled(robot.n_yaw, 20_000)).max())
    if theta_max > robot.position_limit + 1e-6:
        expected = f'at most {robot.position_limit} [rad], the limit of {robot.name}'
        raise BadInputError('largest joint angle', theta_max, expected)
    motion = QuasiStatic(PlanarChain.of_robot(robot, POINTS_PER_LINK))
    cycle = gait.angles(np.linspace(0.0, 2.0 * np.pi, 721), robot.n_yaw)
    if motion.turn(cycle) < 0.0:
        gait = gait.mirrored()
    theta_max = min(theta_max, robot.position_limit)
    return LibraryGait(name, description, robot.name, theta_max, gait, calibrate(gait, robot))
