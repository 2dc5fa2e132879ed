"""The robot with legs: its URDF, and how it stands, walks and turns in PyBullet."""

from __future__ import annotations

import math
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pybullet
import pytest

from omega_turn_lab.legged_trial import LeggedTrial
from omega_turn_ros.design.legged import walking_gait
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.legged import LeggedMotion
from omega_turn_ros.robot import LeggedRobot, load_robot
from omega_turn_sim_bridge.legged import foot_links, legged_urdf
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.stiction import Stiction
from omega_turn_sim_bridge.terrain_config import load_terrain


@pytest.fixture(scope='module')
def robot() -> LeggedRobot:
    robot = load_robot('legged10')
    assert isinstance(robot, LeggedRobot)
    return robot


def loads_of(simulation: Simulation, robot: LeggedRobot) -> np.ndarray:
    """Normal force on each foot [N], shape (10,)."""
    loads = np.zeros(10)
    feet = foot_links(robot)
    for contact in pybullet.getContactPoints(
        simulation.body, simulation.terrain_bodies[0], physicsClientId=simulation.client
    ):
        loads[feet.index(contact[3])] += contact[9]
    return loads


def test_joints_are_the_robot_s_in_its_order(robot: LeggedRobot) -> None:
    tree = ET.fromstring(legged_urdf(robot))
    assert {j.get('name') for j in tree.iter('joint')} == set(robot.joint_names)
    masses = [float(link.find('inertial/mass').get('value')) for link in tree.iter('link')]
    assert sum(masses) * 9.81 == pytest.approx(robot.weight)
    with Simulation(robot) as simulation:
        names = [
            pybullet.getJointInfo(simulation.body, j, physicsClientId=simulation.client)[1]
            for j in range(robot.n_joints)
        ]
    assert [name.decode() for name in names] == list(robot.joint_names)


def test_positive_swing_is_forward_and_positive_lift_up_on_both_sides(robot: LeggedRobot) -> None:
    for axis, direction in (('swing', 0), ('lift', 2)):
        for side in ('left_2', 'right_2'):
            joint = robot.joint_names.index(f'{side}_{axis}')
            foot = robot.joint_names.index(f'{side}_lift')
            posture = np.zeros(robot.n_joints)
            posture[joint] = 0.4
            with Simulation(robot) as simulation:
                places = []
                for _ in range(2):
                    state = pybullet.getLinkState(
                        simulation.body, foot, physicsClientId=simulation.client
                    )
                    places.append(state[0])
                    simulation.command(posture)
                    simulation.step(100)
            assert places[1][direction] - places[0][direction] > 0.01, (side, axis)


def test_it_stands_on_ten_feet_with_the_weight_among_them(robot: LeggedRobot) -> None:
    with Simulation(robot) as simulation:
        simulation.step(300)
        loads = loads_of(simulation, robot)
        seen = simulation.observe()
    assert loads.sum() == pytest.approx(robot.weight, rel=0.01)
    assert (loads > 0.05 * robot.weight).all()
    np.testing.assert_allclose(seen.pose, 0.0, atol=1e-3)


def test_feet_bear_what_a_level_body_puts_on_them(robot: LeggedRobot) -> None:
    gait, phase = walking_gait(), 0.15 * 2.0 * np.pi
    posture = gait.angles(phase)
    with Simulation(robot) as simulation:
        for share in np.linspace(0.0, 1.0, 200):
            simulation.command(share * posture)
            simulation.step(2)
        simulation.step(400)
        loads = loads_of(simulation, robot)
    model = LeggedMotion(robot, 'static').feet.loads(posture) * robot.weight
    np.testing.assert_allclose(loads, model, atol=0.03 * robot.weight)


@pytest.mark.slow
@pytest.mark.parametrize('a_3_deg', [10.0, 20.0])
def test_it_turns_as_far_as_the_model_says(robot: LeggedRobot, a_3_deg: float) -> None:
    """Within 10 %, whichever way the model shares the weight."""
    gait = replace(walking_gait(), a_3=math.radians(a_3_deg))
    played = LeggedTrial(robot, gait, cycles=2).run()
    cycle = gait.angles(np.linspace(0.0, 2.0 * np.pi, 361))
    for loads in ('equal', 'static'):
        model = math.degrees(LeggedMotion(robot, loads).turn(cycle))
        assert played['angle_deg'] == pytest.approx(model, rel=0.1)


@pytest.mark.slow
def test_walking_goes_as_far_as_the_model_says_and_the_printed_path_turns_nowhere(
    robot: LeggedRobot,
) -> None:
    printed = replace(walking_gait(), sigma=0.0, phi_3=0.0)
    played = LeggedTrial(robot, printed, cycles=1).run()
    assert abs(played['angle_deg']) < 1.0
    walking = replace(printed, a_3=0.0)
    path = walking.angles(np.linspace(0.0, 2.0 * np.pi, 361))
    advance = LeggedMotion(robot).pose_along(path)[-1, 0] / robot.length
    walked = LeggedTrial(robot, walking, cycles=1).run()
    assert walked['advance_bl'] == pytest.approx(advance, rel=0.1)
    assert abs(walked['angle_deg']) < 0.5


def test_foot_at_rest_sticks_harder_than_one_that_slides(robot: LeggedRobot) -> None:
    """Push the standing robot with a force between kinetic and static friction."""
    moved = {}
    for static in (0.0, 1.0):
        config = SimulationConfig(friction=0.5, static_friction=static)
        with Simulation(robot, config) as simulation:
            simulation.step(200)
            before = simulation.observe().pose
            for _ in range(200):
                pybullet.applyExternalForce(
                    simulation.body,
                    14,  # the yaw joint's segment in the middle
                    (0.0, 0.7 * robot.weight, 0.0),
                    [*simulation.observe().pose[:2].tolist(), 0.03],
                    pybullet.WORLD_FRAME,
                    physicsClientId=simulation.client,
                )
                simulation.step()
            moved[static] = simulation.observe().pose[1] - before[1]
    assert moved[0.0] > 0.1
    assert moved[1.0] < 0.01


def test_slips_are_the_speeds_of_the_soles(robot: LeggedRobot) -> None:
    with Simulation(robot) as simulation:
        feet = Stiction(simulation.client, simulation.body, robot, (0.5, 1.0))
        pybullet.resetBaseVelocity(
            simulation.body, (0.3, -0.4, 0.0), (0, 0, 0), physicsClientId=simulation.client
        )
        np.testing.assert_allclose(feet.slips(), 0.5, atol=1e-6)
        assert feet.coefficient(0.0) == 1.0
        assert feet.coefficient(0.1) == pytest.approx(0.5)


def test_obstacles_and_carpet_are_refused_where_they_do_not_apply(robot: LeggedRobot) -> None:
    with pytest.raises(BadInputError, match='terrain'):
        Simulation(robot, SimulationConfig(terrain=load_terrain('pegboard')))
    with pytest.raises(BadInputError, match='static_friction'):
        SimulationConfig(friction=0.5, static_friction=0.4)
    with pytest.raises(BadInputError, match='robot with legs'):
        Simulation(load_robot('limbless16'), SimulationConfig(static_friction=0.8))
