"""How far a chain of real, wide links stays clear of itself."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain

Array = NDArray[np.float64]


def self_clearance(chain: PlanarChain, width: float, angles: ArrayLike) -> Array:
    """Smallest gap between links that do not share a joint, seen as rectangles.

    The gap of a pair is the widest along the axes of either rectangle (separating axis theorem):
    positive, a lower bound of the distance; negative, the depth of the overlap.

    Args:
        chain: whose link lengths count.
        width: of every link [m].
        angles: yaw joint angles [rad], shape (..., N).

    Returns:
        Gap [m], shape (...); infinite for a chain of two links.

    Raises:
        BadInputError: the width is not positive, or the last axis is not N.
    """
    if not np.isfinite(width) or width <= 0.0:
        raise BadInputError('width', width, 'a finite width > 0 [m]')
    q = np.asarray(angles, float)
    if q.ndim < 1 or q.shape[-1] != chain.n_joints:
        raise BadInputError('angles', q.shape, f'shape (..., {chain.n_joints})')
    flat = np.ascontiguousarray(q.reshape(-1, chain.n_joints))
    result: Array = _clearances(chain.lengths, width, flat).reshape(q.shape[:-1])
    return result


@njit(cache=True, nogil=True, error_model='numpy')
def _clearances(lengths, width, angles):  # type: ignore[no-untyped-def]
    n = lengths.size
    x, y, c, s = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    result = np.empty(angles.shape[0])
    for b in range(angles.shape[0]):
        angle = end_x = end_y = 0.0
        for i in range(n):
            if i > 0:
                angle += angles[b, i - 1]
            c[i], s[i] = cos(angle), sin(angle)
            x[i], y[i] = end_x - 0.5 * lengths[i] * c[i], end_y - 0.5 * lengths[i] * s[i]
            end_x, end_y = end_x - lengths[i] * c[i], end_y - lengths[i] * s[i]
        smallest = np.inf
        for i in range(n):
            for j in range(i + 2, n):
                dx, dy = x[j] - x[i], y[j] - y[i]
                reach = 0.5 * (lengths[i] + lengths[j]) + width + max(smallest, 0.0)
                if dx * dx + dy * dy < reach * reach:
                    gap = _gap(dx, dy, c[i], s[i], c[j], s[j], lengths[i], lengths[j], width)
                    smallest = min(smallest, gap)
        result[b] = smallest
    return result


@njit(cache=True, nogil=True, error_model='numpy', inline='always')
def _gap(dx, dy, ci, si, cj, sj, li, lj, width):  # type: ignore[no-untyped-def]
    """Widest gap of two rectangles along the four axes of their sides."""
    cosine, sine = abs(ci * cj + si * sj), abs(ci * sj - si * cj)
    along_i = abs(dx * ci + dy * si) - 0.5 * (li + lj * cosine + width * sine)
    across_i = abs(dy * ci - dx * si) - 0.5 * (width + lj * sine + width * cosine)
    along_j = abs(dx * cj + dy * sj) - 0.5 * (lj + li * cosine + width * sine)
    across_j = abs(dy * cj - dx * sj) - 0.5 * (width + li * sine + width * cosine)
    return max(along_i, across_i, along_j, across_j)
