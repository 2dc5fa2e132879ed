"""Heading over one cycle of the omega turn, by force balance and in PyBullet (Sec. IV.B)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from omega_turn_lab.body_shapes import body_polygons
from omega_turn_lab.studies.figures import COLOURS, draw_paper, new_figure
from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.rows import Row, params_of, row_of
from omega_turn_lab.studies.study import Array, Outcome, Plan, Study
from omega_turn_lab.studies.tasks import AREA_SAMPLES, DesignTask
from omega_turn_ros.design.calibrate import straightest_phase

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAME = 'evolution'
QUARTERS = (0.25, 0.5, 0.75, 1.0)
SNAPSHOTS = 6
NARROWEST, GAP = 0.4, 0.1  # [m] least room for a snapshot, and between two


def _task(plan: Plan) -> DesignTask:
    return plan.design(1.0)


def _designs(plan: Plan) -> list[DesignTask]:
    return [_task(plan)]


def _theory(outcome: Outcome) -> tuple[Array, Array]:
    """Shapes [rad], (T, N), and poses, (T, 3), over one cycle from the straightest shape."""
    task = _task(outcome.plan)
    gait = outcome.gait(task)
    phases = straightest_phase(gait, task.robot.n_yaw) + np.linspace(
        0.0, 2.0 * np.pi, 4 * AREA_SAMPLES + 1
    )
    path = gait.angles(phases, task.robot.n_yaw)
    return path, task.problem.motion.pose_along(path)


def _physics(outcome: Outcome) -> tuple[Array, Array, Array] | None:
    """Fraction of the cycle (T,), shapes (T, N) and poses (T, 3) in PyBullet."""
    physics = outcome.physics(_task(outcome.plan))
    if physics is None:
        return None
    fraction, path, poses = (np.array(physics[k]) for k in ('fraction', 'yaw_angles', 'poses'))
    return fraction, path, poses


def _turned_deg(poses: Array) -> Array:
    turned: Array = np.degrees(poses[:, 2] - poses[0, 2])
    return turned


def _rows(outcome: Outcome) -> list[Row]:
    task = _task(outcome.plan)
    heading = _turned_deg(_theory(outcome)[1])
    played = _physics(outcome)
    rows = []
    for quarter in QUARTERS:
        theory = float(np.interp(quarter, np.linspace(0.0, 1.0, heading.size), heading))
        physics = None
        if played is not None:
            physics = float(np.interp(quarter, played[0], _turned_deg(played[2])))
        study = NAME if quarter == 1.0 else ''  # the paper gives the end only
        case = f'omega, {quarter:.0%} of the cycle'
        rows.append(row_of(study, case, task, 'heading', 'deg', (theory, physics)))
    return rows


def _draw(outcome: Outcome, out: Path) -> None:
    path, poses = _theory(outcome)
    played = _physics(outcome)
    with new_figure(out / f'{NAME}.png', 4.6) as figure:
        above, below = figure.subplots(2, 1, height_ratios=(1.0, 1.5))
        _draw_snapshots(above, outcome, path, poses)
        time = np.linspace(0.0, 1.0, len(poses))
        below.plot(time, _turned_deg(poses), color=COLOURS[0], label='quasi-static')
        if played is not None:
            below.plot(played[0], _turned_deg(played[2]), '--', color=COLOURS[1], label='PyBullet')
        mean, deviation = paper_figure(NAME, 'heading', params_of(_task(outcome.plan)))
        if mean is not None:
            draw_paper(below, 1.0, mean, deviation, 'k', dodge=0.015)
            below.plot([], [], 'k_', ms=7, mew=1.6, label='paper, robot (mean ± std)')
        below.set_xlabel('gait cycle')
        below.set_ylabel('heading [deg]')
        below.legend(loc='upper left')


def _draw_snapshots(axes: Axes, outcome: Outcome, path: Array, poses: Array) -> None:
    """Draw bodies side by side, heading kept, head marked, each over its instant."""
    from matplotlib.patches import Polygon

    task = _task(outcome.plan)
    chosen = np.linspace(0, len(poses) - 1, SNAPSHOTS).round().astype(int)
    places = poses[chosen] * (0.0, 0.0, 1.0)
    outlines = task.problem.chain.outline(path[chosen], places)
    low, high = outlines.min(axis=1, keepdims=True), outlines.max(axis=1, keepdims=True)
    outlines -= 0.5 * (low + high)
    room = np.maximum((high - low)[:, 0, 0], NARROWEST) + GAP
    centres = np.cumsum(room) - 0.5 * room
    outlines[..., 0] += centres[:, None]
    bottom = outlines[..., 1].min() - GAP
    for index, centre, outline in zip(chosen, centres, outlines):
        for polygon in body_polygons(outline, task.robot.module_width):
            axes.add_patch(Polygon(polygon, facecolor=COLOURS[0], linewidth=0))
        axes.plot(*outline[0], 'o', color=COLOURS[1], ms=2.5)
        axes.annotate(f'{index / (len(poses) - 1):.1f}', (centre, bottom), ha='center', va='top')
    axes.set_xlim(0.0, room.sum())
    axes.set_ylim(bottom - 1.5 * GAP, outlines[..., 1].max() + GAP)
    axes.set_aspect('equal')
    axes.axis('off')


STUDY = Study(NAME, 'Heading over one cycle of the omega turn', _designs, _rows, _draw)
