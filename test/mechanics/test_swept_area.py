"""Swept area of bodies whose hull is known (Sec. IV.D)."""

from __future__ import annotations

import numpy as np
import pytest

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.swept_area import body_corners, swept_area, swept_area_by_start

CHAIN = PlanarChain([0.5, 0.3, 0.2])  # one body length is 1 m
STRAIGHT = np.zeros(2)


def poses(x: np.ndarray, y: np.ndarray, heading: np.ndarray) -> np.ndarray:
    return np.stack(np.broadcast_arrays(x, y, heading), axis=-1).astype(float)


def test_straight_body_at_rest_covers_its_length_times_its_width() -> None:
    area = swept_area(CHAIN, 0.1, np.zeros((1, 2)), np.zeros((1, 3)))
    assert area == pytest.approx(0.1)


def test_straight_body_moved_sideways_covers_a_rectangle() -> None:
    y = np.linspace(0.0, 0.7, 5)
    path = np.zeros((5, 2))
    assert swept_area(CHAIN, 0.0, path, poses(0.0, y, 0.0)) == pytest.approx(0.7)
    assert swept_area(CHAIN, 0.1, path, poses(0.0, y, 0.0)) == pytest.approx(0.8)


def test_straight_body_turned_about_its_middle_covers_the_circle_of_its_corners() -> None:
    turn = np.linspace(0.0, np.pi, 2000)
    middle = body_corners(CHAIN, 0.0, STRAIGHT[None], np.zeros((1, 3))).reshape(-1, 2)
    offset = 0.5 * (middle[:, 0].max() + middle[:, 0].min())
    about = poses(-offset * np.cos(turn), -offset * np.sin(turn), turn)
    area = swept_area(CHAIN, 0.1, np.zeros((2000, 2)), about)
    assert area == pytest.approx(np.pi / 4.0 * (1.0 + 0.1**2), rel=1e-4)


def test_area_does_not_depend_on_where_and_how_large_the_robot_is() -> None:
    rng = np.random.default_rng(71)
    path, where = rng.uniform(-1.0, 1.0, (20, 2)), rng.normal(size=(20, 3))
    area = swept_area(CHAIN, 0.1, path, where)
    turn = 0.8
    c, s = np.cos(turn), np.sin(turn)
    x, y, heading = where.T
    moved = poses(c * x - s * y + 3.0, s * x + c * y - 1.0, heading + turn)
    assert swept_area(CHAIN, 0.1, path, moved) == pytest.approx(area)
    twice = PlanarChain(2.0 * CHAIN.lengths)
    doubled = poses(2.0 * x, 2.0 * y, heading)
    assert swept_area(twice, 0.2, path, doubled) == pytest.approx(area)


def test_corners_are_those_of_links_of_the_given_length_and_width() -> None:
    rng = np.random.default_rng(72)
    corners = body_corners(CHAIN, 0.1, rng.uniform(-2.0, 2.0, (6, 2)), rng.normal(size=(6, 3)))
    assert corners.shape == (6, 3, 4, 2)
    sides = np.linalg.norm(np.diff(corners, axis=-2, append=corners[..., :1, :]), axis=-1)
    np.testing.assert_allclose(sides[..., [0, 2]], 0.1)
    np.testing.assert_allclose(sides[..., 1], np.broadcast_to(CHAIN.lengths, (6, 3)))
    joint = 0.5 * (corners[:, :-1, 2] + corners[:, :-1, 3])
    np.testing.assert_allclose(joint, 0.5 * (corners[:, 1:, 0] + corners[:, 1:, 1]), atol=1e-12)


def test_area_of_a_cycle_cut_elsewhere_is_that_of_the_motion_cut_there() -> None:
    """Two cycles played through: each start's area is the plain one of its stretch."""
    steps, turn = 24, 0.9
    phase = np.linspace(0.0, 4.0 * np.pi, 2 * steps + 1)
    path = np.stack([np.sin(phase), 0.5 * np.cos(phase)], axis=-1)
    swing = 0.3 * np.sin(phase)
    along = phase / (2.0 * np.pi)
    # A screw about the origin, so that the second cycle is the first one turned.
    where = poses(
        (1.0 + swing) * np.cos(turn * along), (1.0 + swing) * np.sin(turn * along), turn * along
    )
    areas = swept_area_by_start(CHAIN, path[: steps + 1], where[: steps + 1], 6)
    for area, begin in zip(areas, range(0, steps, 4)):
        stretch = slice(begin, begin + steps + 1)
        assert area == pytest.approx(swept_area(CHAIN, 0.0, path[stretch], where[stretch]))
    with pytest.raises(BadInputError, match='starts'):
        swept_area_by_start(CHAIN, path, where, 0)
