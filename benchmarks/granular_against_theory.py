"""Angle per cycle on grains: PyBullet beside the quasi-static model, by ratio, time and step."""

from __future__ import annotations

import argparse
import math
import time

import numpy as np
from tqdm import tqdm

from omega_turn_lab.physics_trial import play_cycle
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_laws import GranularResistance
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.terrain_config import TerrainConfig

GAITS = ('omega', 'offset', 'geometric')
RATIOS = (1.0, 1.5, 3.0)
RATIO = 3.0  # of the other columns
# period [s], solver steps per second, resistance lengthways over weight
CHANGES = {
    '5 s': (5.0, 200.0, 0.5),
    '20 s': (20.0, 200.0, 0.5),
    '100 Hz': (10.0, 100.0, 0.5),
    '400 Hz': (10.0, 400.0, 0.5),
    '0.1 W': (10.0, 200.0, 0.1),
}
STEPS = 1000


def quasi_static_deg(robot: Robot, gait: WaveGait, ratio: float) -> float:
    path = gait.angles(np.linspace(0.0, 2.0 * np.pi, 721), robot.n_yaw)
    motion = QuasiStatic(PlanarChain.of_robot(robot), GranularResistance.of_ratio(ratio))
    return math.degrees(motion.turn(path))


def largest_torque(robot: Robot, gait: WaveGait, ratio: float, friction: float) -> float:
    """Largest torque any motor needs in the quasi-static model [N m]."""
    path = gait.angles(np.linspace(0.0, 2.0 * np.pi, 721), robot.n_yaw)
    step = np.diff(path, axis=0)
    motion = QuasiStatic(PlanarChain.of_robot(robot), GranularResistance.of_ratio(ratio))
    return float(np.abs(motion.joint_torques(path[:-1] + 0.5 * step, step, friction)).max())


def physics_deg(
    robot: Robot, gait: WaveGait, ratio: float, change: tuple[float, float, float]
) -> float:
    period, rate, friction = change
    terrain = TerrainConfig('granular', resistance_ratio=ratio)
    config = SimulationConfig(time_step=1.0 / rate, friction=friction, terrain=terrain)
    return math.degrees(play_cycle(robot, gait, period, config, 1).angle)


def step_seconds(robot: Robot, kind: str) -> float:
    """CPU time of one solver step with all that goes with it, gait playing [s]."""
    gait = load_gait('omega').gait
    with Simulation(robot, SimulationConfig(terrain=TerrainConfig(kind))) as simulation:
        began = time.process_time()
        for k in range(STEPS):
            posture = np.zeros(robot.n_joints)
            posture[robot.yaw_indices] = gait.angles(2.0 * np.pi * k / STEPS, robot.n_yaw)
            simulation.command(posture)
            simulation.step(2)
        return (time.process_time() - began) / (2 * STEPS)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--robot', default='limbless16')
    robot = load_robot(parser.parse_args().robot)
    nominal = (10.0, 200.0, 0.5)
    bar = tqdm(total=len(GAITS) * (len(RATIOS) + len(CHANGES)), unit='trial')
    lines = []
    for name in GAITS:
        gait = load_gait(name).gait
        cells = []
        for ratio in RATIOS:
            theory = quasi_static_deg(robot, gait, ratio)
            cells.append(f'{theory:.1f} {physics_deg(robot, gait, ratio, nominal):.1f}')
            bar.update()
        for change in CHANGES.values():
            cells.append(f'{physics_deg(robot, gait, RATIO, change):.1f}')
            bar.update()
        lines.append(f'{name:>10s} ' + ' '.join(f'{cell:>10s}' for cell in cells))
    bar.close()
    print(f'degrees per cycle, theory and PyBullet by ratio; changes at ratio {RATIO:g}')
    header = [*(f'ratio {ratio:g}' for ratio in RATIOS), *CHANGES]
    print(' ' * 11 + ' '.join(f'{text:>10s}' for text in header), *lines, sep='\n')
    for name in GAITS:
        needed = largest_torque(robot, load_gait(name).gait, 1.5, 1.0)
        print(f'{name}: largest torque {needed:.2f} N m at ratio 1.5, resistance of the weight')
    flat, grains = step_seconds(robot, 'flat'), step_seconds(robot, 'granular')
    print(f'CPU of a step on grains over one on level ground: {grains / flat:.2f}')


if __name__ == '__main__':
    main()
