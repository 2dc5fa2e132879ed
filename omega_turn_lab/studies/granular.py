"""Turning on grains (Sec. IV.H): gaits for hard ground played there, and gaits designed for it.

The paper does not give the resistance of its pool, so the ratio of sideways to lengthways
resistance is varied between friction (1) and the beads that `GranularResistance` was measured in.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from omega_turn_lab.studies.figures import COLOURS, MARKERS, new_figure
from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.rows import Row, params_of, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.sweeps import turn_name
from omega_turn_lab.studies.tasks import SAMPLES, DesignTask
from omega_turn_ros.mechanics.force_laws import GranularResistance
from omega_turn_ros.mechanics.quasi_static import QuasiStatic

NAME = 'granular'
K_T = (0.0, 1.0, 1.5)
RATIOS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)  # F_perp / F_par
DESIGN_RATIOS = (3.0,)
FINE_RATIOS = np.linspace(1.0, 6.0, 41)  # of the curves in the figure


def _hard_ground(plan: Plan, k_t: float) -> DesignTask:
    return plan.design(k_t)


def _on_grains(plan: Plan, k_t: float, ratio: float) -> DesignTask:
    return plan.design(k_t, law=GranularResistance.of_ratio(ratio))


def _designs(plan: Plan) -> list[DesignTask]:
    grains = [_on_grains(plan, k_t, ratio) for k_t in K_T for ratio in DESIGN_RATIOS]
    return [*(_hard_ground(plan, k_t) for k_t in K_T), *grains]


def _angle_deg(outcome: Outcome, task: DesignTask, ratio: float) -> float:
    """Angle per cycle of a gait played on grains [deg]."""
    motion = QuasiStatic(task.problem.chain, GranularResistance.of_ratio(ratio))
    return math.degrees(motion.turn(task.problem.path(outcome.gait(task), SAMPLES)))


def _rows(outcome: Outcome) -> list[Row]:
    rows = []
    for k_t in K_T:
        task = _hard_ground(outcome.plan, k_t)
        for ratio in RATIOS:
            case = f'{turn_name(task)} for hard ground, ratio {ratio:g}'
            ours = (_angle_deg(outcome, task, ratio), None)
            rows.append(row_of(NAME, case, task, 'angle', 'deg', ours))
        for ratio in DESIGN_RATIOS:
            task = _on_grains(outcome.plan, k_t, ratio)
            case = f'{turn_name(task)} for grains, ratio {ratio:g}'
            ours = (outcome.designed[task]['angle_deg'], None)
            rows.append(row_of(NAME, case, task, 'angle', 'deg', ours))
    return rows


def _draw(outcome: Outcome, out: Path) -> None:
    with new_figure(out / f'{NAME}.png', 3.0) as figure:
        axes = figure.add_subplot()
        for k_t, colour, marker in zip(K_T, COLOURS, MARKERS):
            task = _hard_ground(outcome.plan, k_t)
            angles = [_angle_deg(outcome, task, ratio) for ratio in FINE_RATIOS]
            label = f'{turn_name(task)}, $k_t$ = {k_t:g}'
            axes.plot(FINE_RATIOS, angles, color=colour, label=label)
            designed = [
                outcome.designed[_on_grains(outcome.plan, k_t, ratio)]['angle_deg']
                for ratio in DESIGN_RATIOS
            ]
            axes.plot(DESIGN_RATIOS, designed, marker, color=colour, ms=4.5)
            mean, deviation = paper_figure(NAME, 'angle', params_of(task))
            if mean is not None and deviation is not None:
                band = (mean - deviation, mean + deviation)
                axes.axhspan(*band, color=colour, alpha=0.18, linewidth=0)
        axes.plot([], [], 'o', color='0.3', ms=4.5, label='designed for these grains')
        axes.fill_between([], [], [], color='0.3', alpha=0.25, linewidth=0, label='paper, ± std')
        axes.set_xlim(1.0, FINE_RATIOS[-1])
        axes.set_xlabel('resistance sideways over lengthways, $F_\\perp / F_\\parallel$')
        axes.set_ylabel('angle per cycle [deg]')
        figure.legend(loc='outside upper center', ncols=2)


STUDY = Study(
    NAME,
    'Granular ground: angle by ratio of resistance F_perp/F_par',
    _designs,
    _rows,
    _draw,
    played=False,
)
