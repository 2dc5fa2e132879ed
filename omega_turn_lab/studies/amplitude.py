"""Angle over k_t for three joint angle limits (Sec. IV.E)."""

from __future__ import annotations

from omega_turn_lab.studies.rows import Row, row_of
from omega_turn_lab.studies.study import Outcome, Plan, Study, k_grid
from omega_turn_lab.studies.sweeps import Sweep, case_name
from omega_turn_lab.studies.tasks import DesignTask

NAME = 'amplitude'
LIMITS_DEG = (60.0, 75.0, 90.0)


def _family(plan: Plan, limit_deg: float) -> list[DesignTask]:
    return [plan.design(k_t, theta_max_deg=limit_deg) for k_t in k_grid(1.5)]


SWEEP = Sweep(NAME, LIMITS_DEG, _family, 'limit {theta_max_deg:g}°', 'limit {:g}°')


def _rows(outcome: Outcome) -> list[Row]:
    """Angles, best k_t, and how far the limit modulates each turn: the paper's 'tunable range'."""
    rows = SWEEP.rows(outcome)
    smallest, largest = (_family(outcome.plan, limit) for limit in (LIMITS_DEG[0], LIMITS_DEG[-1]))
    for low, high in zip(smallest, largest):
        (theory_low, played_low), (theory_high, played_high) = map(outcome.angles, (low, high))
        physics = None
        if played_low is not None and played_high is not None:
            physics = played_high - played_low
        case = case_name(high, f'limit {LIMITS_DEG[0]:g} to {LIMITS_DEG[-1]:g}°')
        ours = (theory_high - theory_low, physics)
        rows.append(row_of(NAME, case, high, 'angle_range', 'deg', ours))
    return rows


STUDY = Study(
    NAME, 'Amplitude modulation: angle by joint angle limit', SWEEP.designs, _rows, SWEEP.draw
)
