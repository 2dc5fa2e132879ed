"""`omega_turn calibrate`: fit and calibrate the starting gaits for a robot, write them as YAML."""

from __future__ import annotations

import math
from pathlib import Path

import yaml
from tqdm import tqdm

from omega_turn_ros.design.calibrate import make_library_gait
from omega_turn_ros.design.starting_gaits import STARTING_GAITS
from omega_turn_ros.gaits.library import gait_to_mapping
from omega_turn_ros.robot import load_robot


def run_calibrate(robot_name: str, out: Path) -> int:
    """Write one file per gait into `out`; return 0."""
    robot = load_robot(robot_name)
    out.mkdir(parents=True, exist_ok=True)
    lines = []
    for name, (description, theta_max, gait) in tqdm(STARTING_GAITS.items(), desc='calibrating'):
        entry = make_library_gait(name, description, gait, robot, theta_max)
        text = yaml.safe_dump(
            gait_to_mapping(entry), sort_keys=False, default_flow_style=None, width=96
        )
        (out / f'{name}.yaml').write_text(text)
        angle = math.degrees(entry.calibration.largest_angle)
        lines.append(f'{name:10s} {angle:6.1f} deg per cycle  {description}')
    print('\n'.join(lines))
    return 0
