"""Grounds with obstacles: where things stand, what they touch, and what they do not."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pybullet
import pytest
from scene import body_centres

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.resources import config_names
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_sim_bridge.peg_lattice import peg_positions
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.terrain_config import KINDS, TerrainConfig, load_terrain

SPACINGS = (0.2, 0.3, 0.6)  # [BL]
FAR_APART = TerrainConfig('pegboard', spacing_bl=2.0, clearance=0.5)


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


def test_every_kind_of_ground_is_shipped_under_its_name() -> None:
    assert set(KINDS) <= set(config_names('terrains'))
    assert all(load_terrain(kind).kind == kind for kind in KINDS)


@pytest.mark.parametrize(
    ('text', 'field'),
    [
        ('kind: swamp', 'terrain kind'),
        ('kind: pegboard\nspacing: 0.3', 'terrain field spacing'),
        ('kind: pegboard\nspacing_bl: 0', 'terrain spacing_bl'),
        ('kind: pegboard\nspacing_bl: wide', 'terrain spacing_bl'),
        ('kind: pegboard\npeg_friction: -0.1', 'terrain peg_friction'),
        ('kind: rocks\nrock_size_bl: .nan', 'terrain rock_size_bl'),
        ('kind: rocks\nrock_fill: 0.05', 'terrain rock_fill'),
        ('kind: rocks\nrock_fill: 1.5', 'terrain rock_fill'),
        ('kind: rocks\nrock_fill: 0\nrock_size_bl: 0.01', 'terrain rock_size_bl'),
        ('kind: rocks\nextent_bl: 0.1', 'terrain rock_size_bl'),
        ('kind: granular\nresistance_ratio: 0.9', 'terrain resistance_ratio'),
        ('kind: granular\nresistance_ratio: loose', 'terrain resistance_ratio'),
        ('kind: rocks\nextent_bl: true', 'terrain extent_bl'),
    ],
)
def test_bad_field_of_a_ground_is_refused_by_name(text: str, field: str, tmp_path: Path) -> None:
    path = tmp_path / 'ground.yaml'
    path.write_text(text)
    with pytest.raises(BadInputError, match=f'^{field}: got'):
        load_terrain(str(path))


def test_what_rocks_need_does_not_bind_other_grounds() -> None:
    assert TerrainConfig('pegboard', extent_bl=10.0).extent_bl == 10.0


@pytest.mark.parametrize('spacing', SPACINGS)
def test_pegs_are_a_hexagonal_lattice_all_around_the_robot(robot: Robot, spacing: float) -> None:
    config = TerrainConfig('pegboard', spacing_bl=spacing)
    pegs = peg_positions(config, robot, 3)
    apart = np.linalg.norm(pegs[:, None] - pegs[None], axis=-1)
    inner = np.hypot(*pegs.T) < 0.8 * robot.length
    nearest = np.sort(apart[inner], axis=1)[:, 1:7]  # six neighbours, all at the spacing
    np.testing.assert_allclose(nearest, spacing * robot.length, rtol=1e-9)
    bearings = np.arctan2(pegs[:, 1], pegs[:, 0])[np.hypot(*pegs.T) > robot.length]
    assert np.histogram(bearings, 6, (-math.pi, math.pi))[0].min() > 0


@pytest.mark.parametrize('spacing', SPACINGS)
def test_no_peg_is_nearer_to_the_straight_robot_than_the_clearance(
    robot: Robot, spacing: float
) -> None:
    config = TerrainConfig('pegboard', spacing_bl=spacing)
    on_axis = np.linspace(-0.5, 0.5, 500)[:, None] * [robot.length, 0.0]
    for seed in range(10):
        pegs = peg_positions(config, robot, seed)
        gap = np.linalg.norm(pegs[:, None] - on_axis[None], axis=-1).min()
        assert gap > 0.5 * robot.module_width + config.peg_radius + config.clearance


def test_placement_follows_its_seed(robot: Robot) -> None:
    config = TerrainConfig('pegboard')
    one, again, other = (peg_positions(config, robot, seed) for seed in (4, 4, 5))
    np.testing.assert_array_equal(one, again)
    assert one.shape != other.shape or not np.allclose(one, other)


def test_robot_that_cannot_fit_is_refused_with_the_reason(robot: Robot) -> None:
    with pytest.raises(BadInputError, match='room for a straight robot'):
        peg_positions(TerrainConfig('pegboard', spacing_bl=0.08), robot, 0)
    with pytest.raises(BadInputError, match='more than a peg diameter'):
        peg_positions(TerrainConfig('pegboard', spacing_bl=0.02), robot, 0)


def bend(simulation: Simulation, angle: float, steps: int = 300) -> None:
    """Command every yaw joint to one angle and wait."""
    posture = np.zeros(simulation.robot.n_joints)
    posture[simulation.robot.yaw_indices] = angle
    simulation.command(posture)
    simulation.step(steps)


def test_pegs_out_of_reach_change_nothing_but_rounding(robot: Robot) -> None:
    """The solid body touches neither level ground nor its own neighbours."""
    poses = []
    for terrain in (TerrainConfig(), FAR_APART):
        with Simulation(robot, SimulationConfig(terrain=terrain, seed=1)) as simulation:
            bend(simulation, 0.3)
            bend(simulation, -0.3)
            poses.append(simulation.observe().pose)
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-6)


def nearest_peg(simulation: Simulation) -> float:
    """Distance from a peg's axis to the nearest body centre [m]."""
    centres = body_centres(simulation)[:, :2]
    pegs = np.array(
        [
            pybullet.getBasePositionAndOrientation(peg, physicsClientId=simulation.client)[0][:2]
            for peg in simulation.terrain_bodies[1:]
        ]
    )
    return float(np.linalg.norm(pegs[:, None] - centres[None], axis=-1).min())


def test_peg_stops_the_body(robot: Robot) -> None:
    terrain = TerrainConfig('pegboard', spacing_bl=0.2)
    with Simulation(robot, SimulationConfig(terrain=terrain, seed=0)) as simulation:
        bend(simulation, 0.7)
        touch = 0.5 * robot.module_width + terrain.peg_radius
        assert touch - 0.005 < nearest_peg(simulation)
        assert 0.0 < simulation.obstacle_depth() < 0.005
        # held off its command by what stands in the way, with all its strength somewhere
        seen = simulation.observe()
        assert np.abs(seen.positions[robot.yaw_indices] - 0.7).max() > 0.2
        assert np.abs(seen.efforts).max() > 0.5 * robot.effort_limit


def test_two_runs_among_pegs_are_the_same_to_the_last_bit(robot: Robot) -> None:
    terrain = TerrainConfig('pegboard', spacing_bl=0.2)
    seen = []
    for _ in range(2):
        with Simulation(robot, SimulationConfig(terrain=terrain, seed=2)) as simulation:
            bend(simulation, 0.5)
            seen.append(asdict(simulation.observe()))
    for name, value in seen[0].items():
        np.testing.assert_array_equal(value, seen[1][name], err_msg=name)
