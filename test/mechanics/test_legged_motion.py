"""Slipping feet: kinematics against differences, force balance against a slow minimum."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.mechanics.foot_loads import equal_loads, static_loads
from omega_turn_ros.mechanics.force_balance import slip_velocities, solve_balance
from omega_turn_ros.mechanics.legged import LeggedMotion
from omega_turn_ros.robot import LeggedRobot, load_robot

GAIT = LeggedGait(5, math.radians(30), math.radians(20), math.radians(20), math.radians(20))
PAPER_PATH = replace(GAIT, sigma=0.0, phi_3=0.0)


@pytest.fixture(scope='module')
def robot() -> LeggedRobot:
    robot = load_robot('legged10')
    assert isinstance(robot, LeggedRobot)
    return robot


@pytest.fixture(scope='module', params=['equal', 'static'])
def motion(request: pytest.FixtureRequest, robot: LeggedRobot) -> LeggedMotion:
    return LeggedMotion(robot, request.param)


def cycle(steps: int = 360) -> np.ndarray:
    return np.linspace(0.0, 2.0 * np.pi, steps + 1)


def test_feet_of_the_straight_robot_stand_beside_the_middles_of_its_segments(
    motion: LeggedMotion,
) -> None:
    feet = motion.feet.places(np.zeros(24)).reshape(5, 2, 2)
    np.testing.assert_allclose(feet[..., 0], np.tile([[0.36], [0.18], [0], [-0.18], [-0.36]], 2))
    np.testing.assert_allclose(feet[..., 1], np.tile([0.15, -0.15], (5, 1)))
    swung = np.zeros(24)
    swung[[0, 2]] = math.radians(30)  # left and right leg 1 forward
    ahead = motion.feet.places(swung).reshape(5, 2, 2) - feet
    np.testing.assert_allclose(ahead[0, :, 0], 0.1 * math.sin(math.radians(30)))
    assert ahead[0, 0, 1] < 0.0 < ahead[0, 1, 1]


def test_foot_velocities_are_the_derivative_of_foot_positions(motion: LeggedMotion) -> None:
    rng = np.random.default_rng(0)
    q, dq = rng.uniform(-0.6, 0.6, (2, 20, 24))
    h = 1e-6
    difference = (motion.feet.places(q + h * dq) - motion.feet.places(q - h * dq)) / (2.0 * h)
    np.testing.assert_allclose(motion.feet.moving(q, dq)[1], difference, atol=1e-8)


def test_body_velocity_is_where_friction_dissipates_least(motion: LeggedMotion) -> None:
    """Against a derivative-free search, in shapes all over the gait."""
    phases = np.linspace(0.1, 2.0 * np.pi, 9, endpoint=False)
    q, dq = GAIT.angles(phases), (GAIT.angles(phases + 1e-5) - GAIT.angles(phases - 1e-5)) / 2e-5
    found = motion.body_velocity(q, dq)
    points, velocities = motion.feet.moving(q, dq)
    loads = motion.feet.loads(q)

    def dissipation(xi: np.ndarray, k: int) -> float:
        slip = slip_velocities(points[k : k + 1], velocities[k : k + 1], xi[None])[0]
        return float(loads[k] @ np.hypot(slip[:, 0], slip[:, 1]))

    for k, xi in enumerate(found):
        search = minimize(
            dissipation, xi + 0.01, (k,), 'Nelder-Mead', options={'xatol': 1e-9, 'fatol': 1e-12}
        )
        assert dissipation(xi, k) <= search.fun + 1e-9


def test_compiled_balance_agrees_with_the_plain_one(motion: LeggedMotion) -> None:
    """A foot in a shape of its own has to stick at times, which few points do often."""
    q = GAIT.angles(cycle())
    middles, steps = 0.5 * (q[1:] + q[:-1]), np.diff(q, axis=0)
    points, velocities = motion.feet.moving(middles, steps)
    loads = motion.feet.loads(middles)
    found = motion.body_velocity(middles, steps)
    plain = np.array(
        [
            solve_balance(p[None], v[None], w)[0]
            for p, v, w in zip(points[::8], velocities[::8], loads[::8])
        ]
    )
    np.testing.assert_allclose(found[::8], plain, atol=2e-3 * np.abs(plain).max())


def test_legs_in_the_air_do_not_matter(motion: LeggedMotion) -> None:
    q = GAIT.angles(1.0)
    dq = GAIT.angles(1.001) - q
    moved = dq.copy()
    in_air = np.flatnonzero(~motion.feet.down(q))
    swing = np.flatnonzero(np.array(motion.robot.joint_axes) == 'swing')[in_air]
    moved[swing] += 0.3
    np.testing.assert_allclose(motion.body_velocity(q, moved), motion.body_velocity(q, dq))


def test_body_wave_leads_so_that_steps_are_longest(robot: LeggedRobot) -> None:
    """phi_b = phi - (xi/n + 1/2) pi gives most thrust; checked with and without that lead."""
    motion = LeggedMotion(robot)
    reach = []
    yaw = robot.yaw_indices
    for shift in np.radians([-90.0, -45.0, 0.0, 45.0, 90.0, 180.0]):
        path = GAIT.angles(cycle(), 0.0)
        path[:, yaw] = GAIT.body(cycle() + shift, 0.0)
        reach.append(motion.pose_along(path)[-1, 0])
    assert np.argmax(reach) == 2
    still = replace(GAIT, theta_body=0.0)
    assert reach[2] > 1.1 * motion.pose_along(still.angles(cycle(), 0.0))[-1, 0]


def test_walking_goes_forward_and_turns_nowhere(motion: LeggedMotion) -> None:
    x, y, heading = motion.pose_along(GAIT.angles(cycle(), 0.0))[-1]
    assert x > 0.3 * motion.robot.length
    assert abs(y) < 0.02 * motion.robot.length
    assert heading == pytest.approx(0.0, abs=1e-6)


def test_rotation_grows_with_the_offset(motion: LeggedMotion) -> None:
    turns = [motion.turn(GAIT.angles(cycle(), s)) for s in (0.0, 0.25, 0.5, 0.75, 1.0)]
    assert (np.diff(turns) > math.radians(1.5)).all()
    # The other way at the same phase is nearly the mirror image; exactly so half a cycle later.
    assert motion.turn(GAIT.angles(cycle(), -1.0)) == pytest.approx(-turns[-1], rel=0.1)
    later = replace(GAIT, phi_3=GAIT.phi_3 + math.pi)
    assert motion.turn(later.angles(cycle(), -1.0)) == pytest.approx(-turns[-1], rel=1e-3)


def test_path_that_is_its_own_mirror_image_cannot_turn(motion: LeggedMotion) -> None:
    """w_3 = A_3 sin(phi), as the paper prints it: the half cycles undo each other."""
    heading = motion.heading_along(PAPER_PATH.angles(cycle()))
    assert abs(heading[180]) > math.radians(0.5)
    assert heading[-1] == pytest.approx(0.0, abs=1e-6)


def test_displacement_converges_with_the_step(motion: LeggedMotion) -> None:
    coarse, fine = (motion.turn(GAIT.angles(cycle(n))) for n in (360, 1440))
    assert coarse == pytest.approx(fine, rel=0.01)


def test_static_loads_hold_the_body_level(robot: LeggedRobot) -> None:
    motion = LeggedMotion(robot, 'static')
    q = GAIT.angles(cycle())
    feet, down = motion.feet.places(q), motion.feet.down(q)
    loads = static_loads(feet, down)
    assert (loads >= 0.0).all() and (loads[~down] == 0.0).all()
    np.testing.assert_allclose(loads.sum(axis=-1), 1.0)
    np.testing.assert_allclose(np.einsum('bp,bpx->bx', loads, feet), 0.0, atol=1e-9)
    # Equal ones do not: what the paper leaves out.
    moment = np.einsum('bp,bpx->bx', equal_loads(feet, down), feet)
    assert np.abs(moment).max() > 0.02


def test_foot_that_would_have_to_pull_carries_nothing() -> None:
    feet = np.array([[-0.1, 0.5], [-0.1, -0.5], [1.0, 0.0], [3.0, 0.0]])
    loads = static_loads(feet, np.ones(4, bool))
    assert loads[3] == 0.0
    np.testing.assert_allclose(loads @ feet, 0.0, atol=1e-12)
    np.testing.assert_allclose(loads.sum(), 1.0)


def test_wrong_input_is_named(robot: LeggedRobot) -> None:
    with pytest.raises(BadInputError, match='loads'):
        LeggedMotion(robot, 'guessed')
    motion = LeggedMotion(robot)
    with pytest.raises(BadInputError, match='angles'):
        motion.body_velocity(np.zeros(4), np.zeros(4))
    flying = np.zeros(24)
    flying[np.array(robot.joint_axes) == 'lift'] = 0.3
    with pytest.raises(BadInputError, match='all feet up'):
        motion.body_velocity(flying, np.ones(24))
