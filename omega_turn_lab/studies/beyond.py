"""Beyond the paper: how much more richer gaits turn per second at equal peak joint speed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.studies.figures import COLOURS, new_figure
from omega_turn_lab.studies.rows import Row, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.tasks import DesignTask
from omega_turn_ros.design.objective import turning_speed

Array = NDArray[np.float64]

NAME = 'beyond'
PEAK_SPEED = 1.0  # [rad/s] of the fastest joint, at which turning speeds are told
FAMILIES = {
    'paper, most per cycle': 'direct',
    'paper, most per second': 'speed',
    'one harmonic': 'fourier_1',
    'two harmonics': 'fourier_2',
}
PAPER = ('direct', 'speed')
K_T = (0.75, 1.0)


def _task(plan: Plan, k_t: float, method: str) -> DesignTask:
    return plan.design(k_t, method=method)


def _designs(plan: Plan) -> list[DesignTask]:
    return [_task(plan, k_t, method) for k_t in K_T for method in FAMILIES.values()]


def _path(outcome: Outcome, task: DesignTask) -> Array:
    return task.problem.path(outcome.gait(task))


def _speeds(outcome: Outcome, task: DesignTask) -> tuple[float, float | None]:
    """Mean turning speed [deg/s] with the fastest joint at the peak speed, uniform clock."""
    path = _path(outcome, task)
    ours, physics = outcome.angles(task)
    per_degree = PEAK_SPEED * float(turning_speed(1.0, path))
    return ours * per_degree, None if physics is None else physics * per_degree


def _paced_speed(outcome: Outcome, task: DesignTask) -> float:
    """The same with the clock of the cycle warped so that the peak speed is held all along."""
    travel = float(np.abs(np.diff(_path(outcome, task), axis=0)).max(axis=1).sum())
    return PEAK_SPEED * outcome.designed[task]['angle_deg'] / travel


def _rows(outcome: Outcome) -> list[Row]:
    rows = []
    for k_t in K_T:
        for family, method in FAMILIES.items():
            task = _task(outcome.plan, k_t, method)
            case = f'k_t {k_t:g}, {family}'
            rows.append(row_of(NAME, case, task, 'angle', 'deg', outcome.angles(task)))
            speeds = _speeds(outcome, task)
            rows.append(row_of(NAME, case, task, 'turning_speed', 'deg/s', speeds))
            paced = (_paced_speed(outcome, task), None)
            rows.append(row_of(NAME, case, task, 'turning_speed_paced', 'deg/s', paced))
            rows.append(row_of(NAME, case, task, 'gain', '1', _gain(outcome, task)))
    return rows


def _gain(outcome: Outcome, task: DesignTask) -> tuple[float, float | None]:
    """Turning speed over the best of the paper's family of the same k_t."""
    paper = [_speeds(outcome, _task(outcome.plan, task.k_t, m)) for m in PAPER]
    ours, played = _speeds(outcome, task)
    best = max(speed for speed, _ in paper)
    best_played = max((speed for _, speed in paper if speed is not None), default=None)
    if played is None or best_played is None:
        return ours / best, None
    return ours / best, played / best_played


def _draw(outcome: Outcome, out: Path) -> None:
    """Turning speed by family, and the amplitudes and heading of each gait over its cycle."""
    with new_figure(out / f'{NAME}.png', 5.6) as figure:
        bars, amplitudes, headings = figure.subplots(3, 1, height_ratios=[1.3, 1.0, 1.0])
        _draw_speeds(bars, outcome)
        phase = np.linspace(0.0, 2.0 * np.pi, 361)
        for method, colour in zip(FAMILIES.values(), COLOURS):
            task = _task(outcome.plan, 1.0, method)
            gait, motion = outcome.gait(task), task.problem.motion
            path = gait.angles(phase, task.robot.n_yaw)
            # every cycle from where its joints are straightest, on one clock of peak speed
            first = int(np.abs(path[:-1]).max(axis=1).argmin())
            path = np.concatenate([path[first:-1], path[: first + 1]])
            seconds = (phase / phase[-1]) * _cycle_seconds(path)
            amplitudes.plot(seconds, np.degrees(np.abs(path).max(axis=1)), color=colour)
            heading = np.degrees(motion.heading_along(path))
            headings.plot(seconds, heading, color=colour)
        amplitudes.set_ylabel('largest joint\nangle [deg]')
        headings.set_ylabel('heading [deg]')
        headings.set_xlabel(f'time at a peak joint speed of {PEAK_SPEED:g} rad/s [s]')
        amplitudes.set_title('one cycle, $k_t$ = 1', loc='left')


def _cycle_seconds(path: Array) -> float:
    """Duration of a cycle at a uniform clock whose fastest joint reaches the peak speed [s]."""
    return (path.shape[0] - 1) * float(np.abs(np.diff(path, axis=0)).max()) / PEAK_SPEED


def _draw_speeds(axes, outcome: Outcome) -> None:  # type: ignore[no-untyped-def]
    width = 0.8 / len(FAMILIES)
    for i, (family, method) in enumerate(FAMILIES.items()):
        for j, k_t in enumerate(K_T):
            task = _task(outcome.plan, k_t, method)
            ours, physics = _speeds(outcome, task)
            place = j + (i - 1.5) * width
            label = family if j == 0 else None
            axes.bar(place, ours, 0.9 * width, color=COLOURS[i], alpha=0.85, label=label)
            if physics is not None:
                marker = 'PyBullet' if i == j == 0 else None
                axes.plot(place, physics, 'kD', ms=3.5, label=marker)
    axes.set_xticks(range(len(K_T)), [f'$k_t$ = {k_t:g}' for k_t in K_T])
    axes.set_ylabel(f'turning speed [deg/s]\nat {PEAK_SPEED:g} rad/s peak')
    low, high = axes.get_ylim()
    axes.set_ylim(low, 1.45 * high)
    axes.legend(ncols=2, loc='upper left')


STUDY = Study(
    NAME, 'Richer gaits: turn per second at equal peak joint speed', _designs, _rows, _draw
)
