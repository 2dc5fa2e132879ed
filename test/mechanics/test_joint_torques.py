"""Actuator torques against work, moments and signs."""

from __future__ import annotations

import numpy as np
import pytest
from plain_chain import PlainChain, RandomMotions

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import body_velocity, joint_torques
from omega_turn_ros.mechanics.force_laws import (
    CoulombFriction,
    ForceLaw,
    GranularResistance,
    LinearDrag,
)
from omega_turn_ros.mechanics.quasi_static import QuasiStatic

MU = 0.5
# Friction is smoothed over 1e-5 of the mean slip, which takes about that share of the work.
WORK_TOLERANCE = 2e-5
TOLERANCE = 1e-4  # of friction force times body length, see test_force_balance.py


def test_actuators_do_exactly_the_work_that_friction_eats(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    torques = joint_torques(chain, motions.angles, motions.rates, MU)
    xi = body_velocity(chain, motions.angles, motions.rates)
    for angles, rates, torque, velocity in zip(motions.angles, motions.rates, torques, xi):
        dissipated = MU * PlainChain(chain, angles, rates).dissipation(velocity)
        assert torque @ rates == pytest.approx(dissipated, rel=WORK_TOLERANCE)


def test_one_joint_does_all_the_work_when_the_rest_of_the_body_sticks(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    n = chain.n_joints
    angles, rates = motions.angles[:n], np.diag(motions.rates[:n].diagonal())
    torques = joint_torques(chain, angles, rates, MU)
    xi = body_velocity(chain, angles, rates)
    for i in range(n):
        plain = PlainChain(chain, angles[i], rates[i])
        if i in (0, n - 1):  # head or tail alone: all other links stay where they are
            assert len(plain.sticking(xi[i])) == len(plain.points) * n // (n + 1)
        dissipated = MU * plain.dissipation(xi[i])
        assert torques[i] @ rates[i] == pytest.approx(dissipated, rel=WORK_TOLERANCE)


def test_last_link_sweeps_about_its_joint_while_the_body_lies_still(chain: PlanarChain) -> None:
    rates = np.zeros(chain.n_joints)
    rates[-1] = 0.4
    torque = joint_torques(chain, np.zeros(chain.n_joints), rates, MU)[-1]
    last = chain.lengths[-1]
    weight = chain.normal_forces.sum() * last / chain.lengths.sum()
    assert torque == pytest.approx(MU * weight * last / 2, rel=1e-4)


def test_each_torque_balances_the_moments_on_either_side_of_its_joint(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    tolerance = TOLERANCE * MU * chain.normal_forces.sum() * chain.lengths.sum()
    torques = joint_torques(chain, motions.angles, motions.rates, MU)
    xi = body_velocity(chain, motions.angles, motions.rates)
    checked = 0
    for angles, rates, torque, velocity in zip(motions.angles, motions.rates, torques, xi):
        plain = PlainChain(chain, angles, rates)
        if plain.sticking(velocity):
            continue  # the force of a sticking point is not mu N
        forces = plain.forces(velocity, MU)
        for i, (jx, jy) in enumerate(plain.joints):
            moments = [
                (p.x - jx) * fy - (p.y - jy) * fx for p, (fx, fy) in zip(plain.points, forces)
            ]
            behind = sum(m for m, p in zip(moments, plain.points) if p.link > i)
            ahead = sum(m for m, p in zip(moments, plain.points) if p.link <= i)
            assert torque[i] == pytest.approx(-behind, abs=tolerance)
            assert torque[i] == pytest.approx(ahead, abs=tolerance)
        checked += 1
    assert checked > 30


def test_joint_that_moves_alone_is_driven_the_way_it_moves(chain: PlanarChain) -> None:
    rng = np.random.default_rng(12)
    angles = rng.uniform(-0.8, 0.8, (chain.n_joints, chain.n_joints))
    for sign in (1.0, -1.0):
        torques = joint_torques(chain, angles, sign * np.eye(chain.n_joints), MU)
        assert (sign * np.diag(torques) > 0.0).all()


def test_folding_two_links_takes_the_torque_of_two_sweeping_lines() -> None:
    """Straight body, links sweep symmetrically: xi_y moves the joint half against the tips."""
    length, weight = 0.2, 10.0
    chain = PlanarChain([length, length], weight, points_per_link=64)
    # Each link turns about a point at distance c from the joint where lateral forces cancel: the
    # middle. Forces mu w/2 on the outer, -mu w/2 on the inner half: moment mu W_link l/4.
    torque = joint_torques(chain, [0.0], [0.3], MU)
    # 64 Gauss points place the change of sign to 1/64 of a link
    assert torque[0] == pytest.approx(MU * 0.5 * weight * length / 4, rel=0.02)


@pytest.mark.parametrize(('friction', 'weight'), [(0.2, 1.0), (0.8, 30.0)])
def test_torques_are_proportional_to_friction_and_weight(
    chain: PlanarChain, motions: RandomMotions, friction: float, weight: float
) -> None:
    angles, rates = motions.angles[:8], motions.rates[:8]
    unit = joint_torques(PlanarChain(chain.lengths, 1.0), angles, rates, 1.0)
    found = joint_torques(PlanarChain(chain.lengths, weight), angles, rates, friction)
    np.testing.assert_allclose(found, friction * weight * unit, rtol=0, atol=1e-9 * weight)


def test_torques_do_not_depend_on_speed_and_turn_round_with_the_motion(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    angles, rates = motions.angles[:8], motions.rates[:8]
    torques = joint_torques(chain, angles, rates, MU)
    scale = TOLERANCE * MU * chain.normal_forces.sum() * chain.lengths.sum()
    for factor in (1e-6, 50.0):
        found = joint_torques(chain, angles, factor * rates, MU)
        np.testing.assert_allclose(found, torques, rtol=0, atol=scale)
    np.testing.assert_allclose(
        joint_torques(chain, angles, -rates, MU), -torques, rtol=0, atol=scale
    )
    np.testing.assert_allclose(
        joint_torques(chain, -angles, -rates, MU), -torques, rtol=0, atol=scale
    )


def test_body_at_rest_needs_no_torque(chain: PlanarChain, motions: RandomMotions) -> None:
    still = joint_torques(chain, motions.angles, 0.0 * motions.rates, MU)
    assert still.shape == motions.angles.shape
    assert (still == 0.0).all()


def test_compiled_torques_are_those_of_the_numpy_balance(
    chain: PlanarChain, motions: RandomMotions
) -> None:
    slow = joint_torques(chain, motions.angles, motions.rates, 0.5)
    fast = QuasiStatic(chain).joint_torques(motions.angles, motions.rates, 0.5)
    np.testing.assert_allclose(fast, slow, rtol=0.0, atol=1e-3 * np.abs(slow).max())


@pytest.mark.parametrize(
    'law', [LinearDrag(), CoulombFriction(2.0), GranularResistance.of_ratio(3.0)], ids=repr
)
def test_motors_do_the_work_that_any_ground_takes(
    chain: PlanarChain, motions: RandomMotions, law: ForceLaw
) -> None:
    motion = QuasiStatic(chain, law)
    torques = motion.joint_torques(motions.angles, motions.rates, MU)
    state = chain.state(motions.angles, motions.rates)
    xi = motion.body_velocity(motions.angles, motions.rates)
    taken, slowest = np.zeros(len(xi)), np.full(len(xi), np.inf)
    for k, link in enumerate(chain.link_of_point):
        x, y = state.points[:, k].T
        vx = state.velocities[:, k, 0] + xi[:, 0] - xi[:, 2] * y
        vy = state.velocities[:, k, 1] + xi[:, 1] + xi[:, 2] * x
        c, s = np.cos(state.link_angles[:, link]), np.sin(state.link_angles[:, link])
        along, across = c * vx + s * vy, c * vy - s * vx
        force = law.force(along, across)
        slowest = np.minimum(slowest, np.hypot(along, across))
        taken -= MU * chain.normal_forces[k] * (force[0] * along + force[1] * across)
    done = (torques * motions.rates).sum(axis=-1)
    slipping = slowest > 1e-3 * np.abs(state.velocities).mean()  # else forces are not the slip's
    assert slipping.sum() > 20
    assert (done > 0.0).all()
    np.testing.assert_allclose(done[slipping], taken[slipping], rtol=1e-6)


@pytest.mark.parametrize('law', [CoulombFriction(), GranularResistance()])
def test_one_shape_meets_many_rates(law: ForceLaw) -> None:
    rng = np.random.default_rng(4)
    motion = QuasiStatic(PlanarChain([0.14] * 5), law)
    shape, rates = rng.normal(size=4), rng.normal(size=(6, 4))
    each = [motion.joint_torques(shape, rate, MU) for rate in rates]
    np.testing.assert_allclose(motion.joint_torques(shape, rates, MU), each, atol=1e-7)
