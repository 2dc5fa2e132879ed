"""Four turning gaits on hard ground and on a pile of rocks (Sec. IV.I).

All four open loop; the omega turn with compliance, too, as the paper's.

The paper's pile is as an outdoor one happens to be; ours are seeded, with stones in the gaps, see
`config/terrains/rocks.yaml`. Planar gaits are tried with pitch motors weak enough for the body to
give a little. A robot that has rolled over, which it knows, plays on, mirrored.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_lab.studies.figures import COLOURS, new_figure
from omega_turn_lab.studies.motion_picture import draw_motion
from omega_turn_lab.studies.patches import PatchesTask
from omega_turn_lab.studies.published import paper_figure
from omega_turn_lab.studies.rows import Row, params_of
from omega_turn_lab.studies.spread import spread_of
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.tasks import DesignTask, Result, Task
from omega_turn_lab.uneven import pitch_effort_on
from omega_turn_ros.compliance.controller import ComplianceConfig
from omega_turn_ros.gaits.library import load_gait
from omega_turn_sim_bridge.terrain_config import TerrainConfig, load_terrain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAME = 'rocks'
PILES = 20
OTHER_FILLS = (0.0, 0.6)  # the omega turn is tried with open gaps and larger stones, too
BEARINGS = (0.1, 0.2, 0.4)  # shares of level ground that bear, for comparison by theory
OMEGA, COMPLIANT = 'omega turn', 'compliant omega turn'
PLANAR = {
    OMEGA: 1.0,
    COMPLIANT: 1.0,
    'offset turn': 0.0,
    'geometric turn': 1.5,
}
FREQUENCY = 'frequency turn'
GAITS = (*PLANAR, FREQUENCY)
PICTURED = (OMEGA, COMPLIANT, 'offset turn')  # on the typical pile
HARD, ROCKS = 'hard ground', 'rocks'
ROLLED = 0.0  # cosine of roll below which a robot counts as rolled over
SIDE, BAR = 0.2, 0.36  # of bars: from their gait's place, and width


def _task(plan: Plan, gait: str) -> DesignTask:
    return plan.design(PLANAR[gait])


def _hard(outcome: Outcome, gait: str) -> ObstacleTrial:
    """Trial of a gait on level ground, turning counter-clockwise."""
    if gait == FREQUENCY:
        entry = load_gait('sidewinding')
        start = entry.calibration.start_phase
        return ObstacleTrial(outcome.plan.robot, entry.gait, start_phase=start)
    compliance = ComplianceConfig() if gait == COMPLIANT else None
    own = outcome.gait(_task(outcome.plan, gait))
    return ObstacleTrial(outcome.plan.robot, own, compliance=compliance)


def _on_rocks(outcome: Outcome, gait: str, seed: int, terrain: TerrainConfig) -> ObstacleTrial:
    hard = _hard(outcome, gait)
    effort = pitch_effort_on(terrain, hard.gait)
    return replace(hard, terrain=terrain, seed=seed, pitch_effort=effort)


def _pile(outcome: Outcome, gait: str) -> list[ObstacleTrial]:
    terrain = load_terrain('rocks')
    return [_on_rocks(outcome, gait, seed, terrain) for seed in range(PILES)]


def _filled(outcome: Outcome, fill: float) -> list[ObstacleTrial]:
    """Piles with stones of `fill` times the rocks' size in the gaps."""
    terrain = replace(load_terrain('rocks'), rock_fill=fill)
    return [_on_rocks(outcome, OMEGA, seed, terrain) for seed in range(PILES)]


def _patches(outcome: Outcome, bearing: float) -> PatchesTask:
    """The omega turn by theory where level patches as far apart as the rocks bear the body."""
    plan, apart = outcome.plan, load_terrain('rocks').rock_size_bl
    return PatchesTask(plan.robot, outcome.gait(_task(plan, OMEGA)), bearing, apart, plan.seed)


def _trials(outcome: Outcome) -> list[Task]:
    # Pile by pile, so that an interrupted run has a little of everything.
    by_gait = [_pile(outcome, gait) for gait in GAITS]
    filled = [_filled(outcome, fill) for fill in OTHER_FILLS]
    piles = (t for pile in zip(*by_gait, *filled) for t in pile)
    patches = (_patches(outcome, bearing) for bearing in BEARINGS)
    return [*(_hard(outcome, g) for g in GAITS), *patches, *piles]


def _tried(outcome: Outcome, gait: str) -> tuple[float, list[Result]]:
    """Angle per cycle on hard ground [deg], and results on the piles."""
    hard = outcome.tried[_hard(outcome, gait)]['angle_deg']
    return hard, [outcome.tried[trial] for trial in _pile(outcome, gait)]


def _rows(outcome: Outcome) -> list[Row]:
    rows = []
    for gait in GAITS:
        params = params_of(_task(outcome.plan, gait)) if gait in PLANAR else {}
        theory = None
        if gait in PLANAR:
            theory = outcome.designed[_task(outcome.plan, gait)]['angle_deg']
        numbers = _numbers(outcome, gait) if outcome.tried else {('angle', HARD, 'deg'): None}
        for (quantity, ground, unit), value in numbers.items():
            paper: tuple[float | None, float | None] = (None, None)
            if params and quantity == 'angle' and ground in _paper_grounds(gait):
                paper = paper_figure(NAME, f'angle_{ground.replace(" ", "_")}', params)
            ours = theory if (quantity, ground) == ('angle', HARD) else None
            rows.append(Row(f'{gait}, {ground}', params, quantity, unit, *paper, ours, value))
    return [*rows, *_fill_rows(outcome), *_patch_rows(outcome)]


def _fill_rows(outcome: Outcome) -> list[Row]:
    """The omega turn's mean and deviation with other stones between the rocks, or none."""
    rows: list[Row] = []
    for fill in OTHER_FILLS if outcome.tried else ():
        found = [outcome.tried[trial]['angle_deg'] for trial in _filled(outcome, fill)]
        spread = spread_of(found, outcome.plan.seed)
        params = {**params_of(_task(outcome.plan, OMEGA)), 'rock_fill': fill}
        case = f'{OMEGA}, rocks, stones {fill:g} of their size between'
        for quantity, value in (('angle', spread.mean), ('angle_std', spread.deviation)):
            rows.append(Row(case, params, quantity, 'deg', None, None, None, value))
    return rows


def _patch_rows(outcome: Outcome) -> list[Row]:
    """What patchy support alone does to the omega turn, by force balance."""
    rows: list[Row] = []
    for bearing in BEARINGS if outcome.tried else ():
        found = outcome.tried[_patches(outcome, bearing)]['angles_deg']
        params = {**params_of(_task(outcome.plan, OMEGA)), 'bearing': bearing}
        case = f'{OMEGA}, level patches that bear, {bearing:g} of the ground'
        for quantity, value in (('angle', np.mean(found)), ('angle_std', np.std(found, ddof=1))):
            rows.append(Row(case, params, quantity, 'deg', None, None, float(value), None))
    return rows


def _paper_grounds(gait: str) -> tuple[str, ...]:
    """Grounds on which the paper's angle is that of this gait: on rocks it complies."""
    return (ROCKS,) if gait == COMPLIANT else (HARD,)


def _numbers(outcome: Outcome, gait: str) -> dict[tuple[str, str, str], float | None]:
    hard, results = _tried(outcome, gait)
    spread = spread_of([result['angle_deg'] for result in results], outcome.plan.seed)
    _, open_loop = _tried(outcome, OMEGA)
    gains = [b['angle_deg'] - a['angle_deg'] for a, b in zip(open_loop, results)]
    gain = spread_of(gains, outcome.plan.seed) if gait == COMPLIANT else None
    rolled = np.mean([result['least_upright'] < ROLLED for result in results])
    paired = (
        {}
        if gain is None
        else {
            ('gain', ROCKS, 'deg'): gain.mean,
            ('gain_low', ROCKS, 'deg'): gain.low,
            ('gain_high', ROCKS, 'deg'): gain.high,
        }
    )
    return {
        **paired,
        ('angle', HARD, 'deg'): hard,
        ('angle', ROCKS, 'deg'): spread.mean,
        ('angle_std', ROCKS, 'deg'): spread.deviation,
        ('angle_low', ROCKS, 'deg'): spread.low,
        ('angle_high', ROCKS, 'deg'): spread.high,
        ('kept', ROCKS, '1'): spread.mean / hard,
        ('rolled_over', ROCKS, '1'): float(rolled),
    }


def _records(outcome: Outcome) -> list[dict[str, Any]]:
    if not outcome.tried:
        return []
    return [
        _ground(trial) | {'gait': gait, 'seed': trial.seed} | _without_motion(outcome.tried[trial])
        for gait, trials in _by_gait(outcome)
        for trial in trials
    ]


def _by_gait(outcome: Outcome) -> Iterator[tuple[str, list[ObstacleTrial]]]:
    for gait in GAITS:
        yield gait, [_hard(outcome, gait), *_pile(outcome, gait)]
    for fill in OTHER_FILLS:
        yield OMEGA, _filled(outcome, fill)


def _ground(trial: ObstacleTrial) -> Result:
    kind = trial.terrain.kind
    return {'terrain': kind} | ({'rock_fill': trial.terrain.rock_fill} if kind == ROCKS else {})


def _without_motion(result: Result) -> Result:
    return {k: v for k, v in result.items() if k not in ('time', 'poses', 'yaw_angles')}


def _draw(outcome: Outcome, out: Path) -> None:
    """Bars of the gaits on both grounds, every pile as a dot; below, bodies over time."""
    if not outcome.tried:
        return
    with new_figure(out / f'{NAME}.png', 5.0) as figure:
        grid = figure.add_gridspec(2, len(PICTURED), height_ratios=(1.5, 1.0))
        typical = _typical_seed(outcome)
        for i, gait in enumerate(PICTURED):
            place, trial = figure.add_subplot(grid[1, i]), _pile(outcome, gait)[typical]
            draw_motion(place, trial, outcome.tried[trial])
            place.set_title(gait, fontsize=7.0)
        axes = figure.add_subplot(grid[0, :])
        for i, gait in enumerate(GAITS):
            _draw_gait(axes, outcome, gait, i)
        axes.axhline(0.0, color='k', linewidth=0.6)
        axes.set_xticks(range(len(GAITS)), [gait.replace(' ', '\n') for gait in GAITS])
        axes.set_ylabel('angle per cycle [deg]')
        handles, labels = axes.get_legend_handles_labels()
        named = dict(zip(labels, handles))
        figure.legend(named.values(), named.keys(), loc='outside upper center', ncols=2)


def _typical_seed(outcome: Outcome) -> int:
    """Pile on which the omega turn comes nearest to its mean over all piles."""
    _, results = _tried(outcome, OMEGA)
    found = np.array([result['angle_deg'] for result in results])
    return int(np.abs(found - found.mean()).argmin())


def _draw_gait(axes: Axes, outcome: Outcome, gait: str, place: float) -> None:
    hard, results = _tried(outcome, gait)
    found = [result['angle_deg'] for result in results]
    spread = spread_of(found, outcome.plan.seed)
    left, right = place - SIDE, place + SIDE
    axes.bar(left, hard, BAR, color=COLOURS[0], label=HARD)
    axes.bar(right, spread.mean, BAR, color=COLOURS[1], label='rocks, mean and 95 % interval')
    reach = [[spread.mean - spread.low], [spread.high - spread.mean]]
    axes.errorbar(right, spread.mean, reach, color='k', capsize=3.0)
    spots = right + np.linspace(-0.4, 0.4, len(found)) * BAR
    axes.plot(spots, found, '.', color='0.25', ms=3.0, label='one pile')
    if gait in PLANAR:
        params = params_of(_task(outcome.plan, gait))
        for x, ground in ((left, HARD), (right, ROCKS)):
            mean, deviation = paper_figure(NAME, f'angle_{ground.replace(" ", "_")}', params)
            if mean is not None and ground in _paper_grounds(gait):
                style: dict[str, Any] = {'marker': 'D', 'mfc': 'w', 'mec': 'k', 'ms': 4.0}
                axes.errorbar(x, mean, deviation, color='k', label='paper, mean ± std', **style)


STUDY = Study(
    NAME,
    'Turning on a pile of rocks: angle per cycle, two cycles per trial',
    lambda plan: [_task(plan, gait) for gait in PLANAR],
    _rows,
    _draw,
    played=False,
    trials=_trials,
    records=_records,
)
