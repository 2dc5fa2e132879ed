"""Gaits beyond eq:prescribe_amp that turn most per second at a given peak joint speed.

A gait run at a uniform clock whose fastest joint just reaches the speed v turns by
v angle / (2 pi peak rate) per second, with the peak rate max |d theta_i / d phase|. Speed of
turning is what this search maximises; angle per cycle alone would reward hasty cycles.
"""

from __future__ import annotations

import math
from dataclasses import replace

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
from omega_turn_ros.gaits.fourier_gait import FourierGait

Array = NDArray[np.float64]

SCREENED = 40  # random candidates per start
FINE_STRIDE = 4


def design_fourier(
    problem: DesignProblem, seed: int = 0, starts: int = 32, harmonics: int = 2
) -> Design:
    """Find the Fourier gait that turns most per second at equal peak joint speed.

    Args:
        problem: the body, its ground and its limits.
        seed: equal seeds give equal gaits.
        starts: how many searches to begin with, at most.
        harmonics: of each of f_1, f_2 and f_3.

    Raises:
        BadInputError: no start or no harmonic, or no gait of this family turns.
    """
    if starts < 1 or harmonics < 1:
        raise BadInputError('starts, harmonics', (starts, harmonics), 'at least 1 each')
    terms = 2 * harmonics + 1
    rng = np.random.default_rng(seed)
    candidates = rng.normal(size=(SCREENED * starts, 3 * terms))
    fading = np.repeat(1.0 / np.arange(1, harmonics + 1) ** 2, 2)
    candidates *= np.tile(np.concatenate([[1.0], fading]), 3)
    candidates[:, 2 * terms] = rng.uniform(-np.pi, np.pi, SCREENED * starts)
    coarse = cost_of(problem, coefficients_of, _value)
    fine = cost_of(replace(problem, samples=FINE), coefficients_of, _value, FINE_STRIDE)
    likeness = likeness_of(problem, coefficients_of)
    found = search(coarse, fine, likeness, candidates, starts, seed)
    return finish(problem, gait_of(problem, found.best), found, 'fourier')


def _value(problem: DesignProblem, paths: Array) -> Array:
    return turning_speed(turns(problem, paths), paths)


def coefficients_of(x: Array) -> Coefficients:
    """Coefficients of F, T and L, which parameter vectors hold one after the other."""
    forward, turning, lag = np.split(x.T[:, :, None], 3)
    return tuple(forward), tuple(turning), tuple(lag)


def gait_of(problem: DesignProblem, x: Array) -> FourierGait:
    """Gait of the coefficients of F, T and L one after the other, at any scale."""
    terms = x.size // 3
    size = float(np.abs(x[: 2 * terms]).max()) + 1e-12
    forward, turning = x[:terms] / size, x[terms : 2 * terms] / size
    lag = x[2 * terms :].copy()
    lag[0] = math.remainder(lag[0], math.tau)
    series = (tuple(float(c) for c in s) for s in (forward, turning, lag))
    return FourierGait(problem.k_f, problem.k_t, *series)
