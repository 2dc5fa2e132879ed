"""The frequency turn in physics against its quasi-static model."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scene import body_centres

from omega_turn_ros.gaits.library import LibraryGait, load_gait
from omega_turn_ros.mechanics.resting_chain import FOOT_STIFFNESS, RestingChain
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import SimulationConfig

READING = 0.01  # [s] between two commands
PERIOD = 8.0  # [s] of a cycle


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='module')
def entry() -> LibraryGait:
    return load_gait('sidewinding')


def play_cycle(robot: Robot, entry: LibraryGait, scale: float) -> tuple[float, float]:
    """Play a cycle from the start shape; return its angle [rad] and the largest height [m]."""
    played, start = entry.gait.on(robot), entry.calibration.start_phase
    with Simulation(robot) as simulation:

        def play(phase: float, share: float = 1.0) -> None:
            simulation.command(share * played.at(phase, scale, (0.0, 0.0)))
            simulation.step(round(READING / simulation.config.time_step))

        for k in range(200):
            play(start, min(1.0, k / 150))
        before, count, highest = simulation.observe().pose[2], round(PERIOD / READING), 0.0
        for k in range(1, count + 1):
            play(start + 2.0 * math.pi * k / count)
            highest = max(highest, body_centres(simulation)[:, 2].max())
        for _ in range(30):
            play(start)
        return simulation.observe().pose[2] - before, highest


@pytest.mark.slow
@pytest.mark.parametrize('scale', [0.7, -0.85, 1.0])
def test_a_cycle_turns_by_the_calibrated_angle_within_a_tenth(
    robot: Robot, entry: LibraryGait, scale: float
) -> None:
    angle, highest = play_cycle(robot, entry, scale)
    assert angle == pytest.approx(entry.calibration.angle_of(scale), rel=0.1)
    assert highest > 0.5 * robot.module_width + 0.02  # the body is lifted by centimetres


@pytest.mark.slow
def test_straight_sidewinding_hardly_turns(robot: Robot, entry: LibraryGait) -> None:
    angle, _ = play_cycle(robot, entry, 0.0)
    assert abs(angle) < math.radians(5.0)


def test_the_model_stands_on_the_simulator_s_feet(robot: Robot) -> None:
    assert SimulationConfig().contact_stiffness == FOOT_STIFFNESS
    chain = RestingChain(robot)
    with Simulation(robot) as simulation:
        import pybullet

        shapes = [
            shape
            for link in range(-1, robot.n_joints)
            for shape in pybullet.getCollisionShapeData(
                simulation.body, link, physicsClientId=simulation.client
            )
        ]
    # PyBullet counts from the centre of mass of a link, the model from the joint before it.
    across = sorted(round(shape[5][1], 6) for shape in shapes)
    np.testing.assert_allclose(across, sorted(chain.state(np.zeros((1, 16))).feet[0, :, 1]))
