"""Known pushes, and the physics against the quasi-static model it stands in for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scene import (
    PERIOD,
    READINGS_PER_SECOND,
    bend_into_cycle,
    body_centres,
    fix_head,
    joint_positions,
    play_cycle,
    push,
)

from omega_turn_ros.compliance.external_torque import (
    TorqueConfig,
    external_torque_step,
    needed_torques,
)
from omega_turn_ros.gaits.library import LibraryGait, load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import Observation, SimulationConfig


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='module')
def omega() -> LibraryGait:
    return load_gait('omega')


@dataclass(frozen=True)
class Held:
    """Yaw joints of a robot with its head welded down that holds against a push on its tail."""

    efforts: np.ndarray  # [N m]
    levers: np.ndarray  # of the push about each joint [m]
    positions: np.ndarray  # [rad]


def hold_against(robot: Robot, force: float) -> Held:
    """Push the tail sideways [N, + = the way that positive joint angles take it]."""
    with Simulation(robot, SimulationConfig(friction=0.0)) as simulation:
        simulation.step(100)
        fix_head(simulation)
        efforts = []
        for k in range(300):
            # The tail lies at -x, so turning counter-clockwise takes it towards -y.
            push(simulation, robot.n_joints - 1, (0.0, -force, 0.0))
            simulation.step()
            if k >= 200:
                efforts.append(simulation.observe().efforts)
        levers = joint_positions(simulation)[:, 0] - body_centres(simulation)[-1, 0]
        positions = simulation.observe().positions
    yaw = robot.yaw_indices
    return Held(np.mean(efforts, axis=0)[yaw], levers[yaw], positions[yaw])


@pytest.mark.parametrize('force', [1.0, -0.6])
def test_held_joints_answer_a_known_push_with_force_times_lever(
    robot: Robot, force: float
) -> None:
    held = hold_against(robot, force)
    assert np.abs(held.positions).max() < 0.01  # held indeed
    # A motor answers a push towards positive angles with a negative effort.
    np.testing.assert_allclose(held.efforts, -force * held.levers, rtol=0.02)
    still = np.zeros(robot.n_yaw)
    _, external = external_torque_step(
        still,
        held.efforts,
        needed_torques(PlanarChain.of_robot(robot), still, still, 0.5),
        1.0,
        TorqueConfig(effort_sign=robot.effort_sign, filter_time=0.0, dead_band=0.0),
    )
    np.testing.assert_allclose(external, force * held.levers, rtol=0.02)
    assert (np.sign(external) == np.sign(force)).all()


@dataclass(frozen=True)
class Cycle:
    """One omega cycle of 10 s on level ground."""

    start: Observation
    seen: list[Observation]

    def yaw(self, field: str, robot: Robot) -> np.ndarray:
        return np.array([getattr(s, field)[robot.yaw_indices] for s in self.seen])


@pytest.fixture(scope='module')
def cycle(robot: Robot, omega: LibraryGait) -> Cycle:
    with Simulation(robot) as simulation:
        bend_into_cycle(simulation, omega)
        return Cycle(simulation.observe(), play_cycle(simulation, omega))


def low_passed(rows: np.ndarray, over: int = 10) -> np.ndarray:
    """Mean over the last readings of 20 ms each."""
    sums = np.cumsum(np.vstack([np.zeros(rows.shape[1]), rows]), axis=0)
    return (sums[over:] - sums[:-over]) / over


@pytest.mark.slow
def test_omega_turn_turns_as_far_in_the_physics_as_in_the_model(
    cycle: Cycle, omega: LibraryGait
) -> None:
    turned = cycle.seen[-1].pose[2] - cycle.start.pose[2]
    assert turned == pytest.approx(omega.calibration.largest_angle, rel=0.05)


@pytest.mark.slow
def test_heading_follows_the_model_all_through_the_cycle(cycle: Cycle, omega: LibraryGait) -> None:
    readings = len(cycle.seen)
    model = [
        omega.calibration.heading_at(1.0, 2.0 * math.pi * k / readings)
        for k in range(1, readings + 1)
    ]
    physics = np.array([s.pose[2] for s in cycle.seen]) - cycle.start.pose[2]
    assert np.abs(physics - model).max() < 0.1 * omega.calibration.largest_angle


@pytest.mark.slow
def test_joints_follow_the_gait_late_by_the_servo_s_lag(
    cycle: Cycle, omega: LibraryGait, robot: Robot
) -> None:
    servo_lag = 2.0 / (2.0 * math.pi * SimulationConfig().servo_frequency)
    head_start = 0.5 / READINGS_PER_SECOND  # each command is the posture at the end of its stair
    times = np.arange(1, len(cycle.seen) + 1) / READINGS_PER_SECOND - servo_lag + head_start
    phases = omega.calibration.start_phase + 2.0 * np.pi * times / PERIOD
    wanted = omega.gait.angles(phases, robot.n_yaw)
    assert np.abs(cycle.yaw('positions', robot) - wanted).max() < math.radians(1.0)


@pytest.mark.slow
def test_efforts_on_open_ground_are_those_the_force_balance_asks_for(
    cycle: Cycle, robot: Robot
) -> None:
    chain = PlanarChain.of_robot(robot)
    angles, rates = cycle.yaw('positions', robot), cycle.yaw('velocities', robot)
    needed = np.array([needed_torques(chain, a, r, 0.5) for a, r in zip(angles, rates)])
    predicted, measured = low_passed(needed), low_passed(cycle.yaw('efforts', robot))
    assert np.corrcoef(predicted.ravel(), measured.ravel())[0, 1] > 0.98
    slope = (predicted * measured).sum() / (predicted**2).sum()
    assert slope == pytest.approx(1.0, abs=0.05)
    # What is left would count as external torque: far below what the gait itself takes.
    assert (measured - predicted).std() < 0.2 * measured.std()


@pytest.mark.slow
def test_mirrored_gait_turns_by_the_negated_angle(
    cycle: Cycle, robot: Robot, omega: LibraryGait
) -> None:
    """Half a cycle will do. The feet stand 5 mm off the axis, which is worth 2 deg per cycle."""
    mirrored = LibraryGait(
        'mirrored',
        '',
        omega.robot,
        omega.theta_max,
        omega.gait.mirrored(),
        omega.calibration,
    )
    with Simulation(robot) as simulation:
        bend_into_cycle(simulation, mirrored)
        start = simulation.observe().pose[2]
        seen = play_cycle(simulation, mirrored, part=0.5)
    there = cycle.seen[len(seen) - 1].pose[2] - cycle.start.pose[2]
    assert seen[-1].pose[2] - start == pytest.approx(-there, abs=math.radians(1.5))
