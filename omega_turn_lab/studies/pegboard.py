"""Turning among pegs, open loop and compliant (Sec. IV.H, compliant omega turn).

Each placement of the lattice is tried in every mode, so modes are compared in pairs. The paper
prints no numbers for this experiment, only the claim that compliance turns some 30 % further and
spreads less at every spacing.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_lab.studies.peg_pictures import draw_pegboard
from omega_turn_lab.studies.rows import Row, params_of
from omega_turn_lab.studies.spread import spread_of
from omega_turn_lab.studies.study import Outcome, Plan, Study
from omega_turn_lab.studies.tasks import DesignTask, Result
from omega_turn_ros.compliance.admittance import AdmittanceConfig
from omega_turn_ros.compliance.controller import ComplianceConfig
from omega_turn_ros.compliance.external_torque import TorqueConfig
from omega_turn_sim_bridge.terrain_config import TerrainConfig, load_terrain

NAME = 'pegboard'
SPACINGS_BL = (0.2, 0.3, 0.4, 0.5, 0.6)
PLACEMENTS = 20
UNBOUNDED = AdmittanceConfig(offset_limit=1.2)  # the paper bounds no offset
PEER = AdmittanceConfig((0.1, 0.1), (3.0, 3.0), (3.0, 3.0), offset_limit=1.2)
QUICK = TorqueConfig(dead_band=0.1)  # the paper knows no dead band; ours tells pegs from noise
OPEN, PUSHING, GENTLE = 'open loop', 'pushing', 'gentle yielding'


def _yielding(
    scale: tuple[float, float], torque: TorqueConfig = QUICK, law: AdmittanceConfig = UNBOUNDED
) -> ComplianceConfig:
    return ComplianceConfig(torque_scale=scale, law=law, torque=torque)


MODES: dict[str, ComplianceConfig | None] = {
    OPEN: None,
    # What holds a wave firmly makes it push harder, up to a bound: the default, for it pays.
    PUSHING: ComplianceConfig(),
    # M, B, K of the paper read straight: an outside push moves the amplitudes the way it pushes.
    'yielding': _yielding((1.0, 1.0)),
    # A third of it, within the default's bound: what pays where pegs leave no room to push.
    GENTLE: _yielding((0.3, 0.3), law=AdmittanceConfig()),
    'forward wave yielding': _yielding((1.0, 0.0)),
    # The paper's gain with the efforts taken as they are: the ground's friction counts as a push.
    'yielding, raw efforts': _yielding((1.0, 1.0), TorqueConfig(friction=0.0, dead_band=0.0)),
    # Constants of the public shape-compliance controller kmkar31/snakelib.
    "snakelib's constants": _yielding((1.0, 1.0), law=PEER),
}
COMPARED = (OPEN, PUSHING, GENTLE)
LASTING = (PUSHING, 'yielding')  # tried in a long jam
PICTURED = 0.3  # [BL]
LONG, LONG_PERIOD, TIGHT = 50, 5.0, 0.2  # cycles, their period [s] and spacing [BL] of a long jam


def trial(outcome: Outcome, spacing: float, mode: str, seed: int) -> ObstacleTrial:
    """One turn of two cycles among pegs, `spacing` body lengths apart."""
    ground = {**asdict(load_terrain('pegboard')), 'spacing_bl': spacing}
    gait = outcome.gait(_task(outcome.plan))
    terrain = TerrainConfig(**ground)
    return ObstacleTrial(outcome.plan.robot, gait, terrain, seed, MODES[mode])


def _task(plan: Plan) -> DesignTask:
    return plan.design(1.0)


def _on_open_ground(outcome: Outcome, mode: str) -> ObstacleTrial:
    plan = outcome.plan
    return ObstacleTrial(plan.robot, outcome.gait(_task(plan)), compliance=MODES[mode])


def _long_jam(outcome: Outcome, mode: str) -> ObstacleTrial:
    short = trial(outcome, TIGHT, mode, 0)
    return replace(short, cycles=LONG, period=LONG_PERIOD)


def _trials(outcome: Outcome) -> list[ObstacleTrial]:
    # Placement by placement, so that an interrupted run has a little of everything.
    among_pegs = [
        trial(outcome, spacing, mode, seed)
        for seed in range(PLACEMENTS)
        for spacing in SPACINGS_BL
        for mode in MODES
    ]
    free = [_on_open_ground(outcome, mode) for mode in COMPARED]
    return [*free, *(_long_jam(outcome, mode) for mode in LASTING), *among_pegs]


def angles(outcome: Outcome, spacing: float, mode: str) -> list[float]:
    """Mean angle per cycle of each placement [deg]."""
    return [
        outcome.tried[trial(outcome, spacing, mode, seed)]['angle_deg']
        for seed in range(PLACEMENTS)
    ]


def _rows(outcome: Outcome) -> list[Row]:
    task = _task(outcome.plan)
    params = params_of(task)
    theory = outcome.designed[task]['angle_deg']
    rows = []
    for mode in COMPARED:
        free = outcome.tried.get(_on_open_ground(outcome, mode))
        played = None if free is None else free['angle_deg']
        rows.append(
            Row(f'open ground, {mode}', params, 'angle', 'deg', None, None, theory, played)
        )
    if not outcome.tried:
        return rows
    for spacing in SPACINGS_BL:
        for mode in MODES:
            rows += _mode_rows(outcome, spacing, mode, {**params, 'spacing_bl': spacing})
    return [*rows, *_account_rows(outcome, params)]


def _account_rows(outcome: Outcome, params: dict[str, float]) -> list[Row]:
    """What must hold in every trial: limits, and no energy but what efforts bring in."""
    long = [outcome.tried[_long_jam(outcome, mode)] for mode in LASTING]
    every = [outcome.tried[task] for task in _trials(outcome)]
    accounts = {
        ('all trials', 'limits_broken', '1'): sum(r['limits_broken'] for r in every),
        ('all trials', 'largest_energy_excess', 'N m'): max(
            r['energy']['largest_excess'] for r in every
        ),
        ('all trials', 'deepest_contact', 'mm'): 1e3 * max(r['deepest_contact'] for r in every),
        (f'{LONG} cycles in a jam', 'largest_offset', 'rad'): max(
            max(r['largest_offsets']) for r in long
        ),
    }
    return [
        Row(case, params, quantity, unit, None, None, None, float(value))
        for (case, quantity, unit), value in accounts.items()
    ]


def _mode_rows(outcome: Outcome, spacing: float, mode: str, params: dict[str, float]) -> list[Row]:
    """Angle of a mode, and what it gains over open loop on the same placements."""
    case = f'{spacing:g} BL, {mode}'
    found = angles(outcome, spacing, mode)
    spread = spread_of(found, outcome.plan.seed)
    numbers = {('angle', 'deg'): spread.mean, ('angle_std', 'deg'): spread.deviation}
    if mode != OPEN:
        without = angles(outcome, spacing, OPEN)
        gain = spread_of([b - a for a, b in zip(without, found)], outcome.plan.seed)
        numbers[('gain', 'deg')] = gain.mean
        numbers[('gain_low', 'deg')] = gain.low
        numbers[('gain_high', 'deg')] = gain.high
        mean = sum(without) / len(without)
        if mean > 0.0:
            numbers[('ratio', '1')] = spread.mean / mean
    return [
        Row(case, params, quantity, unit, None, None, None, value)
        for (quantity, unit), value in numbers.items()
    ]


def _record(task: ObstacleTrial, result: Result) -> dict[str, Any]:
    """A trial without its motion."""
    kept = {k: v for k, v in result.items() if k not in ('time', 'poses', 'yaw_angles')}
    mode = next(name for name, config in MODES.items() if config == task.compliance)
    kind, spacing = task.terrain.kind, task.terrain.spacing_bl
    where = {'terrain': kind, 'spacing_bl': spacing if kind == 'pegboard' else None}
    return {**where, 'mode': mode, 'seed': task.seed, 'cycles': task.cycles, **kept}


def _records(outcome: Outcome) -> list[dict[str, Any]]:
    if not outcome.tried:
        return []
    return [_record(task, outcome.tried[task]) for task in _trials(outcome)]


def _typical_placement(outcome: Outcome, spacing: float) -> int:
    """Placement whose gain comes nearest to the mean gain."""
    without, found = (angles(outcome, spacing, mode) for mode in (OPEN, PUSHING))
    gains = [b - a for a, b in zip(without, found)]
    mean = sum(gains) / len(gains)
    return min(range(len(gains)), key=lambda seed: abs(gains[seed] - mean))


def _draw(outcome: Outcome, out: Path) -> None:
    if not outcome.tried:
        return
    seed = outcome.plan.seed
    curves = {
        mode: [spread_of(angles(outcome, s, mode), seed) for s in SPACINGS_BL] for mode in MODES
    }
    free = outcome.tried[_on_open_ground(outcome, OPEN)]['angle_deg']
    typical = _typical_placement(outcome, PICTURED)
    pictured = {mode: trial(outcome, PICTURED, mode, typical) for mode in COMPARED}
    motions = {mode: (task, outcome.tried[task]) for mode, task in pictured.items()}
    draw_pegboard(out / f'{NAME}.png', SPACINGS_BL, curves, COMPARED, free, motions)


STUDY = Study(
    NAME,
    'Omega turn among pegs: angle per cycle, two cycles per trial',
    lambda plan: [_task(plan)],
    _rows,
    _draw,
    played=False,
    trials=_trials,
    records=_records,
)
