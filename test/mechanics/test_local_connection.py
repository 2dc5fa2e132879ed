"""The local connection against definitions written out, and how linear the ground is."""

from __future__ import annotations

import numpy as np
import pytest

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_laws import CoulombFriction, LinearDrag
from omega_turn_ros.mechanics.local_connection import local_connection, shape_directions
from omega_turn_ros.mechanics.quasi_static import QuasiStatic

DRAG_RATIO = 2.0


@pytest.fixture(scope='module')
def plane() -> tuple[np.ndarray, np.ndarray]:
    """Ten shapes of eight joints and random planes through them."""
    rng = np.random.default_rng(41)
    return rng.uniform(-1.0, 1.0, (10, 8)), rng.normal(size=(10, 8, 2))


def drag_connection(chain: PlanarChain, angles: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    """Connection under linear drag for one shape: drag matrices added up point by point."""
    total = np.zeros((3, 3 + jacobian.shape[1]))
    for k in range(chain.link_of_point.size):
        columns = []
        for rate in jacobian.T:
            columns.append(chain.state(angles, rate).velocities[k])
        state = chain.state(angles, np.zeros(len(angles)))
        alpha = state.link_angles[chain.link_of_point[k]]
        x, y = state.points[k]
        axis, side = np.array([np.cos(alpha), np.sin(alpha)]), None
        side = np.array([-axis[1], axis[0]])
        drag = np.outer(axis, axis) + DRAG_RATIO * np.outer(side, side)
        motion = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
        whole = np.concatenate([motion, np.array(columns).T], axis=1)
        total += chain.normal_forces[k] * motion.T @ drag @ whole
    return -np.linalg.solve(total[:, :3], total[:, 3:])


def test_connection_of_linear_drag_is_that_of_drag_matrices(
    chain: PlanarChain, plane: tuple[np.ndarray, np.ndarray]
) -> None:
    found = local_connection(QuasiStatic(chain, LinearDrag(DRAG_RATIO)), *plane)
    for k, (angles, jacobian) in enumerate(zip(*plane)):
        expected = drag_connection(chain, angles, jacobian)
        np.testing.assert_allclose(found.matrix[k], expected, atol=1e-10)
    np.testing.assert_allclose(found.misfit, 0.0, atol=1e-9)


def test_connection_of_friction_is_the_best_of_all_directions(
    chain: PlanarChain, plane: tuple[np.ndarray, np.ndarray]
) -> None:
    """Forty directions by lstsq, shape by shape; what kinks do to four is a few per cent."""
    motion = QuasiStatic(chain)
    found = local_connection(motion, *plane)
    around = np.pi * np.arange(40) / 40
    u = np.stack([np.cos(around), np.sin(around)], axis=-1)
    for k, (angles, jacobian) in enumerate(zip(*plane)):
        xi = motion.body_velocity(angles, u @ jacobian.T)
        expected = np.linalg.lstsq(u, xi, rcond=None)[0].T
        np.testing.assert_allclose(found.matrix[k], expected, atol=0.08 * np.abs(expected).max())
    assert (found.misfit > 0.01).all() and (found.misfit < 0.5).all()


def test_connection_near_one_direction_has_its_velocity_and_the_gradient_of_it(
    chain: PlanarChain, plane: tuple[np.ndarray, np.ndarray]
) -> None:
    motion = QuasiStatic(chain)
    angles, jacobian = plane[0][:4], plane[1][:4]
    slope, h = 0.7, 1e-4
    near = np.array([[1.0, slope - h], [1.0, slope + h]])
    found = local_connection(motion, angles, jacobian, near)
    along = motion.body_velocity(angles, jacobian @ np.array([1.0, slope]))
    np.testing.assert_allclose(found.matrix @ np.array([1.0, slope]), along, atol=1e-5)
    further = motion.body_velocity(angles, jacobian @ np.array([1.0, slope + 1e-2]))
    np.testing.assert_allclose(
        (further - along) / 1e-2, found.matrix[..., 1], rtol=0.05, atol=5e-2
    )


@pytest.mark.parametrize('m', [1, 2, 3, 4])
def test_directions_favour_none(m: int) -> None:
    u = shape_directions(m)
    assert u.shape == ((3**m - 1) // 2, m)
    np.testing.assert_allclose(np.linalg.norm(u, axis=1), 1.0)
    np.testing.assert_allclose(u.T @ u / len(u), np.eye(m) / m, atol=1e-15)
    opposite = np.abs(u[:, None] + u[None]).max(axis=-1)
    assert opposite.min() > 0.1


@pytest.mark.parametrize('m', [1, 3])
def test_connection_takes_any_number_of_shape_variables(chain: PlanarChain, m: int) -> None:
    rng = np.random.default_rng(42)
    angles, jacobian = rng.uniform(-1.0, 1.0, (2, 3, 8)), rng.normal(size=(2, 3, 8, m))
    motion = QuasiStatic(chain, LinearDrag())
    found = local_connection(motion, angles, jacobian)
    rate = rng.normal(size=m)
    expected = motion.body_velocity(angles, jacobian @ rate)
    np.testing.assert_allclose(found.matrix @ rate, expected, atol=1e-10)
    assert found.misfit.shape == (2, 3)


def test_variable_that_moves_nothing_has_no_column(chain: PlanarChain) -> None:
    jacobian = np.zeros((8, 2))
    jacobian[2, 0] = 1.0
    found = local_connection(QuasiStatic(chain, CoulombFriction()), np.full(8, 0.3), jacobian)
    assert np.abs(found.matrix[:, 0]).max() > 0.0
    np.testing.assert_allclose(found.matrix[:, 1], 0.0, atol=1e-9)
    still = local_connection(QuasiStatic(chain), np.full(8, 0.3), np.zeros((8, 2)))
    assert (still.matrix == 0.0).all() and still.misfit == 0.0


def test_arrays_that_do_not_fit_are_refused(chain: PlanarChain) -> None:
    motion = QuasiStatic(chain)
    for jacobian in (np.zeros((7, 2)), np.zeros(8), np.zeros((3, 8, 2))):
        with pytest.raises(BadInputError, match='jacobian'):
            local_connection(motion, np.zeros(8), jacobian)
    with pytest.raises(BadInputError, match='directions'):
        local_connection(motion, np.zeros(8), np.ones((8, 2)), np.ones((1, 2)))
    with pytest.raises(BadInputError, match='m: got 0'):
        shape_directions(0)
