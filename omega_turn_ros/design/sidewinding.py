"""The frequency turn of a robot with yaw and pitch joints: which ratio of spatial frequencies."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from omega_turn_ros.design.calibrate import calibrate_postures
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.sidewinding import Sidewinding
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.resting_chain import RestingChain
from omega_turn_ros.mechanics.resting_motion import lie_down_heading, resting_heading_along
from omega_turn_ros.mechanics.self_collision import self_clearance
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]

RATIOS = (1.0, 2.0)
GRID = 21
STEPS = 120  # of a cycle while searching
RATIO_TOLERANCE = 2e-3
STEPS_PER_PHASE = 8
START_PHASES = 24
START_SCALES = (0.0, 0.5, 1.0)


@dataclass(frozen=True, slots=True)
class SidewindingRecipe:
    """Sidewinding to make ready for a robot.

    Attributes:
        name: of the library file.
        description: one line for people.
        k_h: spatial frequency of the horizontal wave.
        a_h_deg: its amplitude [deg].
        a_v_deg: amplitude of the vertical wave [deg]; it lifts the body by some centimetres.
    """

    name: str = 'sidewinding'
    description: str = 'Frequency turn: sidewinding whose ratio k_v / k_h is modulated'
    k_h: float = 1.0
    a_h_deg: float = 50.0
    a_v_deg: float = 9.0

    def fits(self, robot: Robot) -> bool:
        """Whether the robot has joints for both waves, with range enough."""
        limit = math.degrees(robot.position_limit)
        return {'yaw', 'pitch'} == set(robot.joint_axes) and self.a_h_deg <= limit


@dataclass(frozen=True, slots=True)
class SidewindingDesign:
    """What the search over the ratio came to.

    Attributes:
        gait: turning counter-clockwise at scale +1.
        angle: per cycle at scale +-1, mean of both sides [rad].
        clearance: smallest gap of the body to itself, seen from above [m].
        evaluations: cycles integrated.
    """

    gait: Sidewinding
    angle: float
    clearance: float
    evaluations: int


def design_sidewinding(
    recipe: SidewindingRecipe, robot: Robot
) -> tuple[SidewindingDesign, LibraryGait]:
    """Find the ratio of spatial frequencies that turns most, and calibrate from 1 to there.

    Raises:
        BadInputError: the robot has other joints, or too little range.
        ConvergenceError: a posture did not settle on the ground.
    """
    if not recipe.fits(robot):
        expected = f'yaw and pitch joints that reach {recipe.a_h_deg:g} deg'
        raise BadInputError('robot', robot.name, expected)
    chain = RestingChain(robot)
    gait = Sidewinding(recipe.k_h, math.radians(recipe.a_h_deg), math.radians(recipe.a_v_deg), 1.0)
    turns: dict[float, float] = {}

    def turn(ratio: float) -> float:
        if ratio not in turns:
            turns[ratio] = _turn(chain, replace(gait, turning_ratio=ratio))
        return turns[ratio]

    turning = _turning_ratio(turn)
    if turn(turning) < 0.0:
        gait = replace(gait, a_h=-gait.a_h)
    gait = replace(gait, turning_ratio=turning)
    start = _start_phase(chain, gait)
    played = gait.on(robot)
    calibration = calibrate_postures(
        played,
        robot.n_joints,
        lambda path: resting_heading_along(chain, path),
        start,
        STEPS_PER_PHASE,
    )
    path = played.cycle(2.0 * np.pi * np.arange(STEPS) / STEPS, 1.0)[:, robot.yaw_indices]
    clearance = self_clearance(PlanarChain.of_robot(robot), robot.module_width, path).min()
    design = SidewindingDesign(gait, calibration.largest_angle, float(clearance), len(turns))
    theta_max = max(abs(gait.a_h), gait.a_v)
    entry = LibraryGait(recipe.name, recipe.description, robot.name, theta_max, gait, calibration)
    return design, entry


def _turn(chain: RestingChain, gait: Sidewinding) -> float:
    """Angle per cycle at scale 1, mean of the gait and its mirror image [rad]."""
    played = gait.on(chain.robot)
    phases = 2.0 * np.pi * np.arange(STEPS + 1) / STEPS
    left, right = (
        resting_heading_along(chain, played.cycle(phases, scale))[-1] for scale in (1.0, -1.0)
    )
    return float(0.5 * (left - right))


def _turning_ratio(turn: Callable[[float], float]) -> float:
    """Ratio above 1 that turns most, either way."""
    grid = np.linspace(*RATIOS, GRID)
    turns = np.array([turn(float(ratio)) for ratio in grid])
    best = int(np.abs(turns).argmax())
    sign = math.copysign(1.0, turns[best])
    found = minimize_scalar(
        lambda ratio: -sign * turn(float(ratio)),
        bounds=(grid[max(best - 1, 0)], grid[min(best + 1, GRID - 1)]),
        method='bounded',
        options={'xatol': RATIO_TOLERANCE},
    )
    return float(found.x)


def _start_phase(chain: RestingChain, gait: Sidewinding) -> float:
    """Phase whose postures turn the robot least on the way from rest [rad]."""
    played = gait.on(chain.robot)
    phases = 2.0 * np.pi * np.arange(START_PHASES) / START_PHASES

    def cost(phase: float) -> float:
        postures = [played.at(phase, scale, (0.0, 0.0)) for scale in START_SCALES]
        return sum(lie_down_heading(chain, q, played.waypoint(q)) ** 2 for q in postures)

    return float(min(phases, key=cost))
