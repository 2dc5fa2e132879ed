"""Looks at a physics scene through PyBullet itself, past the code under test."""

from __future__ import annotations

import numpy as np
import pybullet

from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import Observation

PERIOD = 10.0  # [s] of a cycle, as in the paper
READINGS_PER_SECOND = 50


def body_centres(simulation: Simulation) -> np.ndarray:
    """Centre of mass of every body, head first [m], shape (n_joints + 1, 3)."""
    body, client = simulation.body, simulation.client
    head, _ = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    others = [
        pybullet.getLinkState(body, joint, physicsClientId=client)[0]
        for joint in range(simulation.robot.n_joints)
    ]
    return np.array([head, *others])


def body_yaws(simulation: Simulation) -> np.ndarray:
    """Yaw angle of every body, head first [rad], shape (n_joints + 1,)."""
    body, client = simulation.body, simulation.client
    _, head = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    others = [
        pybullet.getLinkState(body, joint, physicsClientId=client)[1]
        for joint in range(simulation.robot.n_joints)
    ]
    return np.array([pybullet.getEulerFromQuaternion(q)[2] for q in (head, *others)])


def joint_positions(simulation: Simulation) -> np.ndarray:
    """Where the joints are [m], shape (n_joints, 3)."""
    states = [
        pybullet.getLinkState(simulation.body, joint, physicsClientId=simulation.client)
        for joint in range(simulation.robot.n_joints)
    ]
    return np.array([state[4] for state in states])


def normal_forces(simulation: Simulation) -> np.ndarray:
    """Forces of the ground on the feet [N], shape (contacts,)."""
    contacts = pybullet.getContactPoints(
        simulation.body, simulation.terrain_bodies[0], physicsClientId=simulation.client
    )
    return np.array([contact[9] for contact in contacts])


def fix_head(simulation: Simulation) -> None:
    """Weld the head to the world where it is."""
    position, turn = pybullet.getBasePositionAndOrientation(
        simulation.body, physicsClientId=simulation.client
    )
    weld = pybullet.createConstraint(
        simulation.body,
        -1,
        -1,
        -1,
        pybullet.JOINT_FIXED,
        (0, 0, 0),
        (0, 0, 0),
        position,
        (0, 0, 0, 1),
        turn,
        physicsClientId=simulation.client,
    )
    pybullet.changeConstraint(weld, maxForce=1e6, physicsClientId=simulation.client)


def push(simulation: Simulation, link: int, force: tuple[float, float, float]) -> None:
    """Push a link at its centre of mass during the coming step [N, world axes]."""
    at = body_centres(simulation)[link + 1]
    pybullet.applyExternalForce(
        simulation.body,
        link,
        force,
        at,
        pybullet.WORLD_FRAME,
        physicsClientId=simulation.client,
    )


def bend_into_cycle(simulation: Simulation, gait: LibraryGait) -> None:
    """From straight to the start of the gait's cycle in a second, then let it settle."""
    start = yaw_posture(simulation, gait, 0.0)
    for k in range(1, 51):
        simulation.command(start * k / 50)
        simulation.step(4)
    simulation.step(60)


def play_cycle(simulation: Simulation, gait: LibraryGait, part: float = 1.0) -> list[Observation]:
    """Play a part of one cycle at constant rate, an observation after each command."""
    steps_per_reading = round(1.0 / (READINGS_PER_SECOND * simulation.config.time_step))
    readings = round(PERIOD * READINGS_PER_SECOND)
    seen = []
    for k in range(1, round(part * readings) + 1):
        simulation.command(yaw_posture(simulation, gait, 2.0 * np.pi * k / readings))
        simulation.step(steps_per_reading)
        seen.append(simulation.observe())
    return seen


def yaw_posture(simulation: Simulation, gait: LibraryGait, turned: float) -> np.ndarray:
    """Joint angles of the gait so far into its cycle [rad], pitch joints straight."""
    robot = simulation.robot
    posture = np.zeros(robot.n_joints)
    phase = gait.calibration.start_phase + turned
    posture[robot.yaw_indices] = gait.gait.angles(phase, robot.n_yaw)
    return posture
