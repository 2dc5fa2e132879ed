"""Sines and cosines along a body: the shapes that two waves and their components are made of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

Array = NDArray[np.float64]

LEAST_K = 0.1  # fewer waves than that on a body look like a constant bend
MOST_K = 4.0
STEP_K = 0.02  # of the first look; the fit between is smooth


def largest_k(positions: int) -> float:
    """Most waves that so many body positions can show."""
    return min(MOST_K, 0.5 * positions)


def sine_basis(k: ArrayLike, positions: int) -> Array:
    """sin(2 pi k i/N) and cos(2 pi k i/N), i = 1..N, of each spatial frequency.

    Args:
        k: spatial frequencies, waves on the body, shape (..., K).
        positions: N.

    Returns:
        Columns sine, cosine, sine, ... shape (..., N, 2 K).
    """
    place = 2.0 * np.pi * np.arange(1, positions + 1) / positions
    angle = place[:, None] * np.asarray(k, float)[..., None, :]
    both = np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    return both.reshape(*both.shape[:-2], -1)


def explained_by(basis: Array, moments: Array) -> Array:
    """Sum of squares that the best combination of a basis' columns explains.

    Args:
        basis: shape (..., N, M), columns independent.
        moments: second moments of the data, X^T X, shape (N, N).

    Returns:
        tr((B^T B)^-1 B^T X^T X B), shape (...).
    """
    across = np.swapaxes(basis, -1, -2)
    shares = np.linalg.solve(across @ basis, across @ (moments @ basis))
    result: Array = np.trace(shares, axis1=-2, axis2=-1)
    return result


@cache
def _grid(positions: int) -> tuple[Array, Array]:
    """Spatial frequencies of the first look and the orthonormal bases of their sines."""
    k = np.arange(LEAST_K, largest_k(positions) + 0.5 * STEP_K, STEP_K)
    q, _ = np.linalg.qr(sine_basis(k[:, None], positions))
    return k, q


@dataclass(frozen=True, slots=True)
class SineFit:
    """A shape along the body as one sine and one cosine.

    Attributes:
        k: spatial frequency, waves on the body.
        k_std: its standard deviation by the fit's residual, taken as independent between body
            positions.
        sine: weight of sin(2 pi k i/N).
        cosine: weight of cos(2 pi k i/N).
        explained: share of the shape's sum of squares.
    """

    k: float
    k_std: float
    sine: float
    cosine: float
    explained: float

    def values(self, positions: int) -> Array:
        """The fitted shape, shape (N,)."""
        result: Array = sine_basis([self.k], positions) @ (self.sine, self.cosine)
        return result


def best_k(moments: Array, tolerance: float = 1e-5) -> float:
    """Spatial frequency whose sine and cosine explain most of a matrix of second moments.

    By variable projection: the weights follow from k, so one number is searched for.

    Args:
        moments: shape (N, N).
        tolerance: of k.
    """
    positions = moments.shape[0]
    grid, bases = _grid(positions)
    near = float(grid[((moments @ bases) * bases).sum(axis=(-2, -1)).argmax()])
    found = minimize_scalar(
        lambda k: -float(explained_by(sine_basis([k], positions), moments)),
        bounds=(max(near - STEP_K, LEAST_K), min(near + STEP_K, grid[-1])),
        method='bounded',
        options={'xatol': tolerance},
    )
    return float(found.x)


def fit_sine(shape: ArrayLike, k: float | None = None) -> SineFit:
    """Fit a sine and a cosine of one spatial frequency to a shape.

    Args:
        shape: values along the body, shape (N,).
        k: the spatial frequency, if it is given; found if not.
    """
    values = np.asarray(shape, float)
    if k is None:
        k = best_k(np.outer(values, values))
    basis = sine_basis([k], values.size)
    weights, *_ = np.linalg.lstsq(basis, values, rcond=None)
    residual = values - basis @ weights
    place = 2.0 * np.pi * np.arange(1, values.size + 1) / values.size
    slope = place * (weights[0] * basis[:, 1] - weights[1] * basis[:, 0])  # d shape / d k
    jacobian = np.column_stack([basis, slope])
    noise = residual @ residual / (values.size - 3)
    k_std = float(np.sqrt(noise * np.linalg.pinv(jacobian.T @ jacobian)[2, 2]))
    explained = 1.0 - residual @ residual / (values @ values)
    return SineFit(k, k_std, float(weights[0]), float(weights[1]), float(explained))
