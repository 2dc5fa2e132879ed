"""Which principal components make a travelling wave together: quadrature in space and time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import hilbert

from omega_turn_ros.worm.components import Components
from omega_turn_ros.worm.sines import best_k, fit_sine

Array = NDArray[np.float64]

TRAVELS = 0.5  # quality from which a pair counts as one travelling wave
CYCLES = 2.0  # length of the windows in which quadrature in time is looked at


@dataclass(frozen=True, slots=True)
class WavePair:
    """Two components held against a travelling wave A sin(tau(t) + 2 pi k i/N).

    Attributes:
        components: their indices, counted from 0.
        k: spatial frequency that suits both best.
        explained: share of both shapes that sines and cosines of that k explain.
        space_phase: of the second shape behind the first [rad]; a wave has +-pi/2.
        space_quadrature: 0 (in phase) to 1 (a quarter wave apart and equally strong).
        time_quadrature: the same of the scores in time, 0 to 1, in windows of two cycles.
        variance: share of the variance that both explain.
    """

    components: tuple[int, int]
    k: float
    explained: float
    space_phase: float
    space_quadrature: float
    time_quadrature: float
    variance: float

    @property
    def quality(self) -> float:
        """How nearly the pair is one travelling wave, 0 to 1."""
        return self.explained * self.space_quadrature * self.time_quadrature

    @property
    def travels(self) -> bool:
        """Whether the pair counts as one travelling wave."""
        return self.quality >= TRAVELS


def pair_components(components: Components, fps: float) -> list[WavePair]:
    """Pair all components so that the pairs are as nearly travelling waves as they can be.

    Every way to pair them is tried; the one with the largest sum of qualities wins. Of an odd
    number the last component stays alone.

    Args:
        components: of pooled trials.
        fps: frames per second.

    Returns:
        The pairs, the strongest first.
    """
    window = max(8, round(CYCLES * fps / typical_frequency(components.scores, fps)))
    count = components.shapes.shape[0]
    analytic = [hilbert(scores, axis=0) for scores in components.scores]
    pairs = {
        (p, q): _pair(components, p, q, time_quadrature(analytic, p, q, window))
        for p in range(count)
        for q in range(p + 1, count)
    }
    ways = list(_matchings(list(range(count - count % 2))))
    best = max(ways, key=lambda way: sum(pairs[pair].quality for pair in way))
    return sorted((pairs[pair] for pair in best), key=lambda pair: -pair.variance)


def _matchings(items: list[int]) -> Iterator[list[tuple[int, int]]]:
    if not items:
        yield []
    for k in range(1, len(items)):
        for rest in _matchings(items[1:k] + items[k + 1 :]):
            yield [(items[0], items[k]), *rest]


def _pair(components: Components, p: int, q: int, in_time: float) -> WavePair:
    first, second = components.shapes[p], components.shapes[q]
    k = best_k(np.outer(first, first) + np.outer(second, second))
    fits = fit_sine(first, k), fit_sine(second, k)
    a, b = (complex(fit.cosine, -fit.sine) for fit in fits)  # shape = Re(a exp(2 pi i k s))
    cross = b * a.conjugate()
    return WavePair(
        (p, q),
        k,
        0.5 * (fits[0].explained + fits[1].explained),
        math.atan2(cross.imag, cross.real),
        2.0 * abs(cross.imag) / (abs(a) ** 2 + abs(b) ** 2),
        in_time,
        float(components.variance[p] + components.variance[q]),
    )


def time_quadrature(analytic: Sequence[NDArray[np.complex128]], p: int, q: int, n: int) -> float:
    """How nearly two scores are a quarter cycle apart, ahead or behind, 0 to 1.

    In windows, since an animal that reverses changes which one is ahead; windows count by their
    power.

    Args:
        analytic: analytic signals of the scores, one array per trial, shape (T, M).
        p: one component.
        q: the other.
        n: frames per window; windows overlap by half.
    """
    apart = power = 0.0
    for signals in analytic:
        a, b = signals[:, p], signals[:, q]
        for start in range(0, max(1, len(a) - n // 2), max(1, n // 2)):
            x, y = a[start : start + n], b[start : start + n]
            strength = math.sqrt(float((abs(x) ** 2).sum() * (abs(y) ** 2).sum()))
            apart += abs(float(np.sum(x * y.conj()).imag))
            power += strength
    return apart / power if power > 0.0 else 0.0


def typical_frequency(scores: Sequence[Array], fps: float) -> float:
    """Frequency below which half the power of the scores lies [Hz].

    Args:
        scores: of each trial, shape (T, M).
        fps: frames per second.
    """
    longest = max(len(x) for x in scores)
    power = np.zeros(longest // 2 + 1)
    for x in scores:
        power += (np.abs(np.fft.rfft(x, longest, axis=0)) ** 2).sum(axis=1)
    total = np.cumsum(power)
    place = int(np.searchsorted(total, 0.5 * total[-1]))
    return float(max(place, 1) * fps / longest)
