"""Height functions of the omega turn with its gait paths, as a study (Sec. III).

`omega_turn_lab.studies.height` does the work; `height_rows(problem, gait)` gives (case, quantity,
unit, value) tuples and `draw_height(problem, gait, out)` writes `height.png` into a folder.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

from omega_turn_lab.studies.rows import Row, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.tasks import DesignTask

NAME = 'height'


def _module() -> Any:
    return import_module('omega_turn_lab.studies.height')


def _task(plan: Plan) -> DesignTask:
    return plan.design(1.0)


def _rows(outcome: Outcome) -> list[Row]:
    task = _task(outcome.plan)
    found = _module().height_rows(task.problem, outcome.gait(task))
    return [
        row_of(NAME, case, task, quantity, unit, (value, None))
        for case, quantity, unit, value in found
    ]


def _draw(outcome: Outcome, out: Path) -> None:
    task = _task(outcome.plan)
    _module().draw_height(task.problem, outcome.gait(task), out)


STUDY = Study(
    NAME,
    'Height functions of the omega turn',
    lambda plan: [_task(plan)],
    _rows,
    _draw,
    played=False,
)
