"""The shipped gait of the ten-legged robot, and how a gait with legs is calibrated."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from omega_turn_ros.design.calibrate import SCALES, calibrate_postures
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.mechanics.legged import LeggedMotion
from omega_turn_ros.robot import LeggedRobot

SAMPLES = 720  # postures of a cycle
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


@dataclass(frozen=True, slots=True)
class LeggedRecipe:
    """Walking to make ready for a robot with legs.

    Attributes:
        name: of the library file.
        description: one line for people.
    """

    name: str = 'legged'
    description: str = 'Walking on legs that turns with a bend of the body, A_3 = 20 deg'


@dataclass(frozen=True, slots=True)
class LeggedDesign:
    """What was made ready.

    Attributes:
        gait: turning counter-clockwise at scale +1.
        angle: per cycle at scale +-1, mean of both sides [rad].
        clearance: smallest distance between neighbouring feet of a side [m].
        evaluations: cycles integrated.
    """

    gait: LeggedGait
    angle: float
    clearance: float
    evaluations: int


def design_legged(recipe: LeggedRecipe, robot: LeggedRobot) -> tuple[LeggedDesign, LibraryGait]:
    """Calibrate the walking gait on A_3, with the loads that a level body puts on its feet.

    Raises:
        BadInputError: the robot bends too little, or would turn clockwise.
    """
    gait = walking_gait(robot.n_pairs)
    path = gait.angles(np.linspace(0.0, 2.0 * np.pi, SAMPLES + 1))
    theta_max = float(np.abs(path).max())
    if theta_max > robot.position_limit:
        raise BadInputError('robot', robot.name, f'joints that reach {theta_max:.3g} rad')
    motion = LeggedMotion(robot, 'static')
    calibration = calibrate_postures(gait.on(robot), robot.n_joints, motion.heading_along, 0.0)
    feet = motion.feet.places(path).reshape(-1, robot.n_pairs, 2, 2)
    clearance = float(np.linalg.norm(np.diff(feet, axis=1), axis=-1).min())
    design = LeggedDesign(gait, calibration.largest_angle, clearance, 2 * SCALES)
    straight = gait.angles(np.linspace(0.0, 2.0 * np.pi, SAMPLES + 1), 0.0)
    advance = float(motion.pose_along(straight)[-1, 0])
    about = (recipe.name, recipe.description, robot.name)
    entry = LibraryGait(*about, theta_max, gait, calibration, advance)
    return design, entry
