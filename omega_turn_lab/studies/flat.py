"""The two-wave family on flat ground: angle and swept area over k_t (Sec. IV.C, IV.D)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from omega_turn_lab.studies.areas import READINGS
from omega_turn_lab.studies.figures import (
    COLOURS,
    MARKERS,
    Series,
    add_legends,
    draw_series,
    new_figure,
)
from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.rows import Row, params_of, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study, k_grid
from omega_turn_lab.studies.sweeps import angle_rows, angle_series, best_row, case_name
from omega_turn_lab.studies.tasks import DesignTask

NAME = 'flat'
AREA_WEIGHTS = (0.5, 1.0, 2.0, 4.0, 8.0)  # [rad/BL^2]
DRAWN_READINGS = ('swept_area', 'swept_area_union')


def _family(plan: Plan) -> list[DesignTask]:
    return [plan.design(k_t) for k_t in k_grid(1.5)]


def _front(plan: Plan) -> list[DesignTask]:
    """Omega turns of ever smaller swept area."""
    return [plan.design(1.0), *(plan.design(1.0, area_weight=w) for w in AREA_WEIGHTS)]


def _designs(plan: Plan) -> list[DesignTask]:
    return [*_family(plan), *_front(plan)]


def _areas(outcome: Outcome, task: DesignTask, reading: str) -> tuple[float, float | None]:
    physics = outcome.physics(task)
    ours = outcome.designed[task]['areas'][reading]
    return ours, None if physics is None else physics['areas'][reading]


def _rows(outcome: Outcome) -> list[Row]:
    family = _family(outcome.plan)
    rows = angle_rows(NAME, outcome, family, '')
    rows.append(best_row(NAME, outcome, family, 'best k_t'))
    for reading in READINGS:
        for task in family:
            ours = _areas(outcome, task, reading)
            rows.append(row_of(NAME, case_name(task), task, reading, 'BL^2', ours))
    for task in _front(outcome.plan):
        case = f'area weight {task.area_weight:g} rad/BL²'
        angles = outcome.angles(task)
        rows.append(row_of(NAME, case, task, 'pareto', 'deg', angles))
        rows.append(
            row_of(NAME, case, task, 'pareto', 'BL^2', _areas(outcome, task, 'swept_area'))
        )
    return rows


def _area_series(outcome: Outcome, tasks: Sequence[DesignTask], reading: str) -> Series:
    areas = [_areas(outcome, task, reading) for task in tasks]
    played = [physics for _, physics in areas if physics is not None]
    paper = []
    for task in tasks:
        mean, deviation = paper_figure(NAME, reading, params_of(task))
        if mean is not None:
            paper.append((task.k_t, mean, deviation))
    return Series(
        READINGS[reading],
        [task.k_t for task in tasks],
        [theory for theory, _ in areas],
        played if len(played) == len(tasks) else None,
        paper,
    )


def _draw(outcome: Outcome, out: Path) -> None:
    family = _family(outcome.plan)
    angles = angle_series(NAME, outcome, family, 'angle')
    areas = [_area_series(outcome, family, reading) for reading in DRAWN_READINGS]
    with new_figure(out / f'{NAME}.png', 4.4) as figure:
        above, below = figure.subplots(2, 1, sharex=True)
        draw_series(above, [angles])
        above.set_ylabel('angle per cycle [deg]')
        above.set_xlabel('')
        add_legends(above, angles.pybullet is not None)
        draw_series(below, areas)
        below.set_ylabel('swept area [BL$^2$]')
        below.legend(loc='lower left', bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1)
    _draw_front(outcome, out / f'{NAME}_pareto.png')


def _draw_front(outcome: Outcome, path: Path) -> None:
    """Draw the front of angle against swept area for k_t = 1, the paper's point beside it."""
    front = _front(outcome.plan)
    angles = [outcome.angles(task) for task in front]
    with new_figure(path, 2.7) as figure:
        axes = figure.add_subplot()
        for reading, colour, marker in zip(DRAWN_READINGS, COLOURS, MARKERS):
            areas = [_areas(outcome, task, reading) for task in front]
            theory = sorted((area[0], angle[0]) for area, angle in zip(areas, angles))
            axes.plot(*zip(*theory), color=colour, marker=marker, ms=3.2, label=READINGS[reading])
            played = [(a[1], b[1]) for a, b in zip(areas, angles) if b[1] is not None]
            if played:
                axes.plot(*zip(*played), marker, ms=6.5, mfc='none', mec=colour, mew=0.8)
        params = params_of(front[0])
        area, area_std = paper_figure(NAME, 'swept_area', params)
        angle, angle_std = paper_figure(NAME, 'angle', params)
        axes.errorbar(
            area or 0.0,
            angle or 0.0,
            angle_std,
            area_std,
            color='k',
            capsize=2.6,
            label='paper, robot',
        )
        axes.set_xlabel('swept area [BL$^2$]')
        axes.set_ylabel('angle per cycle [deg]')
        axes.legend()


STUDY = Study(NAME, 'Flat ground: angle and swept area by k_t', _designs, _rows, _draw)
