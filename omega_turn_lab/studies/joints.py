"""Angle over k_t for robots of 6, 7 and 8 yaw joints (Sec. IV.G)."""

from __future__ import annotations

from omega_turn_lab.studies.study import Plan, k_grid
from omega_turn_lab.studies.sweeps import Sweep
from omega_turn_lab.studies.tasks import DesignTask


def _family(plan: Plan, n: float) -> list[DesignTask]:
    return [plan.design(k_t, n=int(n)) for k_t in k_grid(1.5)]


SWEEP = Sweep('joints', (6, 7, 8), _family, 'N {N}', '$N$ = {:g}')
STUDY = SWEEP.study('Body length: angle by number of yaw joints N')
