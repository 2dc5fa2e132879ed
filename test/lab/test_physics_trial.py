"""A gait's cycle in PyBullet beside the quasi-static model."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip('pybullet')

from omega_turn_lab.physics_trial import PhysicsTrial, play_cycle
from omega_turn_ros.design.calibrate import straightest_phase
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.robot import Robot, load_robot

OMEGA = load_gait('omega').gait


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='module')
def trial(robot: Robot) -> PhysicsTrial:
    return play_cycle(robot, OMEGA, samples=50)


def test_a_cycle_turns_as_far_as_the_force_balance_says(robot: Robot, trial: PhysicsTrial) -> None:
    start = straightest_phase(OMEGA, robot.n_yaw)
    path = OMEGA.angles(start + 2.0 * np.pi * trial.fraction, robot.n_yaw)
    heading = QuasiStatic(PlanarChain.of_robot(robot, 8)).heading_along(path)
    assert trial.angle == pytest.approx(heading[-1], rel=0.05)
    seen = trial.poses[:, 2] - trial.poses[0, 2]
    assert np.abs(seen - heading).max() < math.radians(8.0)


def test_the_joints_follow_the_gait(robot: Robot, trial: PhysicsTrial) -> None:
    assert trial.fraction == pytest.approx(np.linspace(0.0, 1.0, 51))
    start = straightest_phase(OMEGA, robot.n_yaw)
    path = OMEGA.angles(start + 2.0 * np.pi * trial.fraction, robot.n_yaw)
    lag = 2.0 / (2.0 * math.pi * 5.0)  # [s] of the critically damped servo at 5 Hz
    rate = np.abs(np.gradient(path, 0.2, axis=0)).max()
    assert np.abs(trial.yaw_angles - path).max() < 2.0 * lag * rate


def test_the_mirrored_gait_turns_the_other_way(robot: Robot, trial: PhysicsTrial) -> None:
    mirrored = play_cycle(robot, OMEGA.mirrored(), samples=10)
    assert mirrored.angle == pytest.approx(-trial.angle, rel=0.03)


def test_more_samples_than_readings_are_refused(robot: Robot) -> None:
    with pytest.raises(BadInputError, match='samples'):
        play_cycle(robot, OMEGA, period=0.1, samples=20)
