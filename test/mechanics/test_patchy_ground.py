"""Turning where the ground bears in patches only."""

from __future__ import annotations

import numpy as np
import pytest

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.patchy_ground import PatchyGround, headings_on_patches
from omega_turn_ros.mechanics.trajectory import heading_along, pose_along
from omega_turn_ros.robot import load_robot

ROBOT = load_robot('limbless16')
CHAIN = PlanarChain.of_robot(ROBOT)
SPACING = 0.3 * ROBOT.length


@pytest.fixture(scope='module')
def path() -> np.ndarray:
    gait = load_gait('omega')
    phases = gait.calibration.start_phase + np.linspace(0.0, 2.0 * np.pi, 121)
    return gait.gait.angles(phases, ROBOT.n_yaw)


def test_ground_that_bears_everywhere_is_level_ground(path: np.ndarray) -> None:
    headings = headings_on_patches(CHAIN, path, PatchyGround(1.0, SPACING, 2, 0))
    expected = heading_along(CHAIN, path)
    np.testing.assert_allclose(headings, np.stack([expected, expected], axis=-1), atol=1e-9)


@pytest.mark.parametrize('bearing', [0.1, 0.3, 0.7])
def test_the_share_that_bears_is_as_asked(bearing: float) -> None:
    ground = PatchyGround(bearing, SPACING, 50, 1)
    points = np.random.default_rng(2).uniform(-5.0, 5.0, (50, 2000, 2))
    assert ground.bears(points).mean() == pytest.approx(bearing, abs=0.02)


def test_patches_are_about_the_spacing_apart() -> None:
    """Along a line, a field of one wave length in all directions falls to its least half-way."""
    ground = PatchyGround(0.5, SPACING, 400, 3)
    shifts = np.linspace(0.0, 1.2, 25) * SPACING
    points = np.stack([shifts, np.zeros_like(shifts)], axis=-1)
    bears = ground.bears(np.broadcast_to(points, (400, *points.shape)))
    agree = (bears == bears[:, :1]).mean(axis=0)
    assert 0.4 * SPACING < shifts[agree.argmin()] < 0.8 * SPACING


def test_a_load_that_shifts_is_that_of_a_chain_with_those_loads(path: np.ndarray) -> None:
    """One step, against a chain that carries its weight only where the patches are."""
    ground = PatchyGround(0.3, SPACING, 1, 5)
    two = path[60:62]
    state = CHAIN.state(two.mean(axis=0), two[1] - two[0])
    bears = ground.bears(state.points[None])[0]
    assert 0 < bears.sum() < bears.size
    patched = PlanarChain.of_robot(ROBOT)
    patched.normal_forces = patched.normal_forces * np.where(bears, 1.0, 1e-3)
    expected = pose_along(patched, two)[-1, 2]
    assert headings_on_patches(CHAIN, two, ground)[-1, 0] == pytest.approx(expected, abs=1e-9)


def test_grounds_differ_and_follow_the_seed(path: np.ndarray) -> None:
    one, again, other = (
        headings_on_patches(CHAIN, path[:20], PatchyGround(0.3, SPACING, 3, seed))
        for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(one, again)
    assert not np.allclose(one, other)
    assert np.ptp(one[-1]) > 1e-4


@pytest.mark.parametrize(
    ('field', 'values'),
    [
        ('bearing', (0.0, 1.0, 1)),
        ('bearing', (1.1, 1.0, 1)),
        ('spacing', (0.5, 0.0, 1)),
        ('count', (0.5, 1.0, 0)),
    ],
)
def test_impossible_ground_is_refused_by_name(
    field: str, values: tuple[float, float, int]
) -> None:
    with pytest.raises(BadInputError, match=f'^{field}: got'):
        PatchyGround(*values, seed=0)
