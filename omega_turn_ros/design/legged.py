"""The shipped gait of the ten-legged robot, and how a gait with legs is calibrated."""

from __future__ import annotations

import math

import numpy as np

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.calibration import Calibration
from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.mechanics.legged import LeggedMotion
from omega_turn_ros.mechanics.trajectory import straight_path
from omega_turn_ros.robot import LeggedRobot

SCALES = 21
PHASES = 24  # table columns per cycle
STEPS_PER_PHASE = 15  # integration steps between two columns
LARGEST_A_3 = math.radians(20.0)  # the paper's


def walking_gait(n_pairs: int = 5) -> LeggedGait:
    """Return the gait that the studies and the library play.

    A_3 is the paper's largest, the rest is ours: the paper prints no amplitudes. With a duty
    factor of 0.6 the centre of mass stays over the feet of five leg pairs whatever the bend; with
    0.5 it does not.
    """
    return LeggedGait(
        n_pairs,
        theta_leg=math.radians(30.0),
        theta_body=math.radians(20.0),
        theta_lift=math.radians(20.0),
        a_3=LARGEST_A_3,
    )


def calibrate_legged(gait: LeggedGait, robot: LeggedRobot) -> Calibration:
    """Integrate the gait at every scale of A_3, with the loads a level body puts on its feet.

    Args:
        gait: A_3 > 0 must turn counter-clockwise.
        robot: the robot.

    Raises:
        BadInputError: the gait does not fit the robot, or turns clockwise or not at all.
    """
    if gait.n_joints != robot.n_joints:
        raise BadInputError('n_pairs', gait.n_pairs, f'{robot.n_pairs}, those of {robot.name}')
    motion = LeggedMotion(robot, 'static')
    steps = PHASES * STEPS_PER_PHASE
    phases = 2.0 * np.pi * np.arange(steps + 1) / steps
    scales = np.linspace(0.0, 1.0, SCALES)
    heading = np.zeros((SCALES, PHASES + 1))
    bend = np.zeros(SCALES)
    straight = motion.turn(straight_path(np.zeros(robot.n_joints), gait.angles(0.0, 0.0)))
    for k in range(1, SCALES):
        heading[k] = motion.heading_along(gait.angles(phases, scales[k]))[::STEPS_PER_PHASE]
        start = straight_path(np.zeros(robot.n_joints), gait.angles(0.0, scales[k]))
        bend[k] = motion.turn(start) - straight
    peak = float(np.abs(np.diff(gait.angles(phases), axis=0)).max() * steps / (2.0 * np.pi))
    return Calibration(0.0, scales, heading, bend, peak, robot.n_joints)
