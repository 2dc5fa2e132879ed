"""Kinematics of the chain against a walk along it, link by link."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plain_chain import PlainChain

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.robot import load_robot

ROUNDING = 1e-12  # [m] or [rad] of some ten sums of numbers below 10


@pytest.fixture
def shape() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    return rng.uniform(-1.2, 1.2, 3), rng.normal(size=3)


def test_points_joints_and_velocities_are_those_of_a_walk_along_the_chain(
    uneven: PlanarChain, shape: tuple[np.ndarray, np.ndarray]
) -> None:
    state, plain = uneven.state(*shape), PlainChain(uneven, *shape)
    np.testing.assert_allclose(state.link_angles, plain.alpha, atol=ROUNDING)
    np.testing.assert_allclose(state.joints, plain.joints, atol=ROUNDING)
    np.testing.assert_allclose(state.points, [(p.x, p.y) for p in plain.points], atol=ROUNDING)
    np.testing.assert_allclose(
        state.velocities, [(p.vx, p.vy) for p in plain.points], atol=ROUNDING
    )


def test_velocities_are_the_time_derivatives_of_the_points(
    uneven: PlanarChain, shape: tuple[np.ndarray, np.ndarray]
) -> None:
    angles, rates = shape
    h = 1e-5
    after, before = (uneven.state(angles + s * h * rates, rates).points for s in (1, -1))
    # central difference: error ~ h^2 |x'''| ~ 1e-9
    np.testing.assert_allclose(
        uneven.state(angles, rates).velocities, (after - before) / (2 * h), atol=1e-8
    )


def test_mean_body_frame_has_its_origin_and_axis_at_the_means(
    uneven: PlanarChain, shape: tuple[np.ndarray, np.ndarray]
) -> None:
    state = uneven.state(*shape)
    assert state.link_angles @ uneven.fractions == pytest.approx(0.0, abs=ROUNDING)
    for field in (state.points, state.velocities):
        mean = uneven.normal_forces @ field / uneven.normal_forces.sum()
        np.testing.assert_allclose(mean, 0.0, atol=ROUNDING)


def test_positive_joint_angle_turns_the_links_behind_counter_clockwise() -> None:
    chain = PlanarChain([1.0, 1.0])
    alpha = chain.link_angles([0.4])
    assert alpha[1] - alpha[0] == pytest.approx(0.4)
    assert chain.outline([0.4], [0.0, 0.0, 0.0])[-1, 1] < chain.outline([0.0], [0.0] * 3)[-1, 1]


def test_head_points_along_x_and_the_tail_lies_behind(chain: PlanarChain) -> None:
    line = chain.outline(np.zeros(chain.n_joints), [0.0, 0.0, 0.0])
    assert line[0] == pytest.approx([0.5 * chain.lengths.sum(), 0.0])
    assert line[-1] == pytest.approx([-0.5 * chain.lengths.sum(), 0.0])
    assert (np.diff(line[:, 0]) < 0.0).all()


def test_outline_keeps_link_lengths_and_joints_and_takes_any_pose(
    uneven: PlanarChain, shape: tuple[np.ndarray, np.ndarray]
) -> None:
    angles, rates = shape
    pose = np.array([0.7, -2.0, 1.1])
    line = uneven.outline(angles, pose)
    np.testing.assert_allclose(np.hypot(*np.diff(line, axis=0).T), uneven.lengths, atol=ROUNDING)
    c, s = math.cos(1.1), math.sin(1.1)
    joints = uneven.state(angles, rates).joints @ np.array([[c, s], [-s, c]]) + pose[:2]
    np.testing.assert_allclose(line[1:-1], joints, atol=ROUNDING)


def test_batches_are_many_single_shapes(uneven: PlanarChain) -> None:
    rng = np.random.default_rng(6)
    angles, rates, poses = (rng.normal(size=(2, 5, n)) for n in (3, 3, 3))
    states, lines = uneven.state(angles, rates), uneven.outline(angles, poses)
    for i in np.ndindex(2, 5):
        alone = uneven.state(angles[i], rates[i])
        np.testing.assert_allclose(states.points[i], alone.points, atol=ROUNDING)
        np.testing.assert_allclose(states.velocities[i], alone.velocities, atol=ROUNDING)
        np.testing.assert_allclose(lines[i], uneven.outline(angles[i], poses[i]), atol=ROUNDING)


@pytest.mark.parametrize('count', [2, 3, 4, 8])
def test_contact_points_load_the_ground_like_a_uniform_line(count: int) -> None:
    lengths = np.array([0.3, 0.1, 0.2])
    chain = PlanarChain(lengths, weight=12.0, points_per_link=count)
    for link, length in enumerate(lengths):
        mine = chain.link_of_point == link
        force, offset = chain.normal_forces[mine], chain.point_offsets[mine]
        assert force.sum() == pytest.approx(12.0 * length / 0.6)
        assert force @ offset == pytest.approx(0.0, abs=ROUNDING)
        assert force @ offset**2 / force.sum() == pytest.approx(length**2 / 12.0)
        assert np.abs(offset).max() < 0.5 * length


def test_robot_s_chain_has_its_links_and_its_weight() -> None:
    robot = load_robot('limbless16')
    chain = PlanarChain.of_robot(robot, 2)
    np.testing.assert_array_equal(chain.lengths, robot.planar_link_lengths)
    assert chain.normal_forces.sum() == pytest.approx(robot.weight)
    assert chain.n_joints == robot.n_yaw


@pytest.mark.parametrize(
    ('field', 'arguments'),
    [
        ('link_lengths', ([0.1],)),
        ('link_lengths', ([[0.1, 0.1]],)),
        ('link_lengths', ([0.1, 0.0],)),
        ('link_lengths', ([0.1, -0.1],)),
        ('link_lengths', ([0.1, math.nan],)),
        ('weight', ([0.1, 0.1], 0.0)),
        ('weight', ([0.1, 0.1], math.inf)),
        ('points_per_link', ([0.1, 0.1], 1.0, 0)),
    ],
)
def test_chain_that_cannot_be_is_refused_by_name(field: str, arguments: tuple) -> None:
    with pytest.raises(BadInputError, match=f'^{field}: '):
        PlanarChain(*arguments)


def test_points_over_a_width_have_the_moments_of_a_uniform_rectangle() -> None:
    chain = PlanarChain([0.3, 0.2], 5.0, 3, width=0.1, points_across=2)
    share = chain.lengths / chain.lengths.sum()
    for link, length in enumerate(chain.lengths):
        of_link = chain.link_of_point == link
        force, along, side = (
            v[of_link] for v in (chain.normal_forces, chain.point_offsets, chain.point_sides)
        )
        assert force.sum() == pytest.approx(5.0 * share[link])
        assert force @ along == pytest.approx(0.0, abs=ROUNDING)
        assert force @ side == pytest.approx(0.0, abs=ROUNDING)
        assert force @ along**2 / force.sum() == pytest.approx(length**2 / 12.0)
        assert force @ side**2 / force.sum() == pytest.approx(0.1**2 / 12.0)


def test_loads_share_out_the_weight_in_any_unit() -> None:
    chain = PlanarChain([0.3, 0.2, 0.1], 6.0, loads=[10.0, 20.0, 30.0])
    per_link = [chain.normal_forces[chain.link_of_point == link].sum() for link in range(3)]
    assert per_link == pytest.approx([1.0, 2.0, 3.0])


def test_points_on_the_side_move_with_their_link() -> None:
    chain = PlanarChain([0.3, 0.2, 0.1], width=0.1, points_across=3)
    rng = np.random.default_rng(6)
    angles, rates, h = rng.uniform(-1.0, 1.0, 2), rng.normal(size=2), 1e-5
    after, before = (chain.state(angles + s * h * rates, rates).points for s in (1, -1))
    np.testing.assert_allclose(
        chain.state(angles, rates).velocities, (after - before) / (2 * h), atol=1e-8
    )


@pytest.mark.parametrize(
    ('options', 'field'),
    [
        ({'loads': [1.0, 1.0]}, 'loads'),
        ({'loads': [1.0, 0.0, 1.0]}, 'loads'),
        ({'width': -0.1}, 'width'),
        ({'width': np.nan}, 'width'),
        ({'points_across': 0}, 'points_across'),
    ],
)
def test_unusable_width_or_load_is_refused(options: dict, field: str) -> None:
    with pytest.raises(BadInputError) as caught:
        PlanarChain([0.3, 0.2, 0.1], **options)
    assert caught.value.field == field
