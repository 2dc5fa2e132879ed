"""The shipped frequency turn is the one its search would choose, and turns as its table says."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from omega_turn_ros.design.catalogue import CATALOGUE, SIDEWINDING, recipes_for
from omega_turn_ros.design.rest import heading_to_rest
from omega_turn_ros.design.sidewinding import design_sidewinding
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.sidewinding import Sidewinding
from omega_turn_ros.mechanics.resting_chain import RestingChain
from omega_turn_ros.mechanics.resting_motion import resting_heading_along
from omega_turn_ros.robot import Robot, load_robot

ENTRY = load_gait('sidewinding')
ROBOT = load_robot('limbless16')
CHAIN = RestingChain(ROBOT)
ONE_DEGREE = math.radians(1.0)


def turn(gait: Sidewinding, scale: float, steps: int = 150) -> float:
    """Angle of a cycle, mean of the gait and its mirror image [rad]."""
    phases = ENTRY.calibration.start_phase + np.linspace(0.0, 2.0 * np.pi, steps + 1)
    played = gait.on(ROBOT)
    left, right = (
        resting_heading_along(CHAIN, played.cycle(phases, s))[-1] for s in (scale, -scale)
    )
    return 0.5 * (left - right)


@pytest.mark.parametrize('scale', [0.33, 0.61, 0.9, 1.0])
def test_predicted_angle_is_the_integrated_one_less_what_straight_sidewinding_drifts(
    scale: float,
) -> None:
    drift = turn(ENTRY.gait, 1e-9)
    assert abs(drift) < 2.0 * ONE_DEGREE
    expected = turn(ENTRY.gait, scale) - (1.0 - scale) * drift
    assert ENTRY.calibration.angle_of(scale) == pytest.approx(expected, abs=ONE_DEGREE)


def test_no_other_ratio_turns_further() -> None:
    best = turn(ENTRY.gait, 1.0)
    for ratio in (1.1, 1.3, 1.4, 1.46, 1.6, 1.9):
        assert turn(replace(ENTRY.gait, turning_ratio=ratio), 1.0) < best


def test_leaving_the_start_posture_costs_what_reaching_it_gave() -> None:
    table, to_rest = ENTRY.calibration, heading_to_rest(ROBOT, ENTRY.gait)
    for scale in (0.2, 1.0):
        left, right = (
            to_rest(ENTRY.gait.on(ROBOT).at(table.start_phase, s, (0.0, 0.0)))
            for s in (scale, -scale)
        )
        assert 0.5 * (right - left) == pytest.approx(table.bend_heading_of(scale), abs=1e-3)


def robot_with(**changes: object) -> Robot:
    return replace(ROBOT, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    'robot',
    [robot_with(joint_axes=('yaw',) * 16), robot_with(position_limit=math.radians(45.0))],
    ids=['no pitch joints', 'little range'],
)
def test_a_robot_that_cannot_sidewind_has_the_other_gaits(robot: Robot) -> None:
    names = [recipe.name for recipe in recipes_for(robot)]
    assert names == [recipe.name for recipe in CATALOGUE]
    with pytest.raises(BadInputError, match=r'^robot: .*yaw and pitch'):
        design_sidewinding(SIDEWINDING, robot)
