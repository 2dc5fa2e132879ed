"""How sure the spatial frequencies are: the same analysis on resampled recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from omega_turn_ros.worm.components import eigen_postures
from omega_turn_ros.worm.sines import best_k
from omega_turn_ros.worm.template import best_pair

Array = NDArray[np.float64]

FEWEST_BLOCKS = 8
SAMPLES = 200
TOLERANCE = 1e-3  # of each fit, far below the spread of them


@dataclass(frozen=True, slots=True)
class Spread:
    """Results of resampled recordings, one row each.

    Attributes:
        pair: (k_t, k_f), shape (S, 2).
        component_k: spatial frequency of each component, shape (S, M).
        explained: share of the variance that the first M components explain, shape (S,).
        block: frames per block.
    """

    pair: Array
    component_k: Array
    explained: Array
    block: int


def resample(
    postures: Sequence[Array],
    shapes: Array,
    pair: tuple[float, float],
    period: float,
    seed: int = 0,
    samples: int = SAMPLES,
) -> Spread:
    """Repeat the fits on recordings put together from blocks drawn at random (block bootstrap).

    A block is one period of the undulation, since frames within it are not independent, or an
    eighth of all frames where that is shorter; it never spans two trials.

    Args:
        postures: of each trial, as `centred` returns them [rad], shape (T, N).
        shapes: the components, shape (M, N); those of a resampled recording are told by the ones
            they resemble most.
        pair: (k_t, k_f) of the recording.
        period: of the undulation [frames].
        seed: equal seeds give equal results.
        samples: S.
    """
    frames = sum(len(x) for x in postures)
    block = max(1, min(round(period), frames // FEWEST_BLOCKS))
    moments = np.array([b.T @ b for x in postures for b in _blocks(x, block)])
    rng = np.random.default_rng(seed)
    count = shapes.shape[0]
    pairs, ks, explained = [], [], []
    for _ in range(samples):
        drawn = moments[rng.integers(len(moments), size=len(moments))].sum(axis=0)
        variance, found = eigen_postures(drawn, count)
        _, order = linear_sum_assignment(-np.abs(shapes @ found.T))
        ks.append([best_k(np.outer(found[k], found[k]), TOLERANCE) for k in order])
        pairs.append(best_pair(drawn, pair, TOLERANCE))
        explained.append(variance[:count].sum())
    return Spread(np.array(pairs), np.array(ks), np.array(explained), block)


def _blocks(posture: Array, length: int) -> list[Array]:
    """Parts of about that length, all of the trial together."""
    count = max(1, round(len(posture) / length))
    return np.array_split(posture, count)
