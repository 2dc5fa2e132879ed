"""Feet under a bent robot: who carries what, and where the friction under them takes it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from omega_turn_ros.errors import BadInputError, ConvergenceError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.sidewinding import Sidewinding
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import solve_balance
from omega_turn_ros.mechanics.resting_chain import FOOT_STIFFNESS, RestingChain
from omega_turn_ros.mechanics.resting_motion import (
    lie_down_heading,
    resting_heading_along,
    resting_pose_along,
)
from omega_turn_ros.mechanics.trajectory import heading_along, straight_path
from omega_turn_ros.robot import Robot, load_robot


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='module')
def lifted(robot: Robot) -> RestingChain:
    return RestingChain(robot)


@pytest.fixture(scope='module')
def postures(robot: Robot) -> np.ndarray:
    """Sidewinding of many kinds."""
    rng = np.random.default_rng(3)
    return np.array(
        [
            Sidewinding(rng.uniform(0.9, 1.5), 0.9, rng.uniform(0.05, 0.2), rng.uniform(1.0, 1.5))
            .on(robot)
            .at(rng.uniform(0.0, 6.0), rng.uniform(-1.0, 1.0), (0.0, 0.0))
            for _ in range(20)
        ]
    )


def slow_feet(robot: Robot, angles: np.ndarray, tilt: np.ndarray) -> np.ndarray:
    """Feet about the centre of mass, body by body, tilted by roll and pitch [m], (P, 3)."""
    turn, joint = Rotation.identity(), np.zeros(3)
    feet, centres = [], []
    spans = [robot.head_length, *[robot.module_length] * robot.n_joints]
    for body, span in enumerate(spans):
        if body:
            joint = joint - turn.apply([spans[body - 1], 0, 0]) if body > 1 else joint
            axis = [0, 0, 1] if robot.joint_axes[body - 1] == 'yaw' else [0, 1, 0]
            turn = turn * Rotation.from_rotvec(np.multiply(axis, angles[body - 1]))
        start = 0.0 if body == 0 else -span
        centres.append(joint + turn.apply([start + span / 2, 0, 0]))
        for k in range(round(span / robot.module_length)):
            hand = 1.0 if (max(body - 1, 0) + k) % 2 == 0 else -1.0
            for end in (1, -1):
                x = start + (k + 0.5) * 0.07 + end * 0.07 / (2 * math.sqrt(3))
                feet.append(joint + turn.apply([x, end * hand * 0.005, -0.026]))
    mass = np.array(spans) / sum(spans)
    level = Rotation.from_euler('xy', tilt)
    return level.apply(np.array(feet) - mass @ np.array(centres))


def test_loads_carry_the_weight_and_nothing_tips(
    robot: Robot, lifted: RestingChain, postures: np.ndarray
) -> None:
    state = lifted.state(postures)
    assert (state.loads >= 0.0).all()
    np.testing.assert_allclose(state.loads.sum(axis=1), robot.weight, rtol=1e-5)
    # The frame's origin is the centre of mass: the load's torque about it vanishes.
    torque = np.einsum('bp,bpx->bx', state.loads, state.feet[..., :2])
    assert np.abs(torque).max() < 1e-5 * robot.weight * robot.length
    assert ((state.feet[..., 2] < 0.0) == (state.loads > 0.0)).all()
    assert (state.loads > 0.0).sum(axis=1).max() < 0.7 * state.loads.shape[1]  # most are lifted


def test_a_flat_robot_stands_on_all_feet_alike(robot: Robot, lifted: RestingChain) -> None:
    flat = np.zeros((2, 16))
    flat[1, ::2] = np.linspace(-1.0, 1.0, 8)
    loads = lifted.state(flat).loads
    assert loads.min() == pytest.approx(loads.max(), rel=1e-4)


@pytest.mark.parametrize('k', range(4))
def test_no_tilt_and_height_have_less_energy(
    robot: Robot, lifted: RestingChain, postures: np.ndarray, k: int
) -> None:
    def energy(x: np.ndarray) -> float:
        z = slow_feet(robot, postures[k], x[:2])[:, 2] + x[2]
        return robot.weight * x[2] + 0.5 * FOOT_STIFFNESS * (np.minimum(z, 0.0) ** 2).sum()

    start = np.array([0.0, 0.0, -slow_feet(robot, postures[k], np.zeros(2))[:, 2].min()])
    best = minimize(energy, start, method='Nelder-Mead', options={'xatol': 1e-9, 'fatol': 1e-13})
    state = lifted.state(postures[k : k + 1])
    slow = slow_feet(robot, postures[k], best.x[:2])[:, 2] + best.x[2]
    np.testing.assert_allclose(state.feet[0, :, 2], slow, rtol=0, atol=2e-5)


def test_a_robot_that_lifts_nothing_turns_as_the_planar_chain(
    robot: Robot, lifted: RestingChain
) -> None:
    path = np.zeros((91, 16))
    omega = load_gait('omega_60').gait
    path[:, ::2] = omega.angles(np.linspace(0.0, 2.0 * np.pi, 91), 8)
    planar = heading_along(PlanarChain.of_robot(robot), path[:, ::2])
    assert abs(planar[-1]) > math.radians(3.0)
    np.testing.assert_allclose(
        resting_heading_along(lifted, path), planar, rtol=0, atol=math.radians(1.0)
    )


def test_straight_sidewinding_moves_sideways_by_most_of_the_body_s_excess(
    robot: Robot, lifted: RestingChain
) -> None:
    phases = np.linspace(0.0, 2.0 * np.pi, 91)
    played = Sidewinding(1.0, 0.87, 0.16, 1.4).on(robot)
    x, y, heading = resting_pose_along(lifted, played.cycle(phases, 0.0))[-1]
    assert math.hypot(x, y) > 0.3 * robot.length
    assert abs(heading) < math.radians(5.0)


def test_lying_down_costs_what_rising_returns(
    robot: Robot, lifted: RestingChain, postures: np.ndarray
) -> None:
    rising = resting_heading_along(lifted, straight_path(np.zeros(16), postures[0]))[-1]
    assert lie_down_heading(lifted, postures[0]) == pytest.approx(-rising, abs=1e-6)
    assert lie_down_heading(lifted, np.zeros(16)) == 0.0


def test_weights_of_each_shape_count_as_if_it_were_alone() -> None:
    rng = np.random.default_rng(1)
    points, velocities = rng.normal(size=(2, 6, 20, 2))
    weights = rng.uniform(0.0, 1.0, (6, 20))
    together = solve_balance(points, velocities, weights)
    for k in range(6):
        alone = solve_balance(points[k : k + 1], velocities[k : k + 1], weights[k])
        np.testing.assert_allclose(together[k], alone[0], rtol=0, atol=1e-7)


@pytest.mark.parametrize(
    ('angles', 'named'),
    [
        (np.zeros(16), 'shape'),
        (np.zeros((2, 8)), 'shape'),
        (np.full((1, 16), math.nan), 'finite'),
    ],
)
def test_angles_without_meaning_are_refused(
    lifted: RestingChain, angles: np.ndarray, named: str
) -> None:
    with pytest.raises(BadInputError, match=rf'^angles: .*{named}'):
        lifted.state(angles)


def test_a_path_of_one_posture_is_refused(lifted: RestingChain) -> None:
    with pytest.raises(BadInputError, match=r'^path: '):
        resting_pose_along(lifted, np.zeros((1, 16)))


def test_a_robot_that_rolls_over_is_no_resting_one(robot: Robot, lifted: RestingChain) -> None:
    narrow = Sidewinding(1.5, 0.2, 0.2, 1.0).on(robot).at(0.0, 1.0, (0.0, 0.0))
    with pytest.raises(ConvergenceError, match='roll over'):
        lifted.state(narrow[None])
