"""The two-wave family on flat ground: angle and swept area over k_t (Sec. IV.C, IV.D)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from omega_turn_lab.studies.areas import READINGS
from omega_turn_lab.studies.figures import (
    COLOURS,
    add_legend,
    draw_series,
    new_figure,
)
from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.rows import Row, params_of, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study, k_grid
from omega_turn_lab.studies.sweeps import (
    angle_rows,
    angle_series,
    best_row,
    case_name,
    series_of,
)
from omega_turn_lab.studies.tasks import DesignTask

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAME = 'flat'
AREA_LIMITS = (0.25, 0.22, 0.19)  # [BL^2]
LEAST, MOST = 'swept_area_least', 'swept_area_most'


def _family(plan: Plan) -> list[DesignTask]:
    return [plan.design(k_t) for k_t in k_grid(1.5)]


def _front(plan: Plan) -> list[DesignTask]:
    """Omega turns of ever smaller swept area."""
    return [plan.design(1.0), *(plan.design(1.0, area_limit=a) for a in AREA_LIMITS)]


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
            case = case_name(task)
            rows.append(row_of(NAME, case, task, reading, 'BL^2', ours, 'swept_area'))
    for task in _front(outcome.plan):
        limited = task.area_limit < math.inf
        case = f'omega, area up to {task.area_limit:g} BL²' if limited else 'omega, any area'
        rows.append(row_of(NAME, case, task, 'pareto', 'deg', outcome.angles(task), 'angle'))
        areas = _areas(outcome, task, LEAST)
        rows.append(row_of(NAME, case, task, 'pareto', 'BL^2', areas, 'swept_area'))
    return rows


def _draw(outcome: Outcome, out: Path) -> None:
    family = _family(outcome.plan)
    angles = angle_series(NAME, outcome, family, 'angle')
    with new_figure(out / f'{NAME}.png', 4.4) as figure:
        above, below = figure.subplots(2, 1, sharex=True)
        draw_series(above, [angles])
        above.set_ylabel('angle per cycle [deg]')
        above.set_xlabel('')
        add_legend(figure, above, angles.pybullet is not None)
        _draw_areas(below, outcome, family)
    _draw_front(outcome, out / f'{NAME}_pareto.png')


def _draw_areas(axes: Axes, outcome: Outcome, family: Sequence[DesignTask]) -> None:
    """Hull of the body axis over k_t: from the straightest shape, and its range over starts."""
    series = series_of(
        NAME, family, [_areas(outcome, t, 'swept_area') for t in family], 'swept_area', ''
    )
    least, most = ([_areas(outcome, t, reading)[0] for t in family] for reading in (LEAST, MOST))
    axes.fill_between(series.k, least, most, color=COLOURS[0], alpha=0.18, linewidth=0)
    axes.annotate(
        'band: any start of the cycle,\nline: from the straightest shape',
        (0.02, 0.04),
        xycoords='axes fraction',
        color='0.3',
    )
    draw_series(axes, [series])
    axes.set_ylabel('swept area [BL$^2$]')


def _draw_front(outcome: Outcome, path: Path) -> None:
    """Draw angle against swept area: the family, omega turns of less area, the paper's points."""
    family, front = _family(outcome.plan), _front(outcome.plan)
    with new_figure(path, 3.0) as figure:
        axes = figure.add_subplot()
        x, y = _points(outcome, family)
        axes.plot(x, y, 'o', color='0.45', ms=3.2, label='largest angle at each $k_t$')
        for task, *place in zip(family, x, y):
            if task not in front:  # which the legend names
                _name_point(axes, f'{task.k_t:g}', place, '0.45', (-4, -1), 'right')
            mean, deviation = paper_figure(NAME, 'angle', params_of(task))
            size, spread = paper_figure(NAME, 'swept_area', params_of(task))
            if mean is not None and size is not None:
                axes.errorbar(size, mean, deviation, spread, color='k', capsize=2.6)
                _name_point(axes, f'{task.k_t:g}', (size, mean), 'k', (4, 3), 'left')
        axes.plot(
            *_points(outcome, front),
            's-',
            color=COLOURS[1],
            ms=3.2,
            label='$k_t$ = 1, area limited',
        )
        played = [(_areas(outcome, task, LEAST)[1], outcome.angles(task)[1]) for task in front]
        if outcome.played:
            open_mark: dict[str, Any] = {'ms': 6.0, 'mfc': 'none', 'mec': COLOURS[1], 'mew': 0.8}
            axes.plot(*zip(*played), 's', **open_mark, label='the same in PyBullet')
        axes.errorbar([], [], [], [], color='k', capsize=2.6, label='paper, mean ± std')
        axes.set_xlabel('swept area, least over the start of the cycle [BL$^2$]')
        axes.set_ylabel('angle per cycle [deg]')
        axes.set_ylim(bottom=0.0)
        axes.margins(x=0.12)
        figure.legend(loc='outside upper center', ncols=2)


def _points(outcome: Outcome, tasks: Sequence[DesignTask]) -> tuple[list[float], list[float]]:
    """Swept area [BL^2] and angle [deg] by force balance."""
    areas = [_areas(outcome, task, LEAST)[0] for task in tasks]
    return areas, [outcome.angles(task)[0] for task in tasks]


def _name_point(
    axes: Axes, text: str, place: Sequence[float], colour: str, shift: tuple[int, int], ha: str
) -> None:
    axes.annotate(
        text, (place[0], place[1]), shift, textcoords='offset points', color=colour, ha=ha
    )


STUDY = Study(NAME, 'Flat ground: angle and swept area by k_t', _designs, _rows, _draw)
