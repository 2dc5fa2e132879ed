"""What the angle per cycle hangs on: links, load, width and the ratio of friction (own study).

The paper gives the size of a module, not the shape of head and tail, where the weight lies or how
its skin slides. The designed gaits are played on bodies and grounds that differ in one of these,
by force balance: differences from the paper's angles that lie within such changes are no riddle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from omega_turn_lab.studies.figures import COLOURS, MARKERS, new_figure
from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.rows import Row, params_of, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.tasks import SAMPLES, DesignTask
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_laws import CoulombFriction
from omega_turn_ros.mechanics.quasi_static import QuasiStatic

NAME = 'sensitivity'
TURNS = (
    ('omega', 1.0, 90.0),
    ('omega', 1.0, 75.0),
    ('offset', 0.0, 90.0),
    ('geometric', 1.5, 90.0),
)
ROWS = 3  # of contact points across a link, where the width counts


@dataclass(frozen=True, slots=True)
class Change:
    """One departure from the nominal body or ground.

    Attributes:
        head: length of the first link over the nominal.
        tail: of the last.
        end_load: weight on each end link over the nominal.
        width: of the contact patch over the module width.
        ratio: friction across the links over friction along them.
    """

    head: float = 1.0
    tail: float = 1.0
    end_load: float = 1.0
    width: float = 0.0
    ratio: float = 1.0

    def motion(self, task: DesignTask) -> QuasiStatic:
        """Return the changed body on the changed ground."""
        lengths = task.robot.planar_link_lengths
        lengths[0] *= self.head
        lengths[-1] *= self.tail
        loads = lengths.copy()
        loads[[0, -1]] *= self.end_load
        chain = PlanarChain(
            lengths,
            loads=loads,
            width=self.width * task.robot.module_width,
            points_across=ROWS if self.width else 1,
        )
        return QuasiStatic(chain, CoulombFriction(self.ratio))


CHANGES = {
    'as designed': Change(),
    'head half as long': Change(head=0.5),
    'tail half as long': Change(tail=0.5),
    'head and tail half as long': Change(head=0.5, tail=0.5),
    'head and tail half as long again': Change(head=1.5, tail=1.5),
    'end links twice as heavy': Change(end_load=2.0),
    'end links half as heavy': Change(end_load=0.5),
    'contact over the whole width': Change(width=1.0),
    'friction across / along 1.25': Change(ratio=1.25),
    'friction across / along 0.8': Change(ratio=0.8),
    'friction across / along 0.6': Change(ratio=0.6),
}


def _task(plan: Plan, turn: tuple[str, float, float]) -> DesignTask:
    _, k_t, limit = turn
    return plan.design(k_t, theta_max_deg=limit)


def _designs(plan: Plan) -> list[DesignTask]:
    return [_task(plan, turn) for turn in TURNS]


def _angle_deg(outcome: Outcome, task: DesignTask, change: Change) -> float:
    path = task.problem.path(outcome.gait(task), SAMPLES)
    return math.degrees(change.motion(task).turn(path))


def _table(turn: tuple[str, float, float]) -> str:
    """Study under which the paper's angle stands."""
    return 'flat' if turn[2] == 90.0 else 'amplitude'


def _title(turn: tuple[str, float, float]) -> str:
    name, _, limit = turn
    return f'{name}, {limit:g}°'


def _rows(outcome: Outcome) -> list[Row]:
    rows = []
    for turn in TURNS:
        task = _task(outcome.plan, turn)
        for name, change in CHANGES.items():
            case, ours = f'{_title(turn)}, {name}', (_angle_deg(outcome, task, change), None)
            rows.append(row_of(_table(turn), case, task, 'angle', 'deg', ours))
    return rows


def _draw(outcome: Outcome, out: Path) -> None:
    """One panel per turn: angle under each change, the paper's mean and deviation as a band."""
    with new_figure(out / f'{NAME}.png', 3.2, width=7.2) as figure:
        panels = figure.subplots(1, len(TURNS), sharey=True)
        places = np.arange(len(CHANGES))[::-1]
        for axes, turn, colour, marker in zip(panels, TURNS, COLOURS, MARKERS):
            task = _task(outcome.plan, turn)
            angles = [_angle_deg(outcome, task, change) for change in CHANGES.values()]
            mean, deviation = paper_figure(_table(turn), 'angle', params_of(task))
            if mean is not None and deviation is not None:
                axes.axvspan(mean - deviation, mean + deviation, color='0.85', linewidth=0)
                axes.axvline(mean, color='0.5', linewidth=0.8)
            axes.axvline(angles[0], color=colour, linewidth=0.6, linestyle=':')
            axes.plot(angles, places, marker, color=colour)
            axes.set_yticks(places, list(CHANGES))
            axes.set_title(_title(turn))
            axes.set_xlabel('angle per cycle [deg]')


STUDY = Study(NAME, 'What the angle per cycle hangs on', _designs, _rows, _draw, played=False)
