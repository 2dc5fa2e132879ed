"""One bridge step beside bare stepSimulation of the same scene, and the real-time factor."""

from __future__ import annotations

import math
import time

from processes import Processes, megabytes, wait_for  # isort: skip  (prepares ROS)
import numpy as np
import pybullet
import rclpy
from rclpy.context import Context
from rosgraph_msgs.msg import Clock

from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.nodes.time import nanoseconds_of
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.terrain_config import load_terrain

DOMAIN = 87
READINGS = 1000
STEPS = 2  # solver steps per reading


def command_at(gait, robot, k: int) -> np.ndarray:
    posture = np.zeros(robot.n_joints)
    phase = gait.calibration.start_phase + 2.0 * math.pi * k / READINGS
    posture[robot.yaw_indices] = gait.gait.angles(phase, robot.n_yaw)
    return posture


def measure_steps(terrain: str) -> None:
    """Alternate both kinds of step on the same moving robot, so both see the same contacts."""
    robot, gait = load_robot('limbless16'), load_gait('omega')
    bare, ours = 0.0, 0.0
    config = SimulationConfig(terrain=load_terrain(terrain))
    with Simulation(robot, config) as simulation:
        for k in range(READINGS):
            simulation.command(command_at(gait, robot, k))
            if k % 2:
                start = time.perf_counter()
                for _ in range(STEPS):
                    pybullet.stepSimulation(physicsClientId=simulation.client)
                bare += time.perf_counter() - start
            else:
                start = time.perf_counter()
                simulation.step(STEPS)
                simulation.observe()
                ours += time.perf_counter() - start
        simulated = READINGS / 2 * STEPS * simulation.config.time_step
    half = READINGS / 2
    print(
        f'{terrain:9} {1e6 * bare / half:7.0f} us bare, {1e6 * ours / half:7.0f} us with commands '
        f'and observation: {ours / bare:.2f} x bare, {simulated / ours:.1f} x real time'
    )


def measure_factor(seconds: float = 10.0) -> None:
    context = Context()
    rclpy.init(context=context, domain_id=DOMAIN)
    node = rclpy.create_node('watch', context=context)
    executor = rclpy.executors.SingleThreadedExecutor(context=context)
    executor.add_node(node)
    clock: list[int] = []
    node.create_subscription(Clock, '/clock', lambda m: clock.append(nanoseconds_of(m.clock)), 1)
    with Processes(DOMAIN) as processes:
        bridge = processes.node('pybullet_bridge', real_time_factor=0.0)
        spin = lambda: executor.spin_once(timeout_sec=0.1)  # noqa: E731
        wait_for(lambda: len(clock) > 5, 60, '/clock', spin)
        start, first = time.monotonic(), clock[-1]
        while time.monotonic() - start < seconds:
            # Look now and then only: the watcher must not take the core from the bridge.
            time.sleep(0.5)
            spin()
        factor = (clock[-1] - first) * 1e-9 / (time.monotonic() - start)
        print(f'bridge alone, real_time_factor 0: {factor:.1f} x real time')
        print(f'resident memory of the bridge: {megabytes(bridge):.0f} MB')
    node.destroy_node()
    context.try_shutdown()


if __name__ == '__main__':
    print(f'one reading of {STEPS} solver steps, omega gait playing, by terrain:')
    for name in ('flat', 'granular', 'pegboard', 'rocks'):
        measure_steps(name)
    measure_factor()
