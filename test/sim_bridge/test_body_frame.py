"""Orientation of bodies that do not lie level."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from omega_turn_sim_bridge.body_frame import mean_roll, orientation_of, projected_heading

DIRECTIONS = np.array([2.9, 2.1, 3.7, 4.6])  # [rad] seen from above, across the branch cut
WEIGHTS = np.array([0.4, 0.3, 0.2, 0.1])


def lying(*rolls: float) -> np.ndarray:
    """Quaternions of level bodies in DIRECTIONS, rolled about their own axes."""
    return np.array([Rotation.from_euler('ZX', pair).as_quat() for pair in zip(DIRECTIONS, rolls)])


def apart(one: float, other: float) -> float:
    return abs(math.remainder(one - other, math.tau))


@pytest.mark.parametrize('roll', [0.0, 1.0, 0.5 * math.pi, -2.5, math.pi])
def test_heading_is_the_mean_direction_whichever_side_is_up(roll: float) -> None:
    assert apart(projected_heading(lying(*4 * [roll]), WEIGHTS), WEIGHTS @ DIRECTIONS) < 1e-12


@pytest.mark.parametrize('which', range(4))
def test_a_body_on_end_does_not_turn_the_heading(which: int) -> None:
    """Its own direction jumps by half a turn as it passes the vertical."""
    found = []
    for pitch in np.radians([89.99, 90.01]):
        turns = lying(0.0, 0.0, 0.0, 0.0)
        turns[which] = Rotation.from_euler('ZY', (DIRECTIONS[which], pitch)).as_quat()
        found.append(projected_heading(turns, WEIGHTS))
    others = np.arange(4) != which
    assert apart(found[0], found[1]) < 1e-3
    mean = np.average(DIRECTIONS[others], weights=WEIGHTS[others])
    assert apart(found[0], mean) < 1e-3


@pytest.mark.parametrize('roll', [0.0, 0.4, -1.9, 3.0])
def test_roll_of_bodies_that_agree_is_theirs(roll: float) -> None:
    assert mean_roll(lying(*4 * [roll]), WEIGHTS) == pytest.approx(roll)


def test_rolls_to_either_side_cancel() -> None:
    equal = np.full(4, 0.25)
    assert mean_roll(lying(0.5, -0.5, 0.3, -0.3), equal) == pytest.approx(0.0)


def test_orientation_has_the_heading_and_the_roll_it_was_made_of() -> None:
    for heading in (-3.0, 0.0, 1.2):
        for roll in (-2.0, 0.0, 3.0):
            q = np.array([orientation_of(heading, roll)])
            assert apart(projected_heading(q, np.ones(1)), heading) < 1e-12
            assert mean_roll(q, np.ones(1)) == pytest.approx(roll)
