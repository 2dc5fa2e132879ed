"""What `omega_turn worm` prints."""

from __future__ import annotations

import math
from collections.abc import Sequence

from omega_turn_lab.studies.rows import FILE_WIDTH
from omega_turn_lab.worm.findings import Finding, GaitResult, remarks
from omega_turn_ros.worm.analysis import WormAnalysis
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.turns import Turn


def print_findings(
    trials: Sequence[Kymograph],
    turns: Sequence[Sequence[Turn]],
    found: WormAnalysis,
    rows: Sequence[Finding],
    gaits: Sequence[GaitResult],
) -> None:
    """Print recordings, ours beside the paper's, what to beware of, and gaits."""
    from rich.console import Console
    from rich.table import Table

    for trial, own in zip(trials, turns):
        print(_recording_line(trial, own))
    table = Table(title='Waves of the worm', title_justify='left', box=None, pad_edge=False)
    table.add_column('case')
    table.add_column('quantity')
    table.add_column('ours', justify='right')
    table.add_column('paper', justify='right')
    for row in rows:
        ours = f'{row.measured:.3f}' + ('' if row.std is None else f' ± {row.std:.3f}')
        table.add_row(row.case, row.quantity, ours, '' if row.paper is None else f'{row.paper:g}')
    console = Console()
    Console(width=None if console.is_terminal else FILE_WIDTH).print(table)
    for line in (*remarks(found), *(_gait_line(result) for result in gaits)):
        print(line)


def _recording_line(trial: Kymograph, turns: Sequence[Turn]) -> str:
    last = trial.first + trial.n_frames - 1
    line = f'{trial.name}: frames {trial.first} to {last}, {trial.n_positions} body positions'
    if trial.filled:
        line += f', {len(trial.filled)} frames interpolated'
    for turn in turns:
        line += (
            f'\n  turn in frames {turn.start} to {turn.stop - 1}, bent by '
            f'{math.degrees(turn.bend):+.0f} deg in frame {turn.peak}'
        )
    return line


def _gait_line(result: GaitResult) -> str:
    made, entry = result.made, result.made.entry
    line = f'{entry.name}: {math.degrees(entry.calibration.largest_angle):.1f} deg per cycle'
    if result.played is not None:
        line += f', in PyBullet {math.degrees(result.played):.1f}'
    return (
        f'{line}, largest joint angle {math.degrees(entry.theta_max):.1f} deg\n'
        f'  frames {made.cycle.start} to {made.cycle.stop - 1} of the worm, {made.factor:.2f} '
        f'times as bent; as bent as the worm it would turn by '
        f'{math.degrees(made.unscaled):.1f} deg\n'
        f'  written to {result.path}'
    )
