"""What the library promises of every gait in it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from omega_turn_ros.design.catalogue import CATALOGUE, recipes_for
from omega_turn_ros.gaits.library import gait_names, load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.mechanics.self_collision import self_clearance
from omega_turn_ros.mechanics.trajectory import heading_along
from omega_turn_ros.robot import load_robot

ROBOT = load_robot('limbless16')
CHAIN = PlanarChain.of_robot(ROBOT)
ONE_DEGREE = math.radians(1.0)
TWO_WAVE = [recipe.name for recipe in CATALOGUE]

# An independent optimiser's best on the same body [deg per cycle].
FLOORS = {'omega': 92.0, 'omega_75': 50.0, 'omega_60': 26.0, 'offset': 54.0}


def test_the_library_is_what_the_catalogue_says() -> None:
    recipes = [*recipes_for(ROBOT), *recipes_for(load_robot('legged10'))]
    assert sorted(gait_names()) == sorted(recipe.name for recipe in recipes)
    for recipe in CATALOGUE:
        shipped = load_gait(recipe.name)
        assert (shipped.gait.k_f, shipped.gait.k_t) == (recipe.k_f, recipe.k_t)
        assert shipped.theta_max <= math.radians(recipe.theta_max_deg) + 1e-4


@pytest.mark.parametrize('name', TWO_WAVE)
def test_a_gait_keeps_its_limit_and_clear_of_itself_at_every_scale(name: str) -> None:
    entry = load_gait(name)
    phases = np.linspace(0.0, 2.0 * np.pi, 5000)
    path = entry.gait.angles(phases, ROBOT.n_yaw)
    assert np.abs(path).max() <= entry.theta_max + 1e-6
    for scale in (0.25, 0.5, 0.75, 0.9, 1.0):
        assert self_clearance(CHAIN, ROBOT.module_width, scale * path).min() > -1e-5


@pytest.mark.parametrize('name', TWO_WAVE)
def test_predicted_angle_is_the_integrated_one_at_any_scale(name: str) -> None:
    entry = load_gait(name)
    table, motion = entry.calibration, QuasiStatic(CHAIN)
    phases = table.start_phase + np.linspace(0.0, 2.0 * np.pi, 481)
    path = entry.gait.angles(phases, ROBOT.n_yaw)
    for scale in np.random.default_rng(5).uniform(0.0, 1.0, 60):
        heading = motion.heading_along(scale * path)
        assert abs(table.angle_of(scale) - heading[-1]) < ONE_DEGREE
        middle = table.heading_at(scale, np.pi)
        assert abs(middle - heading[240]) < 2.0 * ONE_DEGREE


@pytest.mark.parametrize('name', TWO_WAVE)
def test_angle_rises_with_the_scale_without_a_jump(name: str) -> None:
    table = load_gait(name).calibration
    angles = np.array([table.angle_of(s) for s in np.linspace(0.0, 1.0, 2001)])
    assert angles[0] == 0.0
    assert (np.diff(angles) >= 0.0).all()
    assert np.diff(angles).max() < 0.1 * ONE_DEGREE * max(1.0, math.degrees(angles[-1]) / 20.0)


@pytest.mark.parametrize('name', sorted(FLOORS))
def test_designed_gait_turns_at_least_as_far_as_an_independent_design(name: str) -> None:
    entry = load_gait(name)
    path = entry.gait.angles(np.linspace(0.0, 2.0 * np.pi, 721), ROBOT.n_yaw)
    slow = heading_along(CHAIN, path)[-1]
    assert math.degrees(slow) >= FLOORS[name] - 0.2  # theirs may touch itself by millimetres
    assert entry.calibration.largest_angle == pytest.approx(slow, abs=0.1 * ONE_DEGREE)
