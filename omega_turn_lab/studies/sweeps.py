"""Angle over k_t: what the studies of the paper's flat ground have in common."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from omega_turn_lab.studies.figures import Series, add_legend, draw_series, new_figure
from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.rows import Row, params_of, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.tasks import DesignTask

NICKNAMES = {0.0: 'offset', 1.0: 'omega'}


def turn_name(task: DesignTask) -> str:
    """What the paper calls a member of the two-wave family; '' where it has no name for it."""
    if task.k_t == task.k_f and task.k_t != 1.0:
        return 'geometric'
    return NICKNAMES.get(task.k_t, '')


def case_name(task: DesignTask, *parts: str) -> str:
    """Name of a case: what is varied, k_t, and what the turn is called."""
    name = turn_name(task)
    return ', '.join([*parts, f'k_t {task.k_t:g}']) + (f' ({name})' if name else '')


def angle_rows(study: str, outcome: Outcome, tasks: Sequence[DesignTask], part: str) -> list[Row]:
    """One row for the angle of each case; `part` is formatted with N, k_f and theta_max_deg."""
    rows = []
    for task in tasks:
        parts = [part.format_map(params_of(task))] if part else []
        case = case_name(task, *parts)
        rows.append(row_of(study, case, task, 'angle', 'deg', outcome.angles(task)))
    return rows


def best_row(study: str, outcome: Outcome, tasks: Sequence[DesignTask], case: str) -> Row:
    """k_t of the largest angle of a family."""
    angles = [outcome.angles(task) for task in tasks]
    _, best = max(zip(angles, tasks), key=lambda pair: pair[0][0])
    played = [(a[1], task.k_t) for a, task in zip(angles, tasks) if a[1] is not None]
    ours = (best.k_t, max(played)[1] if played else None)
    return row_of(study, case, best, 'best_k_t', '1', ours)


def series_of(
    study: str,
    tasks: Sequence[DesignTask],
    values: Sequence[tuple[float, float | None]],
    quantity: str,
    label: str,
) -> Series:
    """Curve over k_t of one family, for a figure.

    Args:
        study: name of the study.
        tasks: the family.
        values: of each, by force balance and in PyBullet.
        quantity: the paper's.
        label: in the legend.
    """
    played = [physics for _, physics in values if physics is not None]
    paper = []
    for task in tasks:
        mean, deviation = paper_figure(study, quantity, params_of(task))
        if mean is not None:
            paper.append((task.k_t, mean, deviation))
    return Series(
        label,
        [task.k_t for task in tasks],
        [theory for theory, _ in values],
        played if len(played) == len(tasks) else None,
        paper,
    )


def angle_series(study: str, outcome: Outcome, tasks: Sequence[DesignTask], label: str) -> Series:
    """Angle over k_t of one family, for a figure."""
    values = [outcome.angles(task) for task in tasks]
    return series_of(study, tasks, values, 'angle', label)


def draw_angles(path: Path, series: Sequence[Series]) -> None:
    """Draw angle per cycle over k_t, one curve per family."""
    with new_figure(path, 2.8) as figure:
        axes = figure.add_subplot()
        draw_series(axes, series)
        axes.set_ylabel('angle per cycle [deg]')
        add_legend(figure, axes, series[0].pybullet is not None)


@dataclass(frozen=True, slots=True)
class Sweep:
    """A study of the angle over k_t, one family of gaits per value of something else.

    Attributes:
        name: of the study.
        values: of what is varied.
        family: gaits over k_t for one of them.
        part: names a value in the table, formatted with N, k_f and theta_max_deg.
        label: names a value in the figure, formatted with it.
    """

    name: str
    values: Sequence[float]
    family: Callable[[Plan, float], list[DesignTask]]
    part: str
    label: str

    def designs(self, plan: Plan) -> list[DesignTask]:
        """Gaits of all families."""
        return [task for value in self.values for task in self.family(plan, value)]

    def rows(self, outcome: Outcome) -> list[Row]:
        """Angle of every gait, then the best k_t of every family."""
        families = [self.family(outcome.plan, value) for value in self.values]
        rows = angle_rows(self.name, outcome, self.designs(outcome.plan), self.part)
        for tasks in families:
            case = f'{self.part.format_map(params_of(tasks[0]))}, best k_t'
            rows.append(best_row(self.name, outcome, tasks, case))
        return rows

    def draw(self, outcome: Outcome, out: Path) -> None:
        """Draw one curve per family."""
        series = [
            angle_series(self.name, outcome, self.family(outcome.plan, v), self.label.format(v))
            for v in self.values
        ]
        draw_angles(out / f'{self.name}.png', series)

    def study(self, title: str) -> Study:
        """Make the study of it."""
        return Study(self.name, title, self.designs, self.rows, self.draw)
