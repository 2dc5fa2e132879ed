"""The rows of a study: on screen, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.tasks import DesignTask
from omega_turn_ros import __version__

DIGITS = {'deg': 1, 'BL': 3, 'BL^2': 3}  # decimals shown
FILE_WIDTH = 120  # [characters]


@dataclass(frozen=True, slots=True)
class Row:
    """One number of ours beside the paper's.

    Attributes:
        case: what people call it.
        params: N, k_f, k_t, theta_max_deg.
        quantity: such as 'angle' or 'swept_area'.
        unit: 'deg', 'BL', 'BL^2' or '1'.
        paper: mean of the paper's trials.
        paper_std: their standard deviation.
        quasi_static: ours by force balance.
        pybullet: ours in PyBullet.
    """

    case: str
    params: dict[str, float]
    quantity: str
    unit: str
    paper: float | None
    paper_std: float | None
    quasi_static: float | None
    pybullet: float | None

    def to_mapping(self) -> dict[str, Any]:
        """Return what the JSON file holds."""
        return {name: _rounded(getattr(self, name)) for name in self.__slots__}


def _rounded(value: Any) -> Any:
    return round(value, 6) if isinstance(value, float) else value


def params_of(task: DesignTask) -> dict[str, float]:
    """Parameters that name a case."""
    return {
        'N': task.robot.n_yaw,
        'k_f': task.k_f,
        'k_t': task.k_t,
        'theta_max_deg': task.theta_max_deg,
    }


def row_of(
    study: str,
    case: str,
    task: DesignTask,
    quantity: str,
    unit: str,
    ours: tuple[float | None, float | None],
    paper_quantity: str = '',
) -> Row:
    """Row of one quantity of a designed gait, with the paper's number where it gives one.

    Args:
        study: name of the study, under which the paper's number is looked up.
        case: what people call it.
        task: whose gait it is.
        quantity: see `Row`.
        unit: see `Row`.
        ours: by force balance and in PyBullet.
        paper_quantity: the paper's quantity to hold it against, if it goes by another name.
    """
    params = params_of(task)
    paper = paper_figure(study, paper_quantity or quantity, params)
    return Row(case, params, quantity, unit, *paper, *ours)


def write_json(
    path: Path,
    study: str,
    rows: Sequence[Row],
    seed: int,
    seconds: float,
    trials: Sequence[dict[str, Any]] = (),
) -> None:
    """Write a study's numbers, and every trial behind them where it has trials.

    Args:
        path: of the file.
        study: its name.
        rows: the numbers.
        seed: of the searches and trials.
        seconds: by the clock, for the cases of the run and for this study's table and figures.
        trials: plain JSON.
    """
    record: dict[str, Any] = {
        'study': study,
        'rows': [row.to_mapping() for row in rows],
        'seed': seed,
        'version': __version__,
        'seconds': round(seconds, 3),
    }
    if trials:
        record['trials'] = list(trials)
    path.write_text(json.dumps(record, indent=1) + '\n', encoding='utf-8')


def print_table(title: str, rows: Sequence[Row]) -> None:
    """Print ours | PyBullet | paper +- std | difference of ours from the paper's."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title=title, title_justify='left', box=None, pad_edge=False)
    for name in ('case', 'quantity', 'unit'):
        table.add_column(name)
    for name in ('ours', 'PyBullet', 'paper', 'difference'):
        table.add_column(name, justify='right', no_wrap=True)
    for row in rows:
        table.add_row(row.case, row.quantity, row.unit, *_cells(row))
    console = Console()
    # A file has no width: nothing need be folded there.
    Console(width=None if console.is_terminal else FILE_WIDTH).print(table)


def _cells(row: Row) -> tuple[str, str, str, str]:
    digits = DIGITS.get(row.unit, 2)

    def shown(value: float | None, sign: str = '') -> str:
        return '' if value is None else f'{value:{sign}.{digits}f}'

    paper = shown(row.paper)
    if row.paper_std is not None:
        paper += f' ± {row.paper_std:.{digits}f}'
    difference = None
    if row.paper is not None and row.quasi_static is not None:
        difference = row.quasi_static - row.paper
    return shown(row.quasi_static), shown(row.pybullet), paper, shown(difference, '+')
