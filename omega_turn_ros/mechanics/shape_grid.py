"""Functions of two shape variables on a grid, either variable a phase or an open interval."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline, RectBivariateSpline

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]

PERIOD = 2.0 * np.pi
FEWEST = 8  # grid points per axis
WRAP = 4  # grid points repeated beyond a period, so that splines do not feel the seam


@dataclass(frozen=True)
class ShapeAxis:
    """Evenly spaced values of one shape variable.

    Attributes:
        values: ascending [rad], shape (n,), n >= 8; a cyclic axis leaves out the end of its
            period.
        cyclic: whether the variable is a phase of period 2 pi.
    """

    values: Array
    cyclic: bool = False

    def __post_init__(self) -> None:
        """Refuse a grid that is too coarse or not even."""
        values = np.asarray(self.values, float)
        if values.ndim != 1 or values.size < FEWEST or not np.isfinite(values).all():
            raise BadInputError('axis values', values.shape, f'at least {FEWEST} finite values')
        steps = np.diff(values)
        if not steps.min() > 0.0 or np.ptp(steps) > 1e-9 * steps.max():
            raise BadInputError('axis values', values.tolist(), 'ascending, evenly spaced values')
        if self.cyclic and abs(steps.mean() * values.size - PERIOD) > 1e-9:
            raise BadInputError('axis values', values.tolist(), 'one period of 2 pi, end left out')

    @classmethod
    def phase(cls, points: int) -> ShapeAxis:
        """Cyclic axis from 0 with so many points."""
        return cls(np.arange(points, dtype=float) * (PERIOD / points), cyclic=True)

    def derivative(self, table: ArrayLike, axis: int) -> Array:
        """Derivative of tabulated values by this variable, in the shape of the table.

        By cubic splines, periodic on a cyclic axis: the error falls with the fourth power of the
        step, near the ends of an open axis with the third.
        """
        return np.asarray(self._spline(table, axis)(self.values, 1))

    def antiderivative(self, table: ArrayLike, axis: int) -> Array:
        """Integral of tabulated values from the first grid value on, in the shape of the table."""
        return np.asarray(self._spline(table, axis).antiderivative()(self.values))

    def interpolator(self, table: ArrayLike) -> CubicSpline:
        """Cubic spline through values on this axis, shape (n,); periodic on a cyclic axis."""
        return self._spline(table, 0)

    def _spline(self, table: ArrayLike, axis: int) -> CubicSpline:
        rows = np.asarray(table, float)
        if not self.cyclic:
            return CubicSpline(self.values, rows, axis)
        closed = np.append(self.values, self.values[0] + PERIOD)
        rows = np.concatenate([rows, np.take(rows, [0], axis)], axis)
        return CubicSpline(closed, rows, axis, bc_type='periodic')

    def extended(self, table: Array, axis: int) -> tuple[Array, Array]:
        """Values and table with some of a period repeated at both ends of a cyclic axis."""
        if not self.cyclic:
            return self.values, table
        n = self.values.size
        index = np.arange(-WRAP, n + WRAP)
        values = self.values[index % n] + PERIOD * (index // n)
        return values, np.take(table, index % n, axis)

    def located(self, field: str, values: ArrayLike) -> Array:
        """Bring a phase into the period of the grid; check that other values are on the grid.

        Raises:
            BadInputError: a value is not finite, or off an open axis.
        """
        x = np.asarray(values, float)
        low, high = self.values[0], self.values[-1]
        if not np.isfinite(x).all():
            raise BadInputError(field, 'NaN or Inf', 'finite numbers')
        if self.cyclic:
            return low + np.mod(x - low, PERIOD)
        slack = 1e-9 * (high - low)
        if x.size and not (low - slack <= x.min() and x.max() <= high + slack):
            expected = f'values on the grid, {low:.4g}..{high:.4g} [rad]'
            raise BadInputError(field, (float(x.min()), float(x.max())), expected)
        return np.clip(x, low, high)


class GridFunction:
    """Interpolation of a table by splines, periodic where an axis is cyclic.

    Args:
        axes: of r_1 and r_2.
        table: values on the grid, any unit, shape (n_1, n_2).
        degree: of the splines, 3 or, for tables with kinks, 1.
    """

    def __init__(
        self, axes: tuple[ShapeAxis, ShapeAxis], table: ArrayLike, degree: int = 3
    ) -> None:
        values = np.asarray(table, float)
        expected = (axes[0].values.size, axes[1].values.size)
        if values.shape != expected:
            raise BadInputError('table', values.shape, f'shape {expected}')
        self.axes = axes
        first, values = axes[0].extended(values, 0)
        second, values = axes[1].extended(values, 1)
        self._spline = RectBivariateSpline(first, second, values, kx=degree, ky=degree)

    def __call__(self, first: ArrayLike, second: ArrayLike) -> Array:
        """Evaluate at points (r_1, r_2) [rad], broadcastable shapes (...); result shape (...).

        Raises:
            BadInputError: a point is not finite, or beyond the end of an open axis.
        """
        x = self.axes[0].located('r_1', first)
        y = self.axes[1].located('r_2', second)
        return np.asarray(self._spline.ev(*np.broadcast_arrays(x, y)))
