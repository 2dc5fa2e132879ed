"""The waves of a robot with legs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.robot import load_robot

PHASES = np.linspace(0.0, 2.0 * np.pi, 1440, endpoint=False)
TEN_LEGS = LeggedGait(5, math.radians(30), math.radians(20), math.radians(20), math.radians(20))
GAITS = [
    TEN_LEGS,
    replace(TEN_LEGS, duty=0.5, sigma=0.0, phi_3=0.0),
    LeggedGait(2, 0.4, 0.2, 0.3, 0.1, duty=0.75, xi=0.5),
    LeggedGait(8, 0.5, 0.3, 0.3, 0.2, duty=0.4, xi=1.6, raising=0.5, sigma=1.0),
]


@pytest.fixture(params=GAITS, ids=lambda gait: f'{gait.n_pairs} pairs, D {gait.duty}')
def gait(request: pytest.FixtureRequest) -> LeggedGait:
    return request.param


def test_every_foot_is_down_for_the_duty_factor(gait: LeggedGait) -> None:
    share = gait.contact(PHASES).mean(axis=0)
    assert share.shape == (gait.n_pairs, 2)
    np.testing.assert_allclose(share, gait.duty, atol=1.5 / PHASES.size)


def test_leg_pairs_follow_one_another_and_sides_alternate(gait: LeggedGait) -> None:
    delay = 2.0 * np.pi * gait.xi / gait.n_pairs
    for wave in (gait.swing, gait.lift):
        np.testing.assert_allclose(
            wave(PHASES + delay)[:, 1:], wave(PHASES)[:, :-1], rtol=0.0, atol=1e-9
        )
        np.testing.assert_allclose(
            wave(PHASES + np.pi)[..., 0], wave(PHASES)[..., 1], rtol=0.0, atol=1e-9
        )


def test_left_leg_1_lands_forward_at_phase_0_and_is_drawn_back_while_down(
    gait: LeggedGait,
) -> None:
    swing, down = gait.swing(PHASES)[:, 0, 0], gait.contact(PHASES)[:, 0, 0]
    assert down[0] and not down[-1]
    assert swing[0] == pytest.approx(gait.theta_leg)
    assert swing[down][-1] == pytest.approx(-gait.theta_leg, abs=1e-4)
    assert (np.diff(swing[down]) < 0.0).all() and (np.diff(swing[~down]) > 0.0).all()


def test_legs_are_raised_only_in_swing_and_all_the_way(gait: LeggedGait) -> None:
    lift, down = gait.lift(PHASES), gait.contact(PHASES)
    assert (lift[down] < 1e-12).all()
    assert (lift >= 0.0).all()
    np.testing.assert_allclose(lift.max(axis=0), gait.theta_lift, rtol=1e-3)


def test_no_joint_jumps_nor_does_its_rate(gait: LeggedGait) -> None:
    """The wave of a leg is put together from pieces; the rate of a leg stays continuous."""
    fine = np.linspace(0.0, 2.0 * np.pi, 14401)
    rates = np.diff(gait.angles(fine), axis=0) / (fine[1] - fine[0])
    jumps = np.abs(np.diff(rates, axis=0)).max()
    assert jumps < 0.02 * np.abs(rates).max()


def test_undulation_is_a_wave_that_travels_from_head_to_tail(gait: LeggedGait) -> None:
    delay = 2.0 * np.pi * gait.xi / gait.n_pairs
    body = gait.undulation(PHASES)
    assert body.shape == (PHASES.size, gait.n_pairs - 1)
    np.testing.assert_allclose(np.abs(body).max(axis=0), gait.theta_body, rtol=1e-4)
    np.testing.assert_allclose(gait.undulation(PHASES + delay)[:, 1:], body[:, :-1], atol=1e-12)


def test_mirrored_robot_is_the_robot_half_a_cycle_later_with_the_offset_reversed(
    gait: LeggedGait,
) -> None:
    """The symmetry which forbids w_3 = A_3 sin(phi) to turn."""
    np.testing.assert_allclose(
        gait.swing(PHASES)[..., ::-1], gait.swing(PHASES + np.pi), rtol=0.0, atol=1e-9
    )
    np.testing.assert_allclose(
        -gait.body(PHASES, 0.0), gait.body(PHASES + np.pi, 0.0), rtol=0.0, atol=1e-9
    )
    printed = replace(gait, sigma=0.0, phi_3=0.0)
    np.testing.assert_allclose(
        -printed.offset(PHASES), printed.offset(PHASES + np.pi), rtol=0.0, atol=1e-9
    )
    assert gait.sigma == 0.0 or np.abs(gait.offset(PHASES) + gait.offset(PHASES + np.pi)).max() > (
        0.1 * gait.a_3
    )


@pytest.mark.parametrize('scale', [-1.0, 0.0, 0.4])
def test_scale_bends_the_body_evenly_and_leaves_the_legs_alone(
    gait: LeggedGait, scale: float
) -> None:
    full, scaled = gait.angles(PHASES), gait.angles(PHASES, scale)
    yaw = np.arange(4, gait.n_joints, 5)
    np.testing.assert_array_equal(np.delete(full, yaw, 1), np.delete(scaled, yaw, 1))
    bend = (full - scaled)[:, yaw]
    np.testing.assert_allclose(
        bend, np.tile(-(1.0 - scale) * gait.offset(PHASES)[:, None], yaw.size), atol=1e-12
    )


def test_turning_begins_and_ends_in_walking() -> None:
    assert TEN_LEGS.offset(0.0) == pytest.approx(0.0, abs=1e-15)
    assert TEN_LEGS.offset(1e-4) == pytest.approx(0.0, abs=1e-8)
    assert TEN_LEGS.offset(PHASES).min() >= 0.0
    assert TEN_LEGS.offset(np.pi) == pytest.approx(TEN_LEGS.a_3)


def test_paper_path_and_constant_bend_are_members() -> None:
    printed = replace(TEN_LEGS, sigma=0.0, phi_3=0.0)
    np.testing.assert_allclose(printed.offset(PHASES), TEN_LEGS.a_3 * np.sin(PHASES))
    np.testing.assert_allclose(replace(TEN_LEGS, sigma=1.0).offset(PHASES), TEN_LEGS.a_3)


def test_angles_are_in_the_robot_s_order() -> None:
    robot = load_robot('legged10')
    angles = TEN_LEGS.angles(0.7)
    assert angles.shape == (robot.n_joints,)
    of = dict(zip(robot.joint_names, angles))
    for i in range(5):
        for j, side in enumerate(('left', 'right')):
            assert of[f'{side}_{i + 1}_swing'] == TEN_LEGS.swing(0.7)[i, j]
            assert of[f'{side}_{i + 1}_lift'] == TEN_LEGS.lift(0.7)[i, j]
    assert [of[f'body_{i}'] for i in (1, 2, 3, 4)] == TEN_LEGS.body(0.7).tolist()


@pytest.mark.parametrize(
    ('field', 'value'),
    [
        ('n_pairs', 1),
        ('n_pairs', 2.5),
        ('duty', 0.0),
        ('duty', 1.0),
        ('raising', 0.6),
        ('sigma', -0.1),
        ('theta_leg', math.nan),
        ('a_3', 'much'),
        ('xi', True),
    ],
)
def test_what_is_no_gait_is_refused_by_field(field: str, value: object) -> None:
    with pytest.raises(BadInputError, match=f'gait field {field}'):
        replace(TEN_LEGS, **{field: value})


def test_parameters_survive_the_library_s_format() -> None:
    assert LeggedGait.from_mapping(TEN_LEGS.to_mapping()) == TEN_LEGS
    short = TEN_LEGS.to_mapping()
    del short['duty']
    with pytest.raises(BadInputError, match='gait parameters'):
        LeggedGait.from_mapping(short)
