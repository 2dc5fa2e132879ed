"""Direct search over all parameters of eq:prescribe_amp at once.

Every candidate is scaled to the joint limit first, and further down where the body would meet
itself, so the search runs on feasible gaits only and needs no penalty (own derivation).
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.design.objective import (
    Coefficients,
    cost_of,
    finish,
    likeness_of,
    turning_speed,
    turns,
)
from omega_turn_ros.design.problem import FINE, Design, DesignProblem
from omega_turn_ros.design.search import search
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.mechanics.swept_area import swept_area_by_start

Array = NDArray[np.float64]

SCREENED = 40  # random candidates per start; the best become the starts
EXCESS = 30.0  # [rad per BL^2] what a gait above the area limit loses; no gait gains as much
AREA_STARTS, AREA_STRIDE = 4, 3  # of the cycle, the one that sweeps least counts; of its shapes
FINE_STRIDE = 4  # the last search keeps limits on the fine grid, and integrates every so many


def design_direct(
    problem: DesignProblem,
    seed: int = 0,
    starts: int = 32,
    area_limit: float = math.inf,
    per_second: bool = False,
) -> Design:
    """Find the two-wave gait of largest turn per cycle, or of those that sweep little.

    Args:
        problem: the body, its ground and its limits.
        seed: equal seeds give equal gaits.
        starts: how many searches to begin with, at most.
        area_limit: no larger area is swept than this, least over the start of the cycle [BL^2].
        per_second: maximise `turning_speed` instead of the turn per cycle.

    Raises:
        BadInputError: no start, a negative weight, or no gait of this family turns.
    """
    if starts < 1:
        raise BadInputError('starts', starts, 'at least 1')
    if not area_limit > 0.0:
        raise BadInputError('area_limit', area_limit, 'an area > 0 [BL^2]')

    limited = area_limit < math.inf
    if limited and per_second:
        raise BadInputError('area_limit', area_limit, 'none where turning speed is maximised')
    if limited and problem.samples % AREA_STRIDE:
        expected = f'a multiple of {AREA_STRIDE}, for a limit on area'
        raise BadInputError('samples', problem.samples, expected)
    value = partial(_value, area_limit=area_limit, per_second=per_second)
    rng = np.random.default_rng(seed)
    candidates = rng.uniform(-1.0, 1.0, size=(SCREENED * starts, 6))
    candidates[:, 3:] = rng.uniform(-np.pi, np.pi, (SCREENED * starts, 3))
    coarse = cost_of(problem, coefficients_of, value)
    fine = cost_of(replace(problem, samples=FINE), coefficients_of, value, FINE_STRIDE)
    likeness = likeness_of(problem, coefficients_of)
    found = search(coarse, fine, likeness, candidates, starts, seed)
    return finish(problem, gait_of(problem, found.best), found, 'direct')


def _value(problem: DesignProblem, paths: Array, area_limit: float, per_second: bool) -> Array:
    angles = turns(problem, paths)
    if per_second:
        return turning_speed(angles, paths)
    if area_limit == math.inf:
        return angles
    few = paths[:, ::AREA_STRIDE]
    poses = [problem.motion.pose_along(path)[::AREA_STRIDE] for path in paths]
    least = [
        swept_area_by_start(problem.chain, *pair, AREA_STARTS).min() for pair in zip(few, poses)
    ]
    return angles - EXCESS * np.maximum(np.array(least) - area_limit, 0.0)


def coefficients_of(x: Array) -> Coefficients:
    """Eq:prescribe_amp as series, of parameters (a_f gamma, a_f, a_o, phi_f, phi_o, psi)."""
    mean, swing, turning, phi_f, phi_o, psi = x.T[:, :, None]
    forward = (mean, swing * np.sin(phi_f), swing * np.cos(phi_f))
    return forward, (turning, turning * np.sin(phi_o), turning * np.cos(phi_o)), (psi,)


def gait_of(problem: DesignProblem, x: Array) -> TwoWaveGait:
    """Gait of the parameters (a_f gamma, a_f, a_o, phi_f, phi_o, psi), at any scale."""
    size = float(np.abs(x[:3]).max()) + 1e-12
    mean, swing, turning = (float(v) / size for v in x[:3])
    swing = math.copysign(max(abs(swing), 1e-6), swing)  # gamma stays finite
    phi_f, phi_o, psi = (math.remainder(float(v), math.tau) for v in x[3:])
    return TwoWaveGait(problem.k_f, problem.k_t, swing, mean / swing, phi_f, turning, phi_o, psi)
