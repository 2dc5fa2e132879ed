"""Fitting the two-wave template (eq:template) to recorded postures.

    theta_i(t) = A_f(t) sin(tau_f(t) + 2 pi k_f i/N) + A_t(t) sin(tau_t(t) + 2 pi k_t i/N) + b_i

In each frame both waves have an amplitude and a phase of their own (four numbers), so nothing is
presumed about a common clock; k_f and k_t are the same in all frames. By convention the turning
wave is the longer one. b_i is that part of the mean posture which no such waves can make: a worm's
rest posture. The fit needs no sines among the principal components, which are orthogonal, where
waves of neighbouring k are not (own derivation).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from omega_turn_ros.worm.sines import LEAST_K, explained_by, largest_k, sine_basis

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

# Waves closer than that are one wave whose amplitude changes along the body: noise in their
# amplitudes is that of the angles times four and more.
LEAST_APART = 0.25
STEP = 0.05  # of the first look


@dataclass(frozen=True, slots=True)
class Wave:
    """One wave in one trial.

    Attributes:
        k: spatial frequency, waves on the body.
        signal: A exp(i tau) [rad], shape (T,).
        fps: frames per second.
    """

    k: float
    signal: Complex
    fps: float

    @property
    def amplitude(self) -> Array:
        """A, never negative [rad], shape (T,)."""
        return np.abs(self.signal)

    @property
    def phase(self) -> Array:
        """Tau, continuous [rad], shape (T,)."""
        return np.unwrap(np.angle(self.signal))

    @property
    def frequency(self) -> float:
        """Cycles per second in either direction, median over the wave's power [Hz]."""
        steps, power = self._steps()
        order = np.argsort(np.abs(steps))
        total = np.cumsum(power[order])
        middle = order[np.searchsorted(total, 0.5 * total[-1])]
        return float(abs(steps[middle]) * self.fps / (2.0 * np.pi))

    @property
    def backward_share(self) -> float:
        """Share of the wave's power that travels from head to tail, as in crawling forward."""
        steps, power = self._steps()
        return float(power[steps < 0.0].sum() / power.sum())

    def _steps(self) -> tuple[Array, Array]:
        """Phase step between frames [rad] and the power it is worth."""
        turned = self.signal[1:] * self.signal[:-1].conj()
        return np.angle(turned), np.abs(turned)

    def angles(self, positions: int) -> Array:
        """The wave's joint angles [rad], shape (T, positions)."""
        parts = np.column_stack([self.signal.real, self.signal.imag])
        return parts @ sine_basis([self.k], positions).T


@dataclass(frozen=True, slots=True)
class TwoWaves:
    """The template fitted to pooled trials.

    Attributes:
        k_t: spatial frequency of the turning wave.
        k_f: spatial frequency of the forward wave, the larger one.
        explained: share of the variance about the mean posture that the waves explain.
        distinct: False where k_f - k_t ended at its lower bound: a single wave with an amplitude
            that changes along the body explains these frames as well.
        turning: the turning wave in each trial.
        forward: the forward wave in each trial.
        residual: of each trial, what waves and rest posture leave [rad], shape (T, N).
    """

    k_t: float
    k_f: float
    explained: float
    distinct: bool
    turning: tuple[Wave, ...]
    forward: tuple[Wave, ...]
    residual: tuple[Array, ...]


def fit_two_waves(
    postures: Sequence[Array],
    angles: Sequence[Array],
    fps: float,
    pair: tuple[float, float] | None = None,
) -> TwoWaves:
    """Fit the template to pooled trials by least squares.

    The spatial frequencies follow from the postures about their mean, since a rest posture is no
    wave. The amplitudes follow from the angles themselves: the mean over a turn of waves whose
    amplitudes change is not zero, and belongs to the waves.

    Args:
        postures: of each trial, as `centred` returns them [rad], shape (T, N).
        angles: the joint angles themselves [rad], likewise.
        fps: frames per second.
        pair: (k_t, k_f) if they are given; found if not.
    """
    moments = sum(x.T @ x for x in postures)
    k_t, k_f = best_pair(moments) if pair is None else pair
    positions = moments.shape[0]
    basis = sine_basis([k_t, k_f], positions)
    solve = np.linalg.pinv(basis)
    turning, forward, residual = [], [], []
    for raw in angles:
        parts = raw @ solve.T
        turning.append(Wave(k_t, parts[:, 0] + 1j * parts[:, 1], fps))
        forward.append(Wave(k_f, parts[:, 2] + 1j * parts[:, 3], fps))
        left = raw - parts @ basis.T
        residual.append(left - left.mean(axis=0))
    explained = float(explained_by(basis, moments) / np.trace(moments))
    distinct = k_f - k_t > LEAST_APART + 1e-3
    parts_of = (tuple(turning), tuple(forward), tuple(residual))
    return TwoWaves(k_t, k_f, explained, distinct, *parts_of)


def best_pair(
    moments: Array, start: tuple[float, float] | None = None, tolerance: float = 1e-5
) -> tuple[float, float]:
    """Spatial frequencies k_t < k_f of the two waves that explain most.

    By variable projection: everything else follows linearly from the two numbers.

    Args:
        moments: second moments of the postures, shape (N, N).
        start: where to look; all over if not given.
        tolerance: of both.
    """
    positions = moments.shape[0]
    most = largest_k(positions)
    if start is None:
        grid = np.arange(LEAST_K, most + 1e-9, STEP)
        k_t, k_f = np.meshgrid(grid, grid, indexing='ij')
        pairs = np.column_stack([k_t.ravel(), k_f.ravel()])
        pairs = pairs[pairs[:, 1] - pairs[:, 0] >= LEAST_APART - 1e-9]
        share = explained_by(sine_basis(pairs, positions), moments)
        start = tuple(pairs[share.argmax()].tolist())
    scale = float(np.trace(moments))

    def left_over(x: Array) -> float:
        basis = sine_basis([x[0], x[0] + x[1]], positions)
        return 1.0 - float(explained_by(basis, moments)) / scale

    found = minimize(
        left_over,
        (start[0], max(start[1] - start[0], LEAST_APART)),
        method='Nelder-Mead',
        bounds=((LEAST_K, most), (LEAST_APART, most)),
        options={'xatol': tolerance, 'fatol': tolerance**2},
    )
    return float(found.x[0]), float(found.x[0] + found.x[1])
