"""The three planes of a gait (eq:sub_shape_space): shapes, paths, limits, and Stokes on them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from omega_turn_ros.design.problem import DesignProblem
from omega_turn_ros.design.sub_shape import PLANES, Plane, SubShape, grid
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.mechanics.force_laws import CoulombFriction, LinearDrag
from omega_turn_ros.mechanics.height_function import line_integral
from omega_turn_ros.mechanics.local_connection import local_connection
from omega_turn_ros.mechanics.self_collision import self_clearance
from omega_turn_ros.robot import load_robot

ROBOT = load_robot('limbless16')
GAIT = TwoWaveGait(1.5, 1.0, -0.55, 0.05, -1.0, 0.7, -2.7, -3.0)
DRAG = DesignProblem.of_robot(ROBOT, math.radians(80.0), law=LinearDrag())
FRICTION = DesignProblem.of_robot(ROBOT, math.radians(80.0), law=CoulombFriction())
EACH_PLANE = pytest.mark.parametrize('plane', PLANES)


@EACH_PLANE
def test_path_in_a_plane_runs_through_the_shapes_of_the_gait(plane: Plane) -> None:
    sub = SubShape(DRAG, GAIT, plane)
    theta, _ = sub.shapes(sub.path(60))
    start = 0.0 if plane == 'turning' else GAIT.psi
    expected = GAIT.angles(start + np.linspace(0.0, 2.0 * np.pi, 61), 8)
    np.testing.assert_allclose(theta, expected, atol=1e-12)


@EACH_PLANE
def test_jacobian_is_the_derivative_of_the_shape(plane: Plane) -> None:
    sub = SubShape(DRAG, GAIT, plane)
    r = np.random.default_rng(51).uniform(-3.0, 3.0, (20, 2))
    _, jacobian = sub.shapes(r)
    h = 1e-6
    for k, step in enumerate(h * np.eye(2)):
        difference = (sub.shapes(r + step)[0] - sub.shapes(r - step)[0]) / (2.0 * h)
        np.testing.assert_allclose(jacobian[..., k], difference, atol=1e-8)


@EACH_PLANE
def test_other_functions_do_not_depend_on_the_one_the_plane_is_for(plane: Plane) -> None:
    changed = {
        'turning': replace(GAIT, a_o=0.1, phi_o=1.0),
        'forward': replace(GAIT, a_f=0.1, gamma=2.0, phi_f=1.0),
        'phase': replace(GAIT, psi=1.0),
    }[plane]
    r = np.random.default_rng(52).uniform(-3.0, 3.0, (20, 2))
    before, after = (SubShape(DRAG, g, plane).shapes(r)[0] for g in (GAIT, changed))
    np.testing.assert_array_equal(before, after)


@EACH_PLANE
def test_surface_line_and_direct_integration_agree_where_the_connection_is_exact(
    plane: Plane,
) -> None:
    sub = SubShape(DRAG, GAIT, plane)
    path = sub.path(2000)
    direct = DRAG.turn(DRAG.path(GAIT, 2000))
    line = line_integral(local_connection(DRAG.motion, *sub.shapes(path)).matrix, path)[2]
    field = sub.field(64)
    assert line == pytest.approx(direct, abs=2e-5)
    assert field.surface(path) + field.loops(path) == pytest.approx(direct, abs=2e-5)
    assert field.misfit.max() < 1e-9


@EACH_PLANE
def test_surface_of_an_exact_connection_converges_with_the_third_power_or_better(
    plane: Plane,
) -> None:
    sub = SubShape(DRAG, GAIT, plane)
    path = sub.path(4000)
    direct = DRAG.turn(DRAG.path(GAIT, 4000))
    fields = [sub.field(n) for n in (16, 32)]
    errors = [abs(f.surface(path) + f.loops(path) - direct) for f in fields]
    assert errors[1] < errors[0] / 8.0 + 1e-6


@EACH_PLANE
def test_connection_fitted_along_the_gait_gives_the_turn_under_friction(plane: Plane) -> None:
    """The one fitted to all directions misses it by a tenth or more."""
    sub = SubShape(FRICTION, GAIT, plane)
    path = sub.path(720)
    direct = FRICTION.turn(FRICTION.path(GAIT, 720))
    along = sub.field(64, spread=0.01)
    assert along.surface(path) + along.loops(path) == pytest.approx(direct, rel=0.02)


def test_feasibility_tells_the_two_limits_apart() -> None:
    problem = replace(FRICTION, theta_max=math.radians(100.0))
    sub = SubShape(problem, GAIT, 'turning')
    r = grid(sub.axes(40, 3.0))
    limits = sub.feasibility(r)
    theta, _ = sub.shapes(r)
    np.testing.assert_array_equal(
        limits.over_limit, np.abs(theta).max(axis=-1) > problem.theta_max
    )
    clearance = self_clearance(problem.chain, problem.width, theta)
    np.testing.assert_array_equal(limits.collides, clearance < 0.0)
    np.testing.assert_array_equal(limits.infeasible, limits.over_limit | limits.collides)
    for mask in (limits.over_limit & ~limits.collides, limits.collides & ~limits.over_limit):
        assert mask.any()


def test_allowed_scale_brings_every_shape_to_its_limit() -> None:
    sub = SubShape(FRICTION, GAIT, 'turning')
    r = grid(sub.axes(20, 2.5))
    scale = sub.allowed_scale(r)
    theta = sub.shapes(r)[0] * scale[..., None]
    assert np.abs(theta).max() <= FRICTION.theta_max + 1e-12
    assert self_clearance(FRICTION.chain, FRICTION.width, theta).min() >= 0.0
    feasible = ~sub.feasibility(r).infeasible
    assert (scale[feasible] > 1.0 - 1e-12).all() and (scale[~feasible] < 1.0).all()


def test_plane_of_another_name_is_refused() -> None:
    with pytest.raises(BadInputError, match='plane'):
        SubShape(DRAG, GAIT, 'sideways')  # type: ignore[arg-type]
