"""A pile of rocks at rest, and a robot on it."""

from __future__ import annotations

import math

import numpy as np
import pybullet
import pytest
from scipy.spatial.transform import Rotation

from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.rocks import RockPile, settled_pile
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.terrain_config import TerrainConfig

SIZE, EXTENT = 0.3, 0.55  # [m]
FILL = 0.4
SMALL_PILE = TerrainConfig('rocks', extent_bl=0.6, rock_fill=0.0)


def lying(pile: RockPile) -> list[np.ndarray]:
    """Corners of each rock in the world [m]."""
    return [
        Rotation.from_quat(turn).apply(corners) + place
        for corners, place, turn in zip(pile.corners, pile.positions, pile.orientations)
    ]


def sizes(pile: RockPile) -> np.ndarray:
    """Longest diameter of each rock [m]."""
    return np.array([np.ptp(np.array(corners), axis=0).max() for corners in pile.corners])


@pytest.fixture(scope='module')
def filled() -> RockPile:
    return settled_pile(SIZE, FILL, EXTENT, 3)


def test_rocks_come_first_and_lie_inside_their_pen_on_the_ground(filled: RockPile) -> None:
    large = sizes(filled) > 0.7 * SIZE
    count = int(large.sum())
    assert count >= 6 and large[:count].all()
    corners = np.concatenate(lying(filled))
    assert np.abs(corners[:, :2]).max() < EXTENT + 0.01
    assert corners[:, 2].min() > -0.01


def test_stones_fill_the_gaps_and_overtop_no_median_rock(filled: RockPile) -> None:
    bare = settled_pile(SIZE, 0.0, EXTENT, 3)
    rocks = len(bare.corners)
    assert filled.corners[:rocks] == bare.corners
    np.testing.assert_array_equal(filled.positions[:rocks], bare.positions)
    tops = np.array([corners[:, 2].max() for corners in lying(filled)])
    assert len(tops) > 2 * rocks
    assert tops[rocks:].max() <= np.median(tops[:rocks]) + 0.01
    largest = 1.4 * FILL * SIZE
    assert sizes(filled)[rocks:].max() < largest


def test_pile_follows_its_seed(filled: RockPile) -> None:
    settled_pile.cache_clear()
    assert settled_pile(SIZE, FILL, EXTENT, 3) == filled
    assert settled_pile(SIZE, 0.0, EXTENT, 4) != settled_pile(SIZE, 0.0, EXTENT, 3)


@pytest.fixture(scope='module')
def on_rocks() -> Simulation:
    config = SimulationConfig(terrain=SMALL_PILE, seed=1, pitch_effort_limit=2.0)
    with Simulation(load_robot('limbless16'), config) as simulation:
        yield simulation


def test_robot_comes_to_rest_on_the_rocks(on_rocks: Simulation) -> None:
    seen = on_rocks.observe()
    assert np.linalg.norm(seen.twist) < 0.05
    carrying = {
        contact[2]
        for contact in pybullet.getContactPoints(on_rocks.body, physicsClientId=on_rocks.client)
    }
    assert len(carrying & set(on_rocks.terrain_bodies[1:])) >= 2


@pytest.mark.parametrize('roll', [0.0, 1.0, math.pi])
def test_heading_is_the_same_whichever_side_the_robot_lies_on(
    on_rocks: Simulation, roll: float
) -> None:
    turn = Rotation.from_euler('ZX', (2.0, roll)).as_quat().tolist()
    pybullet.resetBasePositionAndOrientation(
        on_rocks.body, (0.0, 0.0, 1.0), turn, physicsClientId=on_rocks.client
    )
    yaw = np.zeros(on_rocks.robot.n_joints)
    yaw[on_rocks.robot.yaw_indices[3]] = 1.0  # [rad/s]
    for joint, rate in enumerate(yaw):
        pybullet.resetJointState(on_rocks.body, joint, 0.0, rate, physicsClientId=on_rocks.client)
    pybullet.resetBaseVelocity(on_rocks.body, [0] * 3, [0] * 3, physicsClientId=on_rocks.client)
    seen = on_rocks.observe()
    behind = np.arange(17) > on_rocks.robot.yaw_indices[3]
    share = on_rocks.robot.body_masses[behind].sum() / on_rocks.robot.body_masses.sum()
    assert seen.twist[2] == pytest.approx(math.cos(roll) * share, abs=1e-6)
    assert math.remainder(seen.pose[2] - 2.0, math.tau) == pytest.approx(0.0, abs=1e-6)
    assert math.cos(seen.roll - roll) == pytest.approx(1.0, abs=1e-9)
