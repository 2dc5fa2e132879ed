"""Direct design on a small robot, where every search takes a second."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from omega_turn_ros.design.direct import design_direct
from omega_turn_ros.design.fourier import design_fourier
from omega_turn_ros.design.objective import turning_speed
from omega_turn_ros.design.problem import Design, DesignProblem
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.self_collision import self_clearance
from omega_turn_ros.mechanics.swept_area import swept_area_by_start

CHAIN = PlanarChain([0.14] * 6, points_per_link=3)
PROBLEM = DesignProblem(CHAIN, 0.05, math.radians(80.0))


@pytest.fixture(scope='module')
def design() -> Design:
    return design_direct(PROBLEM, seed=3, starts=4)


def test_a_designed_gait_keeps_joint_limit_and_clearance_on_a_fine_grid(design: Design) -> None:
    path = design.gait.angles(np.linspace(0.0, 2.0 * np.pi, 30_000), 5)
    assert np.abs(path).max() <= PROBLEM.theta_max + 1e-6
    assert self_clearance(CHAIN, 0.05, path).min() >= -1e-5
    at_limit = np.abs(path).max() > PROBLEM.theta_max - 1e-3
    assert at_limit or self_clearance(CHAIN, 0.05, path).min() < 1e-3


def test_a_designed_gait_turns_counter_clockwise_by_the_angle_it_says(design: Design) -> None:
    finer = PROBLEM.turn(PROBLEM.path(design.gait, 4000))
    assert finer == pytest.approx(design.angle, rel=1e-3)
    assert design.angle > math.radians(10.0)


def test_no_random_gait_of_the_family_turns_further(design: Design) -> None:
    rng = np.random.default_rng(11)
    for _ in range(300):
        gait = TwoWaveGait(1.5, 1.0, *rng.normal(size=2), rng.uniform(-4, 4), *rng.normal(size=3))
        path = PROBLEM.path(gait, 120)
        assert abs(PROBLEM.turn(PROBLEM.feasible_factor(path) * path)) <= design.angle


def test_no_small_change_of_a_designed_gait_turns_further(design: Design) -> None:
    rng = np.random.default_rng(12)
    for _ in range(200):
        changes = dict(zip(TwoWaveGait.__slots__[2:], 0.01 * rng.normal(size=6)))
        near = replace(design.gait, **{k: getattr(design.gait, k) + v for k, v in changes.items()})
        path = PROBLEM.path(near)
        assert PROBLEM.turn(PROBLEM.feasible_factor(path) * path) <= 1.002 * design.angle


def test_equal_seeds_give_equal_gaits() -> None:
    first, second = (design_direct(PROBLEM, seed=8, starts=2) for _ in range(2))
    assert first == second
    assert first.reason


def test_a_limit_on_area_is_kept_and_costs_turn(design: Design) -> None:
    limit = 0.2
    thrifty = design_direct(PROBLEM, seed=3, starts=8, area_limit=limit)
    areas = []
    for gait in (design.gait, thrifty.gait):
        path = PROBLEM.path(gait, 360)
        poses = PROBLEM.motion.pose_along(path)
        areas.append(swept_area_by_start(CHAIN, path, poses, 24).min())
    assert areas[1] <= 1.03 * limit < areas[0]  # the search looks at fewer shapes and starts
    assert 0.2 * design.angle < thrifty.angle < design.angle


def test_fourier_gaits_turn_faster_at_equal_peak_joint_speed_than_the_paper_s_family() -> None:
    paper = design_direct(PROBLEM, seed=1, starts=3, per_second=True)
    richer = design_fourier(PROBLEM, seed=1, starts=3, harmonics=1)
    speeds = [turning_speed(d.angle, PROBLEM.path(d.gait)) for d in (paper, richer)]
    assert speeds[1] > speeds[0]


@pytest.mark.parametrize(
    ('field', 'value'),
    [
        ('theta_max', 0.001),
        ('theta_max', math.nan),
        ('width', 0.0),
        ('k_f', 0.0),
        ('k_t', 9.0),
        ('k_f', math.nan),
        ('samples', 3),
    ],
)
def test_a_body_that_cannot_turn_is_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(BadInputError, match=rf'^{field}: '):
        replace(PROBLEM, **{field: value})


def test_a_straight_path_cannot_be_fitted() -> None:
    with pytest.raises(BadInputError, match='gait amplitudes'):
        PROBLEM.fitted(TwoWaveGait(1.5, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
