"""Height function of a connection that jumps, as a mean over each cell of a grid.

Where a foot is set down or raised, the connection of a robot with legs jumps from one value to
another. Its height function h = dA_2/dr_1 - dA_1/dr_2 then has a ridge without width, which no
derivative of a table finds. The circulation around a cell, over its area, is the mean of h in the
cell whether or not there is a ridge in it (Green's theorem; own derivation).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CellHeight:
    """Height function over a phase r_1 and an open variable r_2.

    Attributes:
        first: edges of the cells along r_1, evenly spaced, a period of 2 pi [rad], shape (n + 1,).
        second: edges of the cells along r_2, ascending [rad], shape (m + 1,).
        mean: of h in each cell [1/rad for rotation], shape (n, m).
    """

    first: Array
    second: Array
    mean: Array

    @classmethod
    def around(
        cls, first: ArrayLike, second: ArrayLike, along: ArrayLike, across: ArrayLike
    ) -> CellHeight:
        """Build it of the connection's mean on the edges of the cells.

        Args:
            first: edges along r_1 [rad], shape (n + 1,).
            second: edges along r_2 [rad], shape (m + 1,).
            along: A_1 on the edges between r_1 values, shape (n, m + 1).
            across: A_2 on the edges between r_2 values, shape (n + 1, m).

        Raises:
            BadInputError: shapes do not fit.
        """
        x, y = np.asarray(first, float), np.asarray(second, float)
        a, b = np.asarray(along, float), np.asarray(across, float)
        if a.shape != (x.size - 1, y.size) or b.shape != (x.size, y.size - 1):
            expected = f'shapes {(x.size - 1, y.size)} and {(x.size, y.size - 1)}'
            raise BadInputError('connection', (a.shape, b.shape), expected)
        mean = np.diff(b, axis=0) / np.diff(x)[:, None] - np.diff(a, axis=1) / np.diff(y)
        return cls(x, y, mean)

    def surface(self, path: ArrayLike) -> float:
        """Integral of h between r_2 = 0 and a path that winds once around r_1, below counted < 0.

        Minus that is what the path adds to the displacement on the line r_2 = 0, see
        `height_function`.

        Args:
            path: r_2 at the middle of each cell along r_1 [rad], shape (n,).

        Raises:
            BadInputError: the path leaves the grid, or has another length.
        """
        r = np.asarray(path, float)
        low, high = self.second[0], self.second[-1]
        if r.shape != self.mean.shape[:1] or not (r >= low).all() or not (r <= high).all():
            expected = f'{self.mean.shape[0]} values in {low:.4g}..{high:.4g} [rad]'
            raise BadInputError('path', r.shape, expected)
        heights = np.diff(self.second) * self.mean
        total = np.concatenate([np.zeros((r.size, 1)), np.cumsum(heights, axis=1)], axis=1)
        columns = [
            np.interp(end, self.second, row) - np.interp(0.0, self.second, row)
            for end, row in zip(r, total)
        ]
        return float(np.dot(columns, np.diff(self.first)))
