"""Angle over k_t for three forward waves (Sec. IV.F)."""

from __future__ import annotations

from pathlib import Path

from omega_turn_lab.studies.rows import Row
from omega_turn_lab.studies.study import Outcome, Plan, Study, k_grid
from omega_turn_lab.studies.sweeps import angle_rows, angle_series, best_row, draw_angles
from omega_turn_lab.studies.tasks import DesignTask

NAME = 'frequency'
FORWARD = (1.0, 1.5, 2.0)


def _family(plan: Plan, k_f: float) -> list[DesignTask]:
    return [plan.design(k_t, k_f=k_f) for k_t in k_grid(k_f)]


def _designs(plan: Plan) -> list[DesignTask]:
    return [task for k_f in FORWARD for task in _family(plan, k_f)]


def _rows(outcome: Outcome) -> list[Row]:
    rows = angle_rows(NAME, outcome, _designs(outcome.plan), 'k_f {k_f:g}')
    for k_f in FORWARD:
        rows.append(best_row(NAME, outcome, _family(outcome.plan, k_f), f'k_f {k_f:g}, best k_t'))
    return rows


def _draw(outcome: Outcome, out: Path) -> None:
    series = [
        angle_series(NAME, outcome, _family(outcome.plan, k_f), f'$k_f$ = {k_f:g}')
        for k_f in FORWARD
    ]
    draw_angles(out / f'{NAME}.png', series)


STUDY = Study(NAME, 'Forward wave: angle by spatial frequency k_f', _designs, _rows, _draw)
