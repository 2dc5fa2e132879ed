"""Calibrate a gait: the heading it gives over amplitude scale and phase, by force balance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.calibration import Calibration
from omega_turn_ros.gaits.gait import PlayedGait
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.mechanics.trajectory import path_through, straight_path
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]

SCALES = 41
PHASES = 24  # table columns per cycle
STEPS_PER_PHASE = 15  # integration steps between two columns
NO_SCALE = 1e-9  # scale 0 with a side: the table's first row is where small turns begin


def calibrate(gait: WaveGait, robot: Robot) -> Calibration:
    """Integrate the gait at every amplitude scale (quasi-static, isotropic Coulomb friction).

    Args:
        gait: scale +1 must turn counter-clockwise.
        robot: whose planar chain is used.

    Raises:
        BadInputError: the gait turns clockwise or not at all.
    """
    motion = QuasiStatic(PlanarChain.of_robot(robot))
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


def calibrate_postures(
    played: PlayedGait,
    n_joints: int,
    heading_along: Callable[[Array], Array],
    start: float,
    steps_per_phase: int = STEPS_PER_PHASE,
) -> Calibration:
    """Integrate any gait at every scale, the mean of it and its mirror image.

    Args:
        played: on the robot; the mean turn at scale +1 must be counter-clockwise.
        n_joints: that it moves.
        heading_along: heading from 0 over a path of postures [rad], (T, n_joints of the robot) to
            (T,).
        start: phase at which cycles begin [rad].
        steps_per_phase: integration steps between two columns of the table.

    Raises:
        BadInputError: the gait turns clockwise or not at all.
    """
    steps = PHASES * steps_per_phase
    phases = start + 2.0 * np.pi * np.arange(steps + 1) / steps
    scales = np.linspace(0.0, 1.0, SCALES)
    heading, bend, peak = np.zeros((SCALES, PHASES + 1)), np.zeros(SCALES), 0.0
    for k, scale in enumerate(scales):
        for side in (1.0, -1.0):
            signed = side * max(float(scale), NO_SCALE)
            path = np.array([played.at(p, signed, (0.0, 0.0)) for p in phases])
            heading[k] += 0.5 * side * heading_along(path)[::steps_per_phase]
            rising = path_through(played.rest, played.waypoint(path[0]), path[0])
            bend[k] += 0.5 * side * heading_along(rising)[-1]
            fastest = float(np.abs(np.diff(path, axis=0)).max())
            peak = max(peak, fastest * steps / (2.0 * np.pi))
    # What it drifts at scale 0 is no turn. It fades with the scale, so that turns begin at 0.
    drift = heading[0, -1] * np.linspace(0.0, 1.0, PHASES + 1)
    heading -= (1.0 - scales)[:, None] * drift
    return Calibration(start, scales, heading, bend, peak, n_joints)


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
    motion = QuasiStatic(PlanarChain.of_robot(robot))
    cycle = gait.angles(np.linspace(0.0, 2.0 * np.pi, 721), robot.n_yaw)
    if motion.turn(cycle) < 0.0:
        gait = gait.mirrored()
    theta_max = min(theta_max, robot.position_limit)
    return LibraryGait(name, description, robot.name, theta_max, gait, calibrate(gait, robot))
