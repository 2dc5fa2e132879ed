"""One gait cycle in PyBullet, open loop, to hold beside the quasi-static model."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.design.calibrate import straightest_phase
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.robot import Robot
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import SimulationConfig

Array = NDArray[np.float64]

READING = 0.01  # [s] between two commands
BEND = 150  # readings to bend from straight to the first shape
SETTLE = 50  # readings to rest in it
WAIT = 100  # readings after the cycle, until the motors have caught up


@dataclass(frozen=True, slots=True)
class PhysicsTrial:
    """What the robot did during one cycle.

    Attributes:
        fraction: of the cycle, 0..1, shape (T,).
        poses: of the mean body frame in the world: x [m], y [m], heading [rad, continuous], shape
            (T, 3).
        yaw_angles: measured [rad], shape (T, N).
        angle: heading change between the shape before the cycle and the same shape after it [rad].
    """

    fraction: Array
    poses: Array
    yaw_angles: Array
    angle: float


def play_cycle(
    robot: Robot,
    gait: WaveGait,
    period: float = 10.0,
    config: SimulationConfig | None = None,
    samples: int = 100,
) -> PhysicsTrial:
    """Bend to the start shape, play one cycle from there, wait.

    The cycle starts where the body is straightest.

    Args:
        robot: the robot.
        gait: what it plays.
        period: of the cycle [s].
        config: physics settings.
        samples: readings kept of the cycle; the first shape comes on top.

    Raises:
        BadInputError: the period is too short for that many samples.
        SimulationError: the physics has left the realm of finite numbers.
    """
    config = config or SimulationConfig()
    readings = round(period / READING)
    if not 1 <= samples <= readings:
        raise BadInputError('samples', samples, f'1..{readings} for a period of {period:g} s')
    start = straightest_phase(gait, robot.n_yaw)
    steps = round(READING / config.time_step)
    kept = set(np.linspace(0, readings, samples + 1).round().astype(int).tolist())
    poses, yaw_angles = [], []
    with Simulation(robot, config) as simulation:

        def play(phase: float, scale: float) -> None:
            posture = np.zeros(robot.n_joints)
            posture[robot.yaw_indices] = gait.angles(phase, robot.n_yaw, scale)
            simulation.command(posture)
            simulation.step(steps)

        for k in range(BEND + SETTLE):
            play(start, min(1.0, k / BEND))
        before = simulation.observe().pose[2]
        for k in range(readings + 1):
            if k > 0:
                play(start + 2.0 * math.pi * k / readings, 1.0)
            if k in kept:
                seen = simulation.observe()
                poses.append(seen.pose)
                yaw_angles.append(seen.positions[robot.yaw_indices])
        for _ in range(WAIT):
            play(start, 1.0)
        angle = float(simulation.observe().pose[2] - before)
    fraction = np.array(sorted(kept)) / readings
    return PhysicsTrial(fraction, np.array(poses), np.array(yaw_angles), angle)
