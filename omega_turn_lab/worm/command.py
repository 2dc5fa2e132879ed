"""`omega_turn worm`: from recordings of worms to waves, figures and a robot's gait."""

from __future__ import annotations

import time
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import yaml
from tqdm import tqdm

from omega_turn_lab.folder import make_folder
from omega_turn_lab.worm.figure import draw_worm
from omega_turn_lab.worm.findings import GaitResult, findings
from omega_turn_lab.worm.options import WormOptions
from omega_turn_lab.worm.record import write_record
from omega_turn_lab.worm.report import print_findings
from omega_turn_ros.errors import BadInputError, MissingPackageError
from omega_turn_ros.gaits.library import LibraryGait, gait_to_mapping
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_ros.worm.analysis import analyse
from omega_turn_ros.worm.components import common_positions
from omega_turn_ros.worm.kymograph import Kymograph, make_kymograph
from omega_turn_ros.worm.table import read_table
from omega_turn_ros.worm.to_gait import worm_gait
from omega_turn_ros.worm.turns import Turn, find_turns


def run_worm(options: WormOptions) -> int:
    """Analyse recordings, print, draw and store what is found; return 0.

    Raises:
        BadInputError: an option or a recording is unusable.
        MissingPackageError: PyBullet is wanted but not installed.
    """
    began = time.perf_counter()
    robot = _checked(options)
    trials = common_positions(read_trials(options))
    turns = [find_turns(trial, options.bend) for trial in trials]
    chosen = _turns_of(trials, turns) if options.turns_only else trials
    found = analyse(chosen, options.components, options.mean_posture, options.seed)
    gaits = _make_gaits(options, trials, robot) if options.to_gait else []
    rows = findings(found)
    seconds = time.perf_counter() - began
    stem = 'worm'
    write_record(options.out / f'{stem}.json', options, trials, turns, found, rows, gaits, seconds)
    draw_worm(options.out / f'{stem}.png', trials, turns, found)
    print_findings(trials, turns, found, rows, gaits)
    print(f'files in {options.out}')
    return 0


def read_trials(options: WormOptions) -> list[Kymograph]:
    """Read and check every recording.

    Raises:
        BadInputError: a file cannot be read, or see `make_kymograph`.
    """
    starts = _one_each('from', options.starts or (0,), len(options.files))
    stops = _one_each('to', options.stops or (None,), len(options.files))
    trials = []
    for path, start, stop in zip(options.files, starts, stops):
        table = read_table(path, options.variable)
        table = table.T if options.transposed else table
        if not 0 <= options.skip_columns < table.shape[1]:
            expected = f'0..{table.shape[1] - 1}, of the {table.shape[1]} columns of {path}'
            raise BadInputError('skip_columns', options.skip_columns, expected)
        table = table[:, options.skip_columns :]
        trials.append(make_kymograph(path.name, table, options.reading, start or 0, stop))
    return trials


def _one_each(field: str, values: Sequence[int | None], count: int) -> Sequence[int | None]:
    if len(values) not in (1, count):
        raise BadInputError(field, values, f'one for all, or one for each of {count} files')
    return list(values) * count if len(values) == 1 else values


def _turns_of(trials: Sequence[Kymograph], turns: Sequence[Sequence[Turn]]) -> list[Kymograph]:
    found = [trial.cut(turn.start, turn.stop) for trial, own in zip(trials, turns) for turn in own]
    if not found:
        expected = 'at least one turn (lower --bend-deg, or cut by hand with --from and --to)'
        raise BadInputError('recordings', 'no turn', expected)
    return found


def _checked(options: WormOptions) -> Robot:
    """Refuse unusable options before any work; return the robot."""
    if options.seed < 0:
        raise BadInputError('seed', options.seed, 'an integer >= 0')
    if options.to_gait and options.pybullet and find_spec('pybullet') is None:
        raise MissingPackageError('pybullet', 'sim', 'go without: --no-pybullet')
    robot = load_robot(options.robot)
    make_folder(options.out)
    return robot


def _make_gaits(
    options: WormOptions, trials: Sequence[Kymograph], robot: Robot
) -> list[GaitResult]:
    """The worm's turn as a gait, played and stored."""
    steps = tqdm(total=1 + options.pybullet, desc='making a gait', unit='step')
    made = worm_gait(trials, robot, options.gait_name, options.harmonics)
    steps.update()
    played = _played(robot, made.entry) if options.pybullet else None
    steps.update(int(options.pybullet))
    steps.close()
    return [GaitResult(made, _write_gait(made.entry, options.out), played)]


def _played(robot: Robot, entry: LibraryGait) -> float:
    """Angle of one cycle in PyBullet [rad]."""
    from omega_turn_lab.physics_trial import play_cycle

    return play_cycle(robot, entry.waves).angle


def _write_gait(entry: LibraryGait, out: Path) -> Path:
    text = yaml.safe_dump(
        gait_to_mapping(entry), sort_keys=False, default_flow_style=None, width=96
    )
    path = out / f'{entry.name}.yaml'
    path.write_text(text, encoding='utf-8')
    return path
