"""Grains under the robot: the force law, the time step, and the quasi-static model."""

from __future__ import annotations

import math
from dataclasses import asdict

import numpy as np
import pybullet
import pytest

from omega_turn_lab.physics_trial import play_cycle
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_laws import GranularResistance
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.robot import STANDARD_GRAVITY, Robot, load_robot
from omega_turn_sim_bridge.granular import GranularGround
from omega_turn_sim_bridge.robot import REFLECTED_INERTIA
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.terrain_config import TerrainConfig, load_terrain

LAW = GranularResistance.of_ratio(3.0)
GRAINS = TerrainConfig('granular', resistance_ratio=3.0)
FRICTION = 0.5
PERIOD = 10.0  # [s] of a cycle, as in the paper


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


def links(robot: Robot, seed: int) -> tuple[np.ndarray, np.ndarray, complex]:
    """Angles [rad] and rates [rad/s] of the links of some moving body, velocity of its head."""
    rng = np.random.default_rng(seed)
    angles = np.cumsum(rng.normal(0.0, 0.5, robot.n_yaw + 1))
    rates = np.cumsum(rng.normal(0.0, 0.3, robot.n_yaw + 1))
    return angles, rates, complex(*rng.normal(0.0, 0.1, 2))


def middles(robot: Robot, angles: np.ndarray) -> np.ndarray:
    """Middles of the links, the head's at the origin [m], shape (L, 2)."""
    axes = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    places, end = [], 0.5 * robot.head_length * axes[0]
    for length, axis in zip(robot.planar_link_lengths, axes):
        places.append(end - 0.5 * length * axis)
        end = end - length * axis
    return np.array(places)


def slips(
    robot: Robot, angles: np.ndarray, rates: np.ndarray, velocity: complex
) -> list[np.ndarray]:
    """Velocities of each link's middle by finite differences [m/s], shape (L, 2)."""
    step = 1e-6
    moved = middles(robot, angles + step * rates) - middles(robot, angles - step * rates)
    head = np.array([velocity.real, velocity.imag])
    return list(moved / (2.0 * step) + head)


def test_links_meet_the_force_of_the_law_point_by_point(robot: Robot) -> None:
    """In a step too short for the motion to change."""
    ground = GranularGround(robot, LAW, FRICTION, time_step=1e-9)
    nodes, shares = np.polynomial.legendre.leggauss(4)
    for seed in range(5):
        angles, rates, velocity = links(robot, seed)
        forces, moments = ground.forces(angles, rates, velocity)
        centres = slips(robot, angles, rates, velocity)
        for k, length in enumerate(robot.planar_link_lengths):
            c, s = math.cos(angles[k]), math.sin(angles[k])
            tangential, normal = np.array([[c, s], [-s, c]]) @ centres[k]
            offsets = 0.5 * length * nodes
            along, across = LAW.force(np.full(4, tangential), normal + offsets * rates[k])
            load = 0.5 * FRICTION * robot.weight * length / robot.length * shares
            assert forces[k].real == pytest.approx(load @ along, abs=0.01)
            assert forces[k].imag == pytest.approx(load @ across, abs=0.01)
            assert moments[k] == pytest.approx((load * offsets) @ across, abs=0.001)


@pytest.mark.parametrize('time_step', [1e-4, 1e-2, 1.0])
@pytest.mark.parametrize('friction', [0.5, 50.0])
def test_grains_take_energy_at_any_time_step_and_push_nobody_back(
    robot: Robot, time_step: float, friction: float
) -> None:
    """A body that keeps its shape loses speed and never comes out faster."""
    ground = GranularGround(robot, LAW, friction, time_step)
    masses = robot.module_mass * robot.planar_link_lengths / robot.module_length
    for seed in range(20):
        angles, _, velocity = links(robot, seed)
        turn = float(np.random.default_rng(seed).normal(0.0, 1.0))
        forces, moments = ground.forces(angles, np.full(angles.size, turn), velocity)
        world = forces * np.exp(1j * angles)
        places = middles(robot, angles) @ np.array([1.0, 1j])
        centre = masses @ places / masses.sum()
        arms = places - centre
        inertia = masses @ (
            np.abs(arms) ** 2 + (robot.planar_link_lengths**2 + robot.module_width**2) / 12.0
        ) + REFLECTED_INERTIA * (robot.n_joints + 1)
        before = velocity + 1j * turn * centre, turn
        torque = (arms.conj() * world).imag.sum() + moments.sum()
        after = (
            before[0] + time_step * world.sum() / masses.sum(),
            turn + time_step * torque / inertia,
        )
        energy = [masses.sum() * abs(v) ** 2 + inertia * w**2 for v, w in (before, after)]
        assert energy[1] < energy[0]
        power = (world * np.conj(after[0])).real.sum() + torque * after[1]
        assert power <= 1e-12


@pytest.mark.parametrize(('sideways', 'ratio'), [(1.0, LAW.ratio), (0.0, 1.0)])
def test_coasting_robot_is_slowed_by_the_resistance_until_it_rests(
    robot: Robot, sideways: float, ratio: float
) -> None:
    start = np.array([1.0 - sideways, sideways, 0.0])
    config = SimulationConfig(terrain=GRAINS, friction=FRICTION, time_step=1e-3)
    with Simulation(robot, config) as simulation:
        simulation.step(200)
        pybullet.resetBaseVelocity(
            simulation.body, start.tolist(), (0, 0, 0), physicsClientId=simulation.client
        )
        speeds = []
        for _ in range(600):
            simulation.step()
            speeds.append(float(simulation.observe().twist @ start))
    slowing = FRICTION * ratio * STANDARD_GRAVITY
    assert speeds[30] - speeds[0] == pytest.approx(-30 * 1e-3 * slowing, rel=0.03)
    assert np.diff(speeds).max() < 1e-3 and min(speeds) > -1e-3  # no chatter, never pushed back
    assert abs(speeds[-1]) < 1e-3


def turn_deg(
    robot: Robot,
    name: str,
    period: float = PERIOD,
    rate: float = 200.0,
    friction: float = FRICTION,
    effort_limit: float = 0.0,
) -> float:
    """Angle of one cycle in PyBullet [deg]."""
    config = SimulationConfig(
        terrain=GRAINS, time_step=1.0 / rate, friction=friction, effort_limit=effort_limit
    )
    return math.degrees(play_cycle(robot, load_gait(name).gait, period, config, 1).angle)


def theory_deg(robot: Robot, name: str) -> float:
    path = load_gait(name).gait.angles(np.linspace(0.0, 2.0 * np.pi, 721), robot.n_yaw)
    return math.degrees(QuasiStatic(PlanarChain.of_robot(robot, 8), LAW).turn(path))


@pytest.mark.slow
@pytest.mark.parametrize('name', ['omega', 'offset', 'geometric'])
def test_gaits_turn_as_far_as_the_force_balance_says(robot: Robot, name: str) -> None:
    assert turn_deg(robot, name) == pytest.approx(theory_deg(robot, name), rel=0.03, abs=0.6)


@pytest.mark.slow
def test_the_turn_depends_on_neither_time_step_nor_period(robot: Robot) -> None:
    theory = theory_deg(robot, 'omega')
    for period, rate in ((PERIOD, 100.0), (0.5 * PERIOD, 200.0), (0.5 * PERIOD, 400.0)):
        assert turn_deg(robot, 'omega', period, rate) == pytest.approx(theory, rel=0.05)


@pytest.mark.slow
def test_motors_too_weak_for_the_grains_lose_the_turn_by_the_ratio_of_both(robot: Robot) -> None:
    strong = turn_deg(robot, 'offset', friction=1.0)
    halved = turn_deg(robot, 'offset', friction=0.5, effort_limit=0.5 * robot.effort_limit)
    assert abs(strong) < 0.5 * theory_deg(robot, 'offset')
    assert halved == pytest.approx(strong, abs=2.0)


def test_two_runs_on_grains_are_the_same_to_the_last_bit(robot: Robot) -> None:
    seen = []
    for _ in range(2):
        with Simulation(robot, SimulationConfig(terrain=GRAINS)) as simulation:
            simulation.command(np.full(robot.n_joints, 0.3) * (np.arange(robot.n_joints) % 2 == 0))
            simulation.step(100)
            seen.append(asdict(simulation.observe()))
    for name, value in seen[0].items():
        np.testing.assert_array_equal(value, seen[1][name], err_msg=name)


@pytest.mark.slow
def test_coulomb_ground_turns_a_small_gait_as_far_as_friction_does(robot: Robot) -> None:
    # 0.2 % off; on `flat`, with Bullet's own friction, 7 %.
    gait = load_gait('omega_60').gait
    config = SimulationConfig(terrain=load_terrain('coulomb'))
    path = gait.angles(np.linspace(0.0, 2.0 * np.pi, 721), robot.n_yaw)
    theory = QuasiStatic(PlanarChain.of_robot(robot)).turn(path)
    assert play_cycle(robot, gait, PERIOD, config, 1).angle == pytest.approx(theory, rel=0.03)
