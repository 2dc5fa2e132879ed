"""Clearance of real rectangles against points sampled in them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.self_collision import self_clearance
from omega_turn_ros.mechanics.swept_area import body_corners

WIDTH = 0.05
SPACING = 0.004  # of the sampled points [m]


def rectangles(chain: PlanarChain, angles: np.ndarray) -> np.ndarray:
    """Corners of each link, shape (L, 4, 2)."""
    return body_corners(chain, WIDTH, angles[None], np.zeros((1, 3)))[0]


def sampled(corners: np.ndarray) -> np.ndarray:
    """Points all over a rectangle, edges included, shape (M, 2)."""
    along, across = corners[3] - corners[0], corners[1] - corners[0]
    steps = [np.linspace(0.0, 1.0, int(np.linalg.norm(v) / SPACING) + 2) for v in (along, across)]
    a, b = np.meshgrid(*steps)
    return corners[0] + a.ravel()[:, None] * along + b.ravel()[:, None] * across


def depth_inside(points: np.ndarray, corners: np.ndarray) -> float:
    """How deep the deepest point lies in a rectangle, negative if all are outside."""
    centre = corners.mean(axis=0)
    gaps = []
    for side in (corners[3] - corners[0], corners[1] - corners[0]):
        length = np.linalg.norm(side)
        gaps.append(0.5 * length - np.abs((points - centre) @ side) / length)
    return float(np.min(gaps, axis=0).max())


def distance(a: np.ndarray, b: np.ndarray) -> float:
    return float(cKDTree(a).query(b)[0].min())


def test_clearance_has_the_sign_and_bounds_the_distance_of_sampled_bodies() -> None:
    rng = np.random.default_rng(61)
    chain = PlanarChain([0.14, 0.1, 0.14, 0.12, 0.14])
    met = clear = 0
    for angles in rng.uniform(-2.4, 2.4, (60, 4)):
        gap = float(self_clearance(chain, WIDTH, angles))
        boxes = rectangles(chain, angles)
        pairs = [(i, j) for i in range(5) for j in range(i + 2, 5)]
        points = [sampled(box) for box in boxes]
        deepest = max(
            max(depth_inside(points[i], boxes[j]), depth_inside(points[j], boxes[i]))
            for i, j in pairs
        )
        if gap > SPACING:
            assert deepest < 0.0
            # points are at most a spacing from the true closest ones
            assert gap <= min(distance(points[i], points[j]) for i, j in pairs) + 1e-12
            clear += 1
        elif gap < -SPACING:
            assert deepest > 0.0
            met += 1
    assert met > 10 and clear > 10


def test_facing_links_are_their_distance_less_their_width_apart() -> None:
    """A U of three links: the legs are parallel, the bottom keeps them apart."""
    chain = PlanarChain([0.3, 0.2, 0.3])
    quarter = 0.5 * np.pi
    assert self_clearance(chain, WIDTH, [quarter, quarter]) == pytest.approx(0.2 - WIDTH)


def test_straight_bodies_are_clear_and_two_links_always_are() -> None:
    chain = PlanarChain([0.14] * 9)
    assert self_clearance(chain, WIDTH, np.zeros(8)) == pytest.approx(0.14)
    assert self_clearance(PlanarChain([0.1, 0.1]), WIDTH, [3.0]) == np.inf


def test_every_shape_of_a_batch_is_judged_alone() -> None:
    rng = np.random.default_rng(62)
    chain = PlanarChain([0.14] * 9)
    angles = rng.uniform(-1.5, 1.5, (4, 5, 8))
    together = self_clearance(chain, WIDTH, angles)
    assert together.shape == (4, 5)
    alone = [[float(self_clearance(chain, WIDTH, q)) for q in row] for row in angles]
    np.testing.assert_array_equal(together, alone)


def test_mirrored_bodies_are_as_clear() -> None:
    rng = np.random.default_rng(63)
    chain = PlanarChain([0.14] * 9)
    angles = rng.uniform(-1.5, 1.5, (50, 8))
    np.testing.assert_allclose(
        self_clearance(chain, WIDTH, angles), self_clearance(chain, WIDTH, -angles), atol=1e-12
    )


@pytest.mark.parametrize('width', [0.0, -1.0, np.nan, np.inf])
def test_width_that_is_no_width_is_refused(width: float) -> None:
    with pytest.raises(BadInputError, match='width'):
        self_clearance(PlanarChain([0.1] * 3), width, np.zeros(2))


def test_wrong_number_of_joints_is_refused() -> None:
    with pytest.raises(BadInputError, match='angles'):
        self_clearance(PlanarChain([0.1] * 3), WIDTH, np.zeros(3))
