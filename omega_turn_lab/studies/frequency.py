"""Angle over k_t for three forward waves (Sec. IV.F)."""

from __future__ import annotations

from omega_turn_lab.studies.study import Plan, k_grid
from omega_turn_lab.studies.sweeps import Sweep
from omega_turn_lab.studies.tasks import DesignTask


def _family(plan: Plan, k_f: float) -> list[DesignTask]:
    return [plan.design(k_t, k_f=k_f) for k_t in k_grid(k_f)]


SWEEP = Sweep('frequency', (1.0, 1.5, 2.0), _family, 'k_f {k_f:g}', '$k_f$ = {:g}')
STUDY = SWEEP.study('Forward wave: angle by spatial frequency k_f')
