"""The body velocity against friction forces added up point by point, and its symmetries."""

from __future__ import annotations

import numpy as np
import pytest
from plain_chain import PlainChain, RandomMotions

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import body_velocity, solve_balance

# Newton stops at 1e-8 of the friction force; the smoothing of |v| over 1e-5 of the mean speed
# takes 5e-5 off the force of a point that slips a thousandth as fast as the mean, the slowest
# counted.
FORCE_TOLERANCE = 1e-4  # of mu times the weight
VELOCITY_TOLERANCE = 1e-5  # of the mean speed of shape change


def reweighted_velocity(plain: PlainChain, rounds: int = 4000) -> np.ndarray:
    """Least dissipation by iteratively reweighted least squares: slow, simple, another method."""
    rows, sides, weights = [], [], []
    for p in plain.points:
        rows += [(1.0, 0.0, -p.y), (0.0, 1.0, p.x)]
        sides += [-p.vx, -p.vy]
        weights.append(p.normal_force)
    rows, sides, weights = np.array(rows), np.array(sides), np.array(weights)
    xi = np.zeros(3)
    for _ in range(rounds):
        slip = (rows @ xi - sides).reshape(-1, 2)
        # the weighted squares of this round have the forces of the last as their gradient
        root = np.repeat(np.sqrt(weights / np.maximum(np.hypot(*slip.T), 1e-12)), 2)
        following = np.linalg.lstsq(root[:, None] * rows, root * sides, rcond=None)[0]
        if np.abs(following - xi).max() < 1e-13:
            break
        xi = following
    return xi


def test_friction_forces_and_torque_cancel(chain: PlanarChain, motions: RandomMotions) -> None:
    """A point that sticks may bear any force up to its normal force; no motion here has two."""
    xi = body_velocity(chain, motions.angles, motions.rates)
    tolerance = FORCE_TOLERANCE * chain.normal_forces.sum()
    sliding_throughout = 0
    for angles, rates, velocity in zip(motions.angles, motions.rates, xi):
        plain = PlainChain(chain, angles, rates)
        forces, points, sticking = plain.forces(velocity), plain.points, plain.sticking(velocity)
        assert len(sticking) <= 1
        for i in sticking:
            forces[i] = (0.0, 0.0)
        held = -np.sum(forces, axis=0)
        for i in sticking:
            forces[i] = tuple(held)
        bearing = sum(points[i].normal_force for i in sticking)
        assert np.hypot(*held) <= bearing + tolerance
        torque = sum(p.x * fy - p.y * fx for p, (fx, fy) in zip(points, forces))
        assert torque == pytest.approx(0.0, abs=tolerance * chain.lengths.sum() / 2)
        sliding_throughout += not sticking
    assert sliding_throughout > 30


def test_velocity_is_that_of_a_slow_independent_method(
    chain: PlanarChain, uneven: PlanarChain, motions: RandomMotions
) -> None:
    for body, count in ((chain, 5), (uneven, 5)):
        n = body.n_joints
        for angles, rates in zip(motions.angles[:count, :n], motions.rates[:count, :n] + 0.1):
            plain = PlainChain(body, angles, rates)
            expected = reweighted_velocity(plain)
            found = body_velocity(body, angles, rates)
            speed = np.mean([np.hypot(p.vx, p.vy) for p in plain.points])
            size = body.lengths.sum() / 2
            error = (found - expected) * np.array([1.0, 1.0, size])
            np.testing.assert_allclose(error, 0.0, atol=10 * VELOCITY_TOLERANCE * speed)


def test_no_other_velocity_dissipates_less(chain: PlanarChain, motions: RandomMotions) -> None:
    """Dissipation is convex, so a minimum among neighbours is the minimum."""
    rng = np.random.default_rng(8)
    for angles, rates in zip(motions.angles[:4], motions.rates[:4]):
        plain = PlainChain(chain, angles, rates)
        xi = body_velocity(chain, angles, rates)
        least = plain.dissipation(xi)
        for reach in (1e-1, 1e-2, 1e-3):
            for _ in range(15):
                other = xi + reach * np.abs(rates).max() * rng.normal(size=3)
                assert plain.dissipation(other) > least * (1.0 - 1e-9)


def test_velocity_does_not_depend_on_the_weight(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    light = PlanarChain(chain.lengths, weight=1e-3)
    np.testing.assert_allclose(
        body_velocity(light, motions.angles, motions.rates),
        body_velocity(chain, motions.angles, motions.rates),
        atol=1e-12,
    )


@pytest.mark.parametrize('factor', [1e-9, 0.3, 7.0, 1e6])
def test_velocity_is_proportional_to_the_rates(
    chain: PlanarChain, motions: RandomMotions, factor: float
) -> None:
    xi = body_velocity(chain, motions.angles, motions.rates)
    scaled = body_velocity(chain, motions.angles, factor * motions.rates)
    np.testing.assert_allclose(scaled / factor, xi, rtol=0, atol=VELOCITY_TOLERANCE)


def test_time_reversal_negates_the_velocity(chain: PlanarChain, motions: RandomMotions) -> None:
    xi = body_velocity(chain, motions.angles, motions.rates)
    back = body_velocity(chain, motions.angles, -motions.rates)
    np.testing.assert_allclose(back, -xi, rtol=0, atol=VELOCITY_TOLERANCE)


def test_mirrored_motion_has_the_mirrored_velocity(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    xi = body_velocity(chain, motions.angles, motions.rates)
    mirrored = body_velocity(chain, -motions.angles, -motions.rates)
    np.testing.assert_allclose(
        mirrored, xi * np.array([1.0, -1.0, -1.0]), rtol=0, atol=VELOCITY_TOLERANCE
    )


def test_swapping_head_and_tail_turns_the_frame_by_half_a_turn(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    """Equal links: read from the tail, joint N + 1 - i turns the other part the other way."""
    assert np.ptp(chain.lengths) == pytest.approx(0.0, abs=1e-15)
    xi = body_velocity(chain, motions.angles, motions.rates)
    swapped = body_velocity(chain, -motions.angles[:, ::-1], -motions.rates[:, ::-1])
    np.testing.assert_allclose(
        swapped, xi * np.array([-1.0, -1.0, 1.0]), rtol=0, atol=VELOCITY_TOLERANCE
    )


def test_folding_two_equal_links_neither_turns_nor_advances_the_body() -> None:
    chain = PlanarChain([0.2, 0.2], points_per_link=4)
    for angle in np.linspace(-2.5, 2.5, 11):
        xi = body_velocity(chain, [angle], [0.7])
        assert xi[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-7)


def test_nothing_moves_nothing_and_leaves_the_others_of_a_batch_alone(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    rates = motions.rates.copy()
    rates[::4] = 0.0
    xi = body_velocity(chain, motions.angles, rates)
    assert (xi[::4] == 0.0).all()
    moving = rates.any(axis=1)
    np.testing.assert_allclose(
        xi[moving],
        body_velocity(chain, motions.angles[moving], rates[moving]),
        rtol=0,
        atol=VELOCITY_TOLERANCE,
    )
    assert (body_velocity(chain, motions.angles, np.zeros(chain.n_joints)) == 0.0).all()


def test_each_shape_of_a_batch_is_solved_as_if_alone(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    together = body_velocity(
        chain, motions.angles.reshape(4, 10, -1), motions.rates.reshape(4, 10, -1)
    )
    assert together.shape == (4, 10, 3)
    for k in (0, 13, 39):
        alone = body_velocity(chain, motions.angles[k], motions.rates[k])
        np.testing.assert_allclose(
            together.reshape(-1, 3)[k], alone, rtol=0, atol=VELOCITY_TOLERANCE
        )


def test_velocity_settles_as_contact_points_are_added(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    angles, rates = motions.angles[:6], motions.rates[:6]
    fine = body_velocity(PlanarChain(chain.lengths, 1.0, 24), angles, rates)
    errors = [
        np.abs(body_velocity(PlanarChain(chain.lengths, 1.0, n), angles, rates) - fine).max()
        for n in (2, 8)
    ]
    assert errors[1] < 0.25 * errors[0]
    assert errors[1] < 0.05 * np.abs(fine).max()


def rigid_motion(points: np.ndarray, centre: np.ndarray, spin: float) -> np.ndarray:
    """Velocities of points that turn about a centre."""
    arm = points - centre
    return spin * np.stack([-arm[:, 1], arm[:, 0]], axis=-1)


@pytest.mark.parametrize('spin', [1.0, -1e-8])
def test_rigid_rotation_about_a_contact_point_is_taken_back_whole(spin: float) -> None:
    rng = np.random.default_rng(9)
    points, weights = rng.normal(size=(12, 2)), rng.uniform(0.5, 1.5, 12)
    motion = rigid_motion(points, points[4], spin)
    xi = solve_balance(points[None], motion[None], weights)[0]
    assert xi[2] == pytest.approx(-spin, rel=1e-6)
    centre = points[4]
    np.testing.assert_allclose(xi[:2], spin * np.array([-centre[1], centre[0]]), rtol=1e-6)


def test_point_that_carries_most_of_the_weight_sticks_and_the_body_pivots_on_it() -> None:
    rng = np.random.default_rng(10)
    points, motion = rng.normal(size=(2, 9, 2))
    weights = np.ones(9)
    weights[3] = 20.0  # more than all the others can pull
    xi = solve_balance(points[None], motion[None], weights)[0]
    slip = motion + xi[:2] + xi[2] * np.stack([-points[:, 1], points[:, 0]], axis=-1)
    speed = np.hypot(*slip.T)
    # Smoothing lets it creep: 8/20 of friction at a speed of eps 8/sqrt(20^2 - 8^2), eps = 1e-5.
    assert speed[3] < 1e-5 * np.mean(np.hypot(*motion.T))
    assert np.delete(speed, 3).min() > 1e-2
    # and the torque about it still balances
    arm = points - points[3]
    unit = np.delete(slip / speed[:, None], 3, axis=0)
    arm = np.delete(arm, 3, axis=0)
    assert (arm[:, 0] @ unit[:, 1] - arm[:, 1] @ unit[:, 0]) == pytest.approx(0.0, abs=1e-4)
