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

    Links that share a joint overlap as rectangles in any bend: how far a joint may go before its
    own two links touch is what the robot's position limit says.

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


def clear_scale(
    chain: PlanarChain, width: float, path: ArrayLike, tolerance: float, between: int
) -> float:
    """Largest factor up to 1 at which a path of shapes keeps the chain clear of itself.

    Args:
        chain: whose link lengths count.
        width: of every link [m].
        path: yaw joint angles [rad], shape (T, N).
        tolerance: how far below the largest factor the result may be.
        between: shapes looked at between two of the path, linearly interpolated, where the body
            comes close to itself.

    Returns:
        The factor; all of the scaled path is clear.
    """
    shapes = np.ascontiguousarray(path, dtype=float)
    return float(_clear_scale(chain.lengths, width, shapes, tolerance, between))


@njit(cache=True, nogil=True, error_model='numpy')
def _clearances(lengths, width, angles):  # type: ignore[no-untyped-def]
    n = lengths.size
    work = np.empty((4, n))
    result = np.empty(angles.shape[0])
    for b in range(angles.shape[0]):
        result[b] = _clearance(lengths, width, angles[b], angles[b], 0.0, 1.0, work)
    return result


@njit(cache=True, nogil=True, error_model='numpy')
def _clear_scale(lengths, width, path, tolerance, between):  # type: ignore[no-untyped-def]
    """Lower the scale shape by shape until a whole round of them is clear."""
    steps = path.shape[0] - 1
    work = np.empty((4, lengths.size))
    near = 0.1 * width
    stride = _scattering(steps + 1)
    scale, lowered = 1.0, True
    while lowered:
        lowered = False
        for k in range(steps + 1):
            i = (k * stride) % (steps + 1)  # neighbours ask for much the same: scatter them
            after = min(i + 1, steps)
            gap = _clearance(lengths, width, path[i], path[after], 0.0, scale, work)
            for j in range(between if gap < near else 1):
                share = j / between
                if j > 0:
                    gap = _clearance(lengths, width, path[i], path[after], share, scale, work)
                if gap < 0.0:
                    low, high = 0.0, scale  # a straight body is clear
                    while high - low > tolerance:
                        middle = 0.5 * (low + high)
                        gap = _clearance(lengths, width, path[i], path[after], share, middle, work)
                        if gap < 0.0:
                            high = middle
                        else:
                            low = middle
                    scale, lowered = low, True
    return scale


@njit(cache=True, nogil=True, error_model='numpy')
def _scattering(count):  # type: ignore[no-untyped-def]
    """Return a stride near the golden section that visits every one of `count` places."""
    stride = int(0.618 * count)
    while True:
        a, b = count, stride
        while b:
            a, b = b, a % b
        if a == 1:
            return stride
        stride += 1


@njit(cache=True, nogil=True, error_model='numpy')
def _clearance(lengths, width, start, end, share, scale, work):  # type: ignore[no-untyped-def]
    """Smallest gap of the shape that lies so far between two, scaled."""
    n = lengths.size
    x, y, c, s = work[0], work[1], work[2], work[3]
    angle = end_x = end_y = 0.0
    for i in range(n):
        if i > 0:
            angle += scale * (start[i - 1] + share * (end[i - 1] - start[i - 1]))
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
    return smallest


@njit(cache=True, nogil=True, error_model='numpy', inline='always')
def _gap(dx, dy, ci, si, cj, sj, li, lj, width):  # type: ignore[no-untyped-def]
    """Widest gap of two rectangles along the four axes of their sides."""
    cosine, sine = abs(ci * cj + si * sj), abs(ci * sj - si * cj)
    along_i = abs(dx * ci + dy * si) - 0.5 * (li + lj * cosine + width * sine)
    across_i = abs(dy * ci - dx * si) - 0.5 * (width + lj * sine + width * cosine)
    along_j = abs(dx * cj + dy * sj) - 0.5 * (lj + li * cosine + width * sine)
    across_j = abs(dy * cj - dx * sj) - 0.5 * (width + li * sine + width * cosine)
    return max(along_i, across_i, along_j, across_j)
