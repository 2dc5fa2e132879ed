"""Hierarchical design on a small robot, and on the paper's robot beside the best known."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from omega_turn_ros.design.hierarchical import design_hierarchical
from omega_turn_ros.design.plane_search import PARAMETERS, propose
from omega_turn_ros.design.problem import Design, DesignProblem
from omega_turn_ros.design.sub_shape import PLANES, Plane, SubShape
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.self_collision import self_clearance
from omega_turn_ros.robot import load_robot

CHAIN = PlanarChain([0.14] * 6, points_per_link=3)
PROBLEM = DesignProblem(CHAIN, 0.05, math.radians(80.0))
GAIT = PROBLEM.fitted(TwoWaveGait(1.5, 1.0, 0.5, 0.1, -1.0, 0.7, -2.7, -3.0))


@pytest.fixture(scope='module')
def design() -> Design:
    return design_hierarchical(PROBLEM, seed=3, starts=3)


def test_design_keeps_every_limit_on_a_fine_grid(design: Design) -> None:
    path = design.gait.angles(np.linspace(0.0, 2.0 * np.pi, 30_000), 5)
    assert np.abs(path).max() <= PROBLEM.theta_max + 1e-6
    assert self_clearance(CHAIN, 0.05, path).min() >= -1e-5


def test_design_turns_counter_clockwise_by_the_angle_it_says(design: Design) -> None:
    finer = PROBLEM.turn(PROBLEM.path(design.gait, 4000))
    assert finer == pytest.approx(design.angle, rel=1e-3)
    assert design.angle > math.radians(10.0)


def test_no_small_change_of_one_function_turns_much_further(design: Design) -> None:
    rng = np.random.default_rng(13)
    for names in PARAMETERS.values():
        for _ in range(60):
            changes = {k: getattr(design.gait, k) + 0.01 * rng.normal() for k in names}
            path = PROBLEM.path(replace(design.gait, **changes))
            assert PROBLEM.turn(PROBLEM.feasible_factor(path) * path) <= 1.01 * design.angle


def test_equal_seeds_give_equal_designs(design: Design) -> None:
    assert design_hierarchical(PROBLEM, seed=3, starts=3) == design


def test_more_starts_turn_no_less(design: Design) -> None:
    one = design_hierarchical(PROBLEM, seed=3, starts=1)
    assert one.angle <= design.angle * (1.0 + 1e-3)
    assert design.starts == len(design.tops) == 3
    assert design.tops == tuple(sorted(design.tops, reverse=True))
    assert design.tops[0] == pytest.approx(design.angle, rel=0.1)
    assert design.reason


@pytest.mark.parametrize('plane', PLANES)
def test_proposals_change_one_function_and_the_best_comes_first(plane: Plane) -> None:
    """Told by the integrated angle, for small changes, which the connection gets right."""
    sub = SubShape(PROBLEM, GAIT, plane)
    gaits = propose(sub, 0.05, np.random.default_rng(14), 60)
    others = set(TwoWaveGait.__slots__) - set(PARAMETERS[plane])
    angles = []
    for gait in gaits:
        assert all(getattr(gait, name) == getattr(GAIT, name) for name in others)
        path = PROBLEM.path(gait, 200)
        angles.append(PROBLEM.turn(PROBLEM.feasible_factor(path) * path))
    assert np.mean(angles[:10]) > np.mean(angles[20:30])


@pytest.mark.parametrize(('limit', 'k_t', 'floor'), [(90.0, 1.0, 90.5), (90.0, 0.0, 54.0)])
def test_design_for_the_papers_robot_comes_near_the_best_known(
    limit: float, k_t: float, floor: float
) -> None:
    problem = DesignProblem.of_robot(load_robot('limbless16'), math.radians(limit), 1.5, k_t)
    assert math.degrees(design_hierarchical(problem).angle) > floor


def test_no_start_is_refused() -> None:
    with pytest.raises(BadInputError, match='starts'):
        design_hierarchical(PROBLEM, starts=0)
