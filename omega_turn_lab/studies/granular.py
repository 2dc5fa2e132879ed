"""Turning on grains (Sec. IV.H): gaits for hard ground played there, and gaits designed for it.

The paper does not give the resistance of its pool, so the ratio of sideways to lengthways
resistance is varied between friction (1) and the beads that `GranularResistance` was measured in.
How strong the grains are does not matter as long as the motors follow the gait, and decides where
they stall: so the gaits are also played in ever stronger grains, with the robot's own motors.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from omega_turn_lab.studies.figures import COLOURS, COLUMN, MARKERS, new_figure
from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.rows import Row, params_of, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.sweeps import turn_name
from omega_turn_lab.studies.tasks import SAMPLES, DesignTask, PhysicsTask
from omega_turn_ros.mechanics.force_laws import GranularResistance
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_sim_bridge.terrain_config import TerrainConfig

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAME = 'granular'
K_T = (0.0, 1.0, 1.5)
RATIOS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)  # F_perp / F_par
DESIGN_RATIOS = (3.0,)
WEAK = 0.5  # resistance lengthways over weight; no motor stalls at any ratio up to 3
STRENGTHS = (WEAK, 1.0, 1.5, 2.0, 2.5, 3.0)
STALL_RATIO = 1.5  # where the strength is varied: the omega turn comes nearest to the paper's
FINE_RATIOS = np.linspace(1.0, 6.0, 41)  # of the curves in the figure
OPEN_MARK: dict[str, Any] = {'ms': 6.5, 'mfc': 'none', 'mew': 0.8}


def _hard_ground(plan: Plan, k_t: float) -> DesignTask:
    return plan.design(k_t)


def _on_grains(plan: Plan, k_t: float, ratio: float) -> DesignTask:
    return plan.design(k_t, law=GranularResistance.of_ratio(ratio))


def _designs(plan: Plan) -> list[DesignTask]:
    grains = [_on_grains(plan, k_t, ratio) for k_t in K_T for ratio in DESIGN_RATIOS]
    return [*(_hard_ground(plan, k_t) for k_t in K_T), *grains]


def _trial(
    outcome: Outcome, task: DesignTask, ratio: float, strength: float = WEAK
) -> PhysicsTask:
    terrain = TerrainConfig('granular', resistance_ratio=ratio)
    return PhysicsTask(task.robot, outcome.gait(task), terrain=terrain, friction=strength)


def _trials(outcome: Outcome) -> list[PhysicsTask]:
    trials = []
    for k_t in K_T:
        hard = _hard_ground(outcome.plan, k_t)
        trials += [_trial(outcome, hard, ratio) for ratio in RATIOS]
        trials += [
            _trial(outcome, _on_grains(outcome.plan, k_t, ratio), ratio) for ratio in DESIGN_RATIOS
        ]
        trials += [_trial(outcome, hard, STALL_RATIO, strength) for strength in STRENGTHS]
    return list(dict.fromkeys(trials))


def _played_deg(
    outcome: Outcome, task: DesignTask, ratio: float, strength: float = WEAK
) -> float | None:
    """Angle per cycle of a gait played on grains in PyBullet [deg]."""
    found = outcome.tried.get(_trial(outcome, task, ratio, strength))
    return None if found is None else found['angle_deg']


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
            ours = (_angle_deg(outcome, task, ratio), _played_deg(outcome, task, ratio))
            rows.append(row_of(NAME, case, task, 'angle', 'deg', ours))
        for strength in STRENGTHS:
            case = f'{turn_name(task)}, ratio {STALL_RATIO:g}, resistance {strength:g} x weight'
            theory = _angle_deg(outcome, task, STALL_RATIO)
            ours = (theory, _played_deg(outcome, task, STALL_RATIO, strength))
            rows.append(row_of(NAME, case, task, 'angle_by_strength', 'deg', ours, 'angle'))
        for ratio in DESIGN_RATIOS:
            task = _on_grains(outcome.plan, k_t, ratio)
            case = f'{turn_name(task)} for grains, ratio {ratio:g}'
            theory = outcome.designed[task]['angle_deg']
            ours = (theory, _played_deg(outcome, task, ratio))
            rows.append(row_of(NAME, case, task, 'angle', 'deg', ours))
    return rows


def _draw(outcome: Outcome, out: Path) -> None:
    """Angle over the ratio of resistances, and beside it over their strength where played."""
    panels = 2 if outcome.tried else 1
    with new_figure(out / f'{NAME}.png', 3.0, panels * COLUMN + (panels - 1) * 0.2) as figure:
        axes, *beside = figure.subplots(1, panels, sharey=True, squeeze=False)[0]
        for k_t, colour, marker in zip(K_T, COLOURS, MARKERS):
            task = _hard_ground(outcome.plan, k_t)
            _draw_ratios(axes, outcome, task, colour, marker)
            for place in beside:
                _draw_strengths(place, outcome, task, colour, marker)
            mean, deviation = paper_figure(NAME, 'angle', params_of(task))
            if mean is not None and deviation is not None:
                for place in (axes, *beside):
                    band = (mean - deviation, mean + deviation)
                    place.axhspan(*band, color=colour, alpha=0.18, linewidth=0)
        axes.plot([], [], 'o', color='0.3', ms=4.5, label='designed for these grains')
        axes.fill_between([], [], [], color='0.3', alpha=0.25, linewidth=0, label='paper, ± std')
        axes.set_xlim(0.9, 1.02 * FINE_RATIOS[-1])
        axes.set_xlabel('resistance sideways over lengthways, $F_\\perp / F_\\parallel$')
        axes.set_ylabel('angle per cycle [deg]')
        for place in beside:
            axes.plot([], [], 'o', **OPEN_MARK, mec='0.3', label='PyBullet')
            axes.set_title(f'weak grains, $F_\\parallel$ = {WEAK:g} weights', loc='left')
            place.set_title(f'$F_\\perp / F_\\parallel$ = {STALL_RATIO:g}', loc='left')
            place.set_xlabel('resistance lengthways over weight, $F_\\parallel / W$')
        figure.legend(loc='outside upper center', ncols=3 if beside else 2)


def _draw_ratios(axes: Axes, outcome: Outcome, task: DesignTask, colour: str, marker: str) -> None:
    angles = [_angle_deg(outcome, task, ratio) for ratio in FINE_RATIOS]
    label = f'{turn_name(task)}, $k_t$ = {task.k_t:g}'
    axes.plot(FINE_RATIOS, angles, color=colour, label=label)
    grains = [_on_grains(outcome.plan, task.k_t, ratio) for ratio in DESIGN_RATIOS]
    designed = [outcome.designed[one]['angle_deg'] for one in grains]
    axes.plot(DESIGN_RATIOS, designed, marker, color=colour, ms=4.5)
    if outcome.tried:
        places = [*RATIOS, *DESIGN_RATIOS]
        trials = [_trial(outcome, *pair) for pair in zip([task] * len(RATIOS) + grains, places)]
        played = [outcome.tried[trial]['angle_deg'] for trial in trials]
        axes.plot(places, played, marker, **OPEN_MARK, mec=colour)


def _draw_strengths(
    axes: Axes, outcome: Outcome, task: DesignTask, colour: str, marker: str
) -> None:
    """Play in stronger and stronger grains, until the motors stall."""
    axes.axhline(_angle_deg(outcome, task, STALL_RATIO), color=colour, lw=0.7, linestyle=':')
    trials = [_trial(outcome, task, STALL_RATIO, strength) for strength in STRENGTHS]
    played = [outcome.tried[trial]['angle_deg'] for trial in trials]
    axes.plot(STRENGTHS, played, marker, **OPEN_MARK, mec=colour, linestyle='-', color=colour)


STUDY = Study(
    NAME,
    'Granular ground: angle by ratio of resistance F_perp/F_par and by its strength',
    _designs,
    _rows,
    _draw,
    played=False,
    trials=_trials,
)
