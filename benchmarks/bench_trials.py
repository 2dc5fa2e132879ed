"""Trials among pegs on one core and on all of them."""

from __future__ import annotations

import time
from dataclasses import replace

import psutil

from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_lab.studies.executor import LocalExecutor
from omega_turn_ros.compliance.controller import ComplianceConfig
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.terrain_config import load_terrain

TRIALS = 16


def main() -> None:
    robot, gait = load_robot('limbless16'), load_gait('omega').gait
    pegs = replace(load_terrain('pegboard'), spacing_bl=0.4)
    trials = [ObstacleTrial(robot, gait, pegs, k, ComplianceConfig()) for k in range(TRIALS)]
    cores = psutil.cpu_count() or 1
    seconds = {}
    for jobs in (1, cores):
        executor = LocalExecutor(jobs)
        # Workers that have started and loaded everything, as in a study of hundreds.
        list(executor.results(trials[:cores]))
        start = time.perf_counter()
        list(executor.results(trials))
        seconds[jobs] = time.perf_counter() - start
        print(f'{TRIALS} trials among pegs, {jobs} process(es): {seconds[jobs]:.1f} s')
    gain = seconds[1] / seconds[cores]
    print(f'{cores} cores: {gain:.2f} x one; 200 trials in {200 / TRIALS * seconds[cores]:.0f} s')


if __name__ == '__main__':
    main()
