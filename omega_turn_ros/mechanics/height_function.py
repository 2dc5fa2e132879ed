"""Height functions: how far closed paths in a plane of shapes take the body (eq:stokes).

A plane r = (r_1, r_2) may be flat, a cylinder (r_1 cyclic) or a torus (both cyclic). With the
connection A = (A_1, A_2) and the height function h = dA_2/dr_1 - dA_1/dr_2, any closed path obeys

    line = surface + w_1 loop_1 + w_2 loop_2

for each of the three rows (own derivation from Green's theorem), where

    line    = integral of A dr along the path                                (eq:lineintegral)
    surface = -(integral of H dr_1 along the path),  H = integral of h(r_1, s) ds, s from c to r_2
    loop_1  = integral of A_1(s, c) ds over a period: along the reference line r_2 = c
    loop_2  = integral of A_2(b, s) ds over a period: along r_1 = b, where the path starts

and w_1, w_2 count how often the path, given unwrapped, winds around each cyclic axis.

- Flat, w = (0, 0): `surface` is the integral of h over what the path encloses, counter-clockwise.
- Cylinder, w = (1, 0): `surface` is minus the integral of h between reference line and path, and
  loop_1 is what happens on the reference line. In the paper that line is A = 0 (dashed), where one
  wave is absent and the other goes its way.
- Torus, w = (1, 1), path r_2 = r_1 + psi with 0 <= psi < 2 pi: since h adds up to 0 over the
  torus, `surface` is the integral of h over the triangle above the path in the square [0, 2 pi]^2
  (upper left corner) minus that over the triangle below it (lower right corner). The paper counts
  the other way round, a matter of the sign of h, and leaves out the two loops, the lower and the
  left edge of the square, which do not depend on psi.

The rotation row is exact for any path; the other two take the body as if it did not turn.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.shape_grid import PERIOD, GridFunction, ShapeAxis

Array = NDArray[np.float64]

ROTATION = 2  # row of the connection


@dataclass(frozen=True)
class ConnectionField:
    """A local connection on a grid in a plane of shapes.

    Attributes:
        axes: of r_1 and r_2.
        matrix: A, rows x, y [m/rad] and rotation [rad/rad] in the mean body frame, columns r_1 and
            r_2, shape (n_1, n_2, 3, 2).
        misfit: of the linear fit, see `LocalConnection` [-], shape (n_1, n_2).
    """

    axes: tuple[ShapeAxis, ShapeAxis]
    matrix: Array
    misfit: Array

    def __post_init__(self) -> None:
        """Refuse a table that does not fit its axes."""
        expected = (self.axes[0].values.size, self.axes[1].values.size, 3, 2)
        if self.matrix.shape != expected:
            raise BadInputError('matrix', self.matrix.shape, f'shape {expected}')

    @cached_property
    def height(self) -> Array:
        """Height function h of each row, x, y [m/rad^2], rotation [1/rad], (n_1, n_2, 3)."""
        by_first = self.axes[0].derivative(self.matrix[..., 1], axis=0)
        return by_first - self.axes[1].derivative(self.matrix[..., 0], axis=1)

    def integrated_height(self, reference: float = 0.0, row: int = ROTATION) -> IntegratedHeight:
        """H of the identity above, for c = `reference` [rad] and a row of the connection."""
        return IntegratedHeight(self.axes, self.height[..., row], reference)

    def surface(self, path: ArrayLike, reference: float = 0.0, row: int = ROTATION) -> float:
        """Surface term of the identity above [m] or [rad].

        Args:
            path: closed path, unwrapped, both ends given [rad, rad], shape (T + 1, 2).
            reference: c [rad].
            row: of the connection.

        Raises:
            BadInputError: the path is open, winds around an open axis or leaves the grid.
        """
        r = _closed(path, self.axes)[0]
        return float(self.integrated_height(reference, row).surface(r[:, 0], r[:, 1]))

    def loops(self, path: ArrayLike, reference: float = 0.0, row: int = ROTATION) -> float:
        """w_1 loop_1 + w_2 loop_2 of the identity above [m] or [rad]. Arguments as `surface`."""
        r, windings = _closed(path, self.axes)
        total = 0.0
        for k, other in enumerate((reference, r[0, 0])):
            if windings[k] != 0:
                table = GridFunction(self.axes, self.matrix[..., row, k])
                place = [self.axes[k].values, np.array(other)]
                # The mean of evenly spaced values is an accurate integral over a period.
                total += windings[k] * PERIOD * float(table(*place[:: 1 - 2 * k]).mean())
        return total


class IntegratedHeight:
    """H(r_1, r_2): a height function integrated over r_2 from a reference line on.

    Args:
        axes: of r_1 and r_2.
        height: of one row, shape (n_1, n_2).
        reference: c, where H is 0 [rad].
    """

    def __init__(
        self, axes: tuple[ShapeAxis, ShapeAxis], height: Array, reference: float = 0.0
    ) -> None:
        first, second = axes
        # What a full period adds grows linearly; the rest is periodic and can be tabulated.
        mean = height.mean(axis=1, keepdims=True) * second.cyclic
        table = second.antiderivative(height - mean, axis=1)
        start = GridFunction(axes, table)(first.values, reference)[:, None]
        self._reference = reference
        self._bounded = GridFunction(axes, table - start)
        self._rise = first.interpolator(mean[:, 0]) if second.cyclic else None

    def __call__(self, first: ArrayLike, second: ArrayLike) -> Array:
        """H at points (r_1, r_2) [rad], shapes (...): [m/rad] or [rad/rad], shape (...)."""
        bounded = self._bounded(first, second)
        if self._rise is None:
            return bounded
        rise: Array = self._rise(first) * (np.asarray(second, float) - self._reference)
        return bounded + rise

    def surface(self, first: Array, second: Array) -> Array:
        """Surface term for many closed paths, both ends given [rad], shapes (..., T + 1)."""
        between = self(first, second)
        mean = 0.5 * (between[..., 1:] + between[..., :-1])
        result: Array = -(mean * np.diff(first)).sum(axis=-1)
        return result


def line_integral(matrix: ArrayLike, path: ArrayLike) -> Array:
    """Displacement along a path (eq:lineintegral), by the trapezoidal rule.

    Args:
        matrix: connection at the points of the path, shape (T + 1, 3, 2).
        path: points r [rad, rad], shape (T + 1, 2).

    Returns:
        x, y [m] and rotation [rad] in the mean body frame, shape (3,).
    """
    a, r = np.asarray(matrix, float), np.asarray(path, float)
    if a.shape != (*r.shape[:1], 3, 2) or r.ndim != 2:
        raise BadInputError('matrix', a.shape, f'shape {(*r.shape[:1], 3, 2)}')
    result: Array = np.einsum('tij,tj->i', 0.5 * (a[1:] + a[:-1]), np.diff(r, axis=0))
    return result


def _closed(path: ArrayLike, axes: tuple[ShapeAxis, ShapeAxis]) -> tuple[Array, list[int]]:
    """Check that a path closes, and count its windings."""
    r = np.asarray(path, float)
    if r.ndim != 2 or r.shape[1] != 2 or r.shape[0] < 3 or not np.isfinite(r).all():
        raise BadInputError('path', r.shape, 'finite points, shape (T + 1, 2), T >= 2')
    turns = (r[-1] - r[0]) / PERIOD
    windings = [round(float(turn)) for turn in turns]
    for k, axis in enumerate(axes):
        if abs(turns[k] - windings[k]) > 1e-9 or (windings[k] != 0 and not axis.cyclic):
            expected = 'a path whose ends are the same shape'
            raise BadInputError('path ends', (r[0].tolist(), r[-1].tolist()), expected)
    return r, windings
