"""The compiled force balance against scipy, against numpy, and against itself."""

from __future__ import annotations

import numpy as np
import pytest
from plain_chain import RandomMotions
from slow_reference import SlowReference

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import body_velocity
from omega_turn_ros.mechanics.force_laws import (
    CoulombFriction,
    ForceLaw,
    GranularResistance,
    LinearDrag,
)
from omega_turn_ros.mechanics.quasi_static import QuasiStatic

ACCURACY = 1e-6  # of the body velocity, relative
LAWS = [
    LinearDrag(3.0),
    CoulombFriction(),
    CoulombFriction(2.5),
    GranularResistance(),
    GranularResistance.close_packed(),
    GranularResistance.of_ratio(1.4),
]


def relative_error(chain: PlanarChain, found: np.ndarray, expected: np.ndarray) -> float:
    """Largest part of the difference over the size of the velocity, in units of the body."""
    size = np.array([1.0, 1.0, 0.5 * chain.lengths.sum()])
    return float(np.abs((found - expected) * size).max() / np.linalg.norm(expected * size))


def residual(chain: PlanarChain, law: ForceLaw, angles, rates, xi) -> np.ndarray:
    """Ground force and torque per weight and half body length, by numpy, shape (3,)."""
    state = chain.state(angles, rates)
    slip = (
        state.velocities
        + xi[:2]
        + xi[2] * np.stack([-state.points[:, 1], state.points[:, 0]], axis=-1)
    )
    alpha = state.link_angles[chain.link_of_point]
    c, s = np.cos(alpha), np.sin(alpha)
    along, across = law.force(c * slip[:, 0] + s * slip[:, 1], c * slip[:, 1] - s * slip[:, 0])
    force = np.stack([c * along - s * across, s * along + c * across], axis=-1)
    force *= (chain.normal_forces / chain.normal_forces.sum())[:, None]
    x, y = state.points.T
    torque = (x * force[:, 1] - y * force[:, 0]).sum() / (0.5 * chain.lengths.sum())
    return np.array([*force.sum(axis=0), torque])


def slowest_slip(chain: PlanarChain, angles, rates, xi) -> float:
    """Slip of the slowest point over the mean speed of shape change."""
    state = chain.state(angles, rates)
    turn = xi[2] * np.stack([-state.points[:, 1], state.points[:, 0]], axis=-1)
    slip = np.linalg.norm(state.velocities + xi[:2] + turn, axis=1)
    return float(slip.min() / np.linalg.norm(state.velocities, axis=1).mean())


@pytest.mark.parametrize('ratio', [1.0, 2.5])
def test_velocity_is_that_of_scipy_for_random_shapes(
    chain: PlanarChain, uneven: PlanarChain, ratio: float
) -> None:
    """Some of these stick: the point the body pivots on is found as well."""
    rng = np.random.default_rng(31)
    pivots = 0
    for body, count in ((chain, 12), (uneven, 12), (PlanarChain(chain.lengths, 1.0, 12), 3)):
        motion = QuasiStatic(body, CoulombFriction(ratio))
        for _ in range(count):
            angles = rng.uniform(-1.3, 1.3, body.n_joints)
            rates = rng.normal(size=body.n_joints)
            expected, pivot = SlowReference(body, angles, rates, ratio).solve()
            error = relative_error(body, motion.body_velocity(angles, rates), expected)
            assert error < ACCURACY, (angles, rates, pivot)
            pivots += pivot >= 0
    assert pivots >= 4


@pytest.mark.parametrize('size', [1e-12, 1e-6, 1e6])
def test_velocity_of_nearly_no_motion_is_as_accurate(chain: PlanarChain, size: float) -> None:
    rng = np.random.default_rng(32)
    motion = QuasiStatic(chain)
    for _ in range(5):
        angles, rates = rng.uniform(-1.0, 1.0, 8), size * rng.normal(size=8)
        expected, _ = SlowReference(chain, angles, rates).solve()
        assert relative_error(chain, motion.body_velocity(angles, rates), expected) < ACCURACY


def test_body_pivots_on_a_link_that_bears_most_of_the_weight() -> None:
    loads = np.ones(9)
    loads[3] = 40.0
    chain = PlanarChain(np.full(9, 0.14), points_per_link=1, loads=loads)
    rng = np.random.default_rng(33)
    motion = QuasiStatic(chain)
    for _ in range(10):
        angles, rates = rng.uniform(-1.0, 1.0, 8), rng.normal(size=8)
        expected, pivot = SlowReference(chain, angles, rates).solve()
        assert pivot == 3
        xi = motion.body_velocity(angles, rates)
        assert relative_error(chain, xi, expected) < ACCURACY
        assert slowest_slip(chain, angles, rates, xi) < ACCURACY


def test_straight_body_is_no_special_case(chain: PlanarChain) -> None:
    rng = np.random.default_rng(34)
    straight = np.zeros(8)
    for law in (CoulombFriction(), CoulombFriction(2.5)):
        motion = QuasiStatic(chain, law)
        for rates in (*np.eye(8)[::3], *rng.normal(size=(2, 8))):
            expected, _ = SlowReference(chain, straight, rates, law.ratio).solve()
            xi = motion.body_velocity(straight, rates)
            assert relative_error(chain, xi, expected) < ACCURACY
            assert xi[0] == pytest.approx(0.0, abs=1e-9)


def test_velocity_is_that_of_the_numpy_balance(chain: PlanarChain, motions: RandomMotions) -> None:
    np.testing.assert_allclose(
        QuasiStatic(chain).body_velocity(motions.angles, motions.rates),
        body_velocity(chain, motions.angles, motions.rates),
        rtol=0,
        atol=1e-5,  # the accuracy of the numpy balance
    )


@pytest.mark.parametrize('law', LAWS, ids=repr)
def test_forces_of_the_law_cancel(chain: PlanarChain, law: ForceLaw) -> None:
    """Where a point sticks its force is any within a range; elsewhere the sum must vanish."""
    rng = np.random.default_rng(35)
    motion = QuasiStatic(chain, law)
    slipping = 0
    for _ in range(60):
        angles, rates = rng.uniform(-1.0, 1.0, 8), rng.normal(size=8)
        xi = motion.body_velocity(angles, rates)
        if law.kind != 0 and slowest_slip(chain, angles, rates, xi) < 1e-4:
            continue
        slipping += 1
        np.testing.assert_allclose(residual(chain, law, angles, rates, xi), 0.0, atol=1e-7)
    assert slipping > 20


@pytest.mark.parametrize('ratio', [1.0, 1.5, 4.0, 8.0])
def test_drag_times_slip_is_the_force_of_the_grains(ratio: float) -> None:
    law = GranularResistance.of_ratio(ratio)
    bearing = np.linspace(-np.pi, np.pi, 181)
    slip = np.cos(bearing), np.sin(bearing)
    for drag, component, force in zip(law.drag(*slip), slip, law.force(*slip)):
        assert (drag > 0.0).all()
        np.testing.assert_allclose(-drag * component, force, atol=1e-12)


@pytest.mark.parametrize('law', LAWS, ids=repr)
def test_velocity_does_not_depend_on_the_shapes_solved_before(
    chain: PlanarChain, motions: RandomMotions, law: ForceLaw
) -> None:
    motion = QuasiStatic(chain, law)
    together = motion.body_velocity(motions.angles, motions.rates)
    alone = [motion.body_velocity(q, dq) for q, dq in zip(motions.angles, motions.rates)]
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-7)


@pytest.mark.parametrize('law', LAWS, ids=repr)
def test_velocity_is_odd_in_the_rates(
    chain: PlanarChain, motions: RandomMotions, law: ForceLaw
) -> None:
    motion = QuasiStatic(chain, law)
    there = motion.body_velocity(motions.angles, motions.rates)
    back = motion.body_velocity(motions.angles, -motions.rates)
    np.testing.assert_allclose(back, -there, rtol=0, atol=1e-7)


def test_displacement_does_not_depend_on_the_width_of_a_line(chain: PlanarChain) -> None:
    """Points across a vanishing width carry what one point carried."""
    rng = np.random.default_rng(36)
    angles, rates = rng.uniform(-1.0, 1.0, (5, 8)), rng.normal(size=(5, 8))
    thin = PlanarChain(chain.lengths, width=1e-9, points_across=3)
    np.testing.assert_allclose(
        QuasiStatic(thin).body_velocity(angles, rates),
        QuasiStatic(chain).body_velocity(angles, rates),
        rtol=0,
        atol=1e-6,
    )


@pytest.mark.parametrize(
    ('angles', 'rates', 'field'),
    [
        (np.zeros(7), np.zeros(8), 'angles'),
        (np.zeros(8), np.zeros((3, 9)), 'rates'),
        (np.full(8, np.nan), np.zeros(8), 'angles'),
        (np.zeros(8), np.full(8, np.inf), 'rates'),
        (0.0, np.zeros(8), 'angles'),
    ],
)
def test_unusable_shapes_are_refused(chain: PlanarChain, angles, rates, field: str) -> None:
    with pytest.raises(BadInputError) as caught:
        QuasiStatic(chain).body_velocity(angles, rates)
    assert caught.value.field == field


@pytest.mark.parametrize('law', LAWS, ids=repr)
def test_every_one_of_many_unrelated_shapes_is_solved(chain: PlanarChain, law: ForceLaw) -> None:
    """No guess helps here, and a point sticks in every third."""
    rng = np.random.default_rng(37)
    angles, rates = rng.uniform(-1.5, 1.5, (20_000, 8)), rng.normal(size=(20_000, 8))
    assert np.isfinite(QuasiStatic(chain, law).body_velocity(angles, rates)).all()


def test_most_of_a_straight_body_stays_while_its_head_link_turns(chain: PlanarChain) -> None:
    """Several points stick at once, or nearly."""
    straight, head = np.zeros(8), np.eye(8)[0]
    xi = QuasiStatic(chain).body_velocity(straight, 1e-3 * head)
    state = chain.state(straight, 1e-3 * head)
    turn = xi[2] * np.stack([-state.points[:, 1], state.points[:, 0]], axis=-1)
    slip = np.linalg.norm(state.velocities + xi[:2] + turn, axis=1)
    assert slip[:4].min() > 0.0
    assert slip[12:].max() < 0.05 * slip.max()
