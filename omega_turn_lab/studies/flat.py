"""The two-wave family on flat ground: angle and swept area over k_t (Sec. IV.C, IV.D)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from omega_turn_lab.studies.areas import READINGS, area_readings
from omega_turn_lab.studies.figures import (
    COLOURS,
    MARKERS,
    add_legends,
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
from omega_turn_lab.studies.tasks import AREA_SAMPLES, DesignTask

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAME = 'flat'
AREA_WEIGHTS = (3.0, 6.0)  # [rad/BL^2]; beyond, standing still is best
SCALES = tuple(0.05 * i for i in range(8, 21))  # of both amplitudes, along the front
STARTS = 'swept_area_least', 'swept_area_most'


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
            case = case_name(task)
            rows.append(row_of(NAME, case, task, reading, 'BL^2', ours, 'swept_area'))
    for task in _front(outcome.plan):
        case = f'area weight {task.area_weight:g} rad/BL²'
        rows.append(row_of(NAME, case, task, 'pareto', 'deg', outcome.angles(task), 'angle'))
        areas = _areas(outcome, task, 'swept_area_least')
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
        add_legends(above, angles.pybullet is not None)
        _draw_areas(below, outcome, family)
    _draw_front(outcome, out / f'{NAME}_pareto.png')


def _draw_areas(axes: Axes, outcome: Outcome, family: Sequence[DesignTask]) -> None:
    """Hull of the body axis over k_t: from the straightest shape, and its range over starts."""
    series = series_of(
        NAME, family, [_areas(outcome, t, 'swept_area') for t in family], 'swept_area', ''
    )
    least, most = ([_areas(outcome, t, reading)[0] for t in family] for reading in STARTS)
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
    """Draw angle against swept area for k_t = 1, the paper's point beside it."""
    with new_figure(path, 2.7) as figure:
        axes = figure.add_subplot()
        for task, colour, marker in zip(_front(outcome.plan), COLOURS, MARKERS):
            areas, angles = zip(*(_scaled(outcome, task, scale) for scale in SCALES))
            label = f'area weight {task.area_weight:g} rad/BL$^2$'
            axes.plot(areas, angles, color=colour, marker=marker, markevery=[-1], label=label)
            (_, angle), (_, area) = (outcome.angles(task), _areas(outcome, task, STARTS[0]))
            if angle is not None and area is not None:
                axes.plot(area, angle, marker, ms=6.5, mfc='none', mec=colour, mew=0.8)
        params = params_of(_front(outcome.plan)[0])
        (area, area_std), (angle, angle_std) = (
            paper_figure(NAME, quantity, params) for quantity in ('swept_area', 'angle')
        )
        if area is not None and angle is not None:
            label = 'paper, robot (mean ± std)'
            axes.errorbar(area, angle, angle_std, area_std, color='k', capsize=2.6, label=label)
        axes.set_xlabel('swept area, least over the start of the cycle [BL$^2$]')
        axes.set_ylabel('angle per cycle [deg]')
        axes.legend()


def _scaled(outcome: Outcome, task: DesignTask, scale: float) -> tuple[float, float]:
    """Swept area [BL^2] and angle [deg] of a gait with both amplitudes scaled."""
    gait, problem = outcome.gait(task), task.problem
    phases = np.linspace(0.0, 2.0 * np.pi, AREA_SAMPLES + 1)
    path = gait.angles(phases, task.robot.n_yaw, scale)
    poses = problem.motion.pose_along(path)
    areas = area_readings(problem.chain, problem.width, path, poses)
    return areas['swept_area_least'], float(np.degrees(poses[-1, 2]))


STUDY = Study(NAME, 'Flat ground: angle and swept area by k_t', _designs, _rows, _draw)
