"""Angle over k_t for robots of 6, 7 and 8 yaw joints (Sec. IV.G)."""

from __future__ import annotations

from pathlib import Path

from omega_turn_lab.studies.rows import Row
from omega_turn_lab.studies.study import Outcome, Plan, Study, k_grid
from omega_turn_lab.studies.sweeps import angle_rows, angle_series, best_row, draw_angles
from omega_turn_lab.studies.tasks import DesignTask

NAME = 'joints'
COUNTS = (6, 7, 8)


def _family(plan: Plan, n: int) -> list[DesignTask]:
    return [plan.design(k_t, n=n) for k_t in k_grid(1.5)]


def _designs(plan: Plan) -> list[DesignTask]:
    return [task for n in COUNTS for task in _family(plan, n)]


def _rows(outcome: Outcome) -> list[Row]:
    rows = angle_rows(NAME, outcome, _designs(outcome.plan), 'N {N}')
    for n in COUNTS:
        rows.append(best_row(NAME, outcome, _family(outcome.plan, n), f'N {n}, best k_t'))
    return rows


def _draw(outcome: Outcome, out: Path) -> None:
    series = [angle_series(NAME, outcome, _family(outcome.plan, n), f'$N$ = {n}') for n in COUNTS]
    draw_angles(out / f'{NAME}.png', series)


STUDY = Study(NAME, 'Body length: angle by number of yaw joints N', _designs, _rows, _draw)
