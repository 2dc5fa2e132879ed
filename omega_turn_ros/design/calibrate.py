"""Calibrate a gait: the heading it gives over amplitude scale and phase, by force balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.calibration import Calibration
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.two_wave import TwoWaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.trajectory import heading_along, straight_path
from omega_turn_ros.robot import Robot

SCALES = 41
PHASES = 24  # table columns per cycle
STEPS_PER_PHASE = 15  # integration steps between two columns
POINTS_PER_LINK = 8


def calibrate(gait: TwoWaveGait, robot: Robot) -> Calibration:
    """Integrate the gait at every amplitude scale (quasi-static, isotropic Coulomb friction).

    Args:
        gait: scale +1 must turn counter-clockwise.
        robot: whose planar chain is used.

    Raises:
        BadInputError: the gait turns clockwise or not at all.
    """
    chain = PlanarChain.of_robot(robot, POINTS_PER_LINK)
    start = straightest_phase(gait, robot.n_yaw)
    steps = PHASES * STEPS_PER_PHASE
    path = gait.angles(start + 2.0 * np.pi * np.arange(steps + 1) / steps, robot.n_yaw)
    scales = np.linspace(0.0, 1.0, SCALES)
    heading = np.zeros((SCALES, PHASES + 1))
    bend = np.zeros(SCALES)
    for k in range(1, SCALES):
        heading[k] = heading_along(chain, scales[k] * path)[::STEPS_PER_PHASE]
        bend[k] = heading_along(chain, straight_path(0.0 * path[0], scales[k] * path[0]))[-1]
    peak = float(np.abs(np.diff(path, axis=0)).max() * steps / (2.0 * np.pi))
    return Calibration(start, scales, heading, bend, peak, robot.n_yaw)


def straightest_phase(gait: TwoWaveGait, n_joints: int) -> float:
    """Phase at which the largest joint angle of the cycle is smallest [rad]."""
    samples = 2880
    largest = np.abs(gait.sampled(n_joints, samples)).max(axis=1)
    return float(2.0 * np.pi * largest.argmin() / samples)


def fit_to_limit(gait: TwoWaveGait, n_joints: int, theta_max: float) -> TwoWaveGait:
    """Scale both amplitudes so that the largest joint angle of the cycle is exactly theta_max."""
    factor = theta_max / np.abs(gait.sampled(n_joints, 2880)).max()
    return replace(gait, a_f=float(gait.a_f * factor), a_o=float(gait.a_o * factor))


def make_library_gait(
    name: str, description: str, gait: TwoWaveGait, robot: Robot, theta_max: float
) -> LibraryGait:
    """Fit a gait to its joint limit, make it turn counter-clockwise, and calibrate it.

    Raises:
        BadInputError: the limit exceeds the robot's, or the gait does not turn.
    """
    if theta_max > robot.position_limit + 1e-9:
        raise BadInputError('theta_max', theta_max, f'at most {robot.position_limit} [rad]')
    fitted = fit_to_limit(gait, robot.n_yaw, theta_max)
    chain = PlanarChain.of_robot(robot, POINTS_PER_LINK)
    path = fitted.angles(np.linspace(0.0, 2.0 * np.pi, 361), robot.n_yaw)
    if heading_along(chain, path)[-1] < 0.0:
        fitted = fitted.mirrored()
    return LibraryGait(name, description, robot.name, theta_max, fitted, calibrate(fitted, robot))
