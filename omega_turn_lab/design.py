"""`omega_turn design`: design gaits for a robot, calibrate them, write them as YAML."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import yaml
from tqdm import tqdm

from omega_turn_lab.folder import make_folder
from omega_turn_ros.design.catalogue import Recipe, design_recipe
from omega_turn_ros.design.legged import LeggedDesign, LeggedRecipe, design_legged
from omega_turn_ros.design.problem import Design
from omega_turn_ros.design.sidewinding import (
    SidewindingDesign,
    SidewindingRecipe,
    design_sidewinding,
)
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import LibraryGait, gait_to_mapping
from omega_turn_ros.robot import LeggedRobot, Robot


def run_design(
    robot: Robot,
    recipes: Sequence[Recipe | SidewindingRecipe | LeggedRecipe],
    seed: int,
    out: Path,
) -> int:
    """Write one file per recipe into `out`; return 0.

    Raises:
        BadInputError: a recipe is out of the robot's range, or the folder cannot be written to.
    """
    make_folder(out)
    lines, entries = [], []
    for recipe in tqdm(recipes, desc='designing', unit='gait'):
        design: Design | SidewindingDesign | LeggedDesign
        if isinstance(recipe, SidewindingRecipe):
            design, entry = design_sidewinding(recipe, robot)
        elif isinstance(robot, LeggedRobot):
            if not isinstance(recipe, LeggedRecipe):
                raise BadInputError('robot', robot.name, 'one without legs; with legs, use --all')
            design, entry = design_legged(recipe, robot)
        elif isinstance(recipe, LeggedRecipe):
            raise BadInputError('robot', robot.name, 'a robot with legs')
        else:
            design, entry = design_recipe(recipe, robot, seed)
        text = yaml.safe_dump(
            gait_to_mapping(entry), sort_keys=False, default_flow_style=None, width=96
        )
        path = out / f'{recipe.name}.yaml'
        path.write_text(text)
        lines.append(_account(design, entry, path))
        entries.append(entry)
    print('\n'.join(lines))
    if len(entries) > 1:
        most = max(entries, key=lambda entry: entry.calibration.largest_angle)
        fastest = max(entries, key=_speed)
        print(f'most turn per cycle: {most.name}; per second at equal joint speed: {fastest.name}')
    return 0


def _speed(entry: LibraryGait) -> float:
    """Heading per peak joint travel [rad/rad], as `turning_speed`."""
    return entry.calibration.largest_angle / (2.0 * math.pi * entry.calibration.peak_rate)


def _account(
    design: Design | SidewindingDesign | LeggedDesign, entry: LibraryGait, path: Path
) -> str:
    parameters = ', '.join(f'{k} {_short(v)}' for k, v in entry.gait.to_mapping().items())
    search = f'{design.evaluations} cycles integrated'
    if isinstance(design, Design):
        search = (
            f'{design.method}: {design.starts} starts, the last searches came to '
            f'{" ".join(f"{top:.4g}" for top in design.tops)}; {search}, stopped by '
            f'{design.reason}'
        )
    return (
        f'{entry.name}: {math.degrees(design.angle):.1f} deg per cycle, largest joint angle '
        f'{math.degrees(entry.theta_max):.1f} deg, clears itself by {1e3 * design.clearance:.1f} '
        f'mm\n  {parameters}\n  {search}\n  written to {path}'
    )


def _short(value: float | list[float]) -> str:
    if isinstance(value, list):
        return '[' + ' '.join(f'{v:.3f}' for v in value) + ']'
    return f'{value:.4g}'
