"""Angle per cycle of the starting gaits: PyBullet beside the quasi-static model, open loop."""

from __future__ import annotations

import argparse
import math
from dataclasses import replace

import numpy as np
from starting_gaits import STARTING_GAITS

from omega_turn_lab.physics_trial import play_cycle
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.trajectory import heading_along
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.terrain_config import load_terrain


def quasi_static_deg(robot: Robot, gait: TwoWaveGait) -> float:
    path = gait.angles(np.linspace(0.0, 2.0 * np.pi, 721), robot.n_yaw)
    return math.degrees(heading_along(PlanarChain.of_robot(robot), path)[-1])


def physics_deg(robot: Robot, gait: TwoWaveGait, period: float, config: SimulationConfig) -> float:
    return math.degrees(play_cycle(robot, gait, period, config).angle)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--robot', default='limbless16')
    parser.add_argument('--terrain', default='flat', choices=('flat', 'coulomb'))
    options = parser.parse_args()
    robot = load_robot(options.robot)
    base = SimulationConfig(terrain=load_terrain(options.terrain))
    cases = [('', 10.0, base)]
    cases += [(f'mu {mu:g}', 10.0, replace(base, friction=mu)) for mu in (0.2, 0.8)]
    cases += [(f'{period:g} s', period, base) for period in (5.0, 20.0)]
    print('angle per cycle [deg]; PyBullet at mu 0.5 and 10 s unless said')
    header = ['gait', 'theory', 'PyBullet', 'differs', *(name for name, _, _ in cases[1:])]
    print(' '.join(f'{text:>10s}' for text in header))
    for name, (_, _, gait) in STARTING_GAITS.items():
        theory = quasi_static_deg(robot, gait)
        sign = math.copysign(1.0, theory)
        angles = [sign * physics_deg(robot, gait, period, cfg) for _, period, cfg in cases]
        theory = abs(theory)
        cells = [f'{theory:.1f}', f'{angles[0]:.1f}', f'{angles[0] / theory - 1:+.1%}']
        cells += [f'{a:.1f}' for a in angles[1:]]
        print(f'{name:>10s} ' + ' '.join(f'{cell:>10s}' for cell in cells), flush=True)


if __name__ == '__main__':
    main()
