"""The local connection: body velocity as a linear function of shape velocity.

    xi = A(r) dr/dt                                                   (eq:EquationOfMotion1)

Under linear drag this is exact. Under Coulomb friction or in grains xi is only odd and homogeneous
of degree one in dr/dt; A is then the linear map nearest to it over all directions, and the misfit
says how near that is.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.motion import Motion

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LocalConnection:
    """Linear map from shape to body velocity, for a batch of shapes.

    Attributes:
        matrix: A, rows x, y [m/rad] and rotation [rad/rad] in the mean body frame, columns the
            shape variables, shape (..., 3, m).
        misfit: root mean square of A u - xi(u) over that of xi(u), over the directions u of
            `shape_directions`, rotation counted in half body lengths [-], shape (...); 0 where
            the connection is exact.
    """

    matrix: Array
    misfit: Array


def shape_directions(m: int) -> Array:
    """Unit directions of shape velocity a connection is fitted to.

    All vectors of -1, 0 and 1, one of each opposite pair because xi(-u) = -xi(u): 1, 4, 13, 40
    directions for m = 1..4. By symmetry the mean of u u^T is 1/m. Of the odd harmonics that xi may
    have over the circle (m = 2) the four directions tell the first from all below the seventh.

    Args:
        m: dimension of the shape space.

    Returns:
        Directions, shape ((3^m - 1) / 2, m).
    """
    if m < 1:
        raise BadInputError('m', m, 'at least one shape variable')
    # The product is in lexical order, so its second half opens with 1 after leading zeros.
    half = np.array(list(product((-1.0, 0.0, 1.0), repeat=m))[3**m // 2 + 1 :])
    directions: Array = half / np.linalg.norm(half, axis=1, keepdims=True)
    return directions


def local_connection(
    motion: Motion,
    angles: ArrayLike,
    jacobian: ArrayLike,
    directions: ArrayLike | None = None,
) -> LocalConnection:
    """Fit the connection by least squares over directions of shape velocity.

    The force balance starts each shape from the one before it: lay a grid out so that neighbours
    along its last axis are similar shapes.

    Fitted to directions close to one field of directions u(r), the connection is exact to first
    order for all paths near the one that follows it, because xi is homogeneous in dr/dt (Euler's
    theorem; own derivation): such paths have the right turn and the right gradient of it.

    Args:
        motion: the body on its ground.
        angles: yaw joint angles theta at r [rad], shape (..., N).
        jacobian: d theta / d r [rad per unit of r], shape (..., N, m).
        directions: u to fit to, shape (..., K, m); `shape_directions`, which favour no direction,
            if not given.

    Raises:
        BadInputError: the shapes do not fit together, or a value is not finite.
        ConvergenceError: a shape was not solved.
    """
    shapes, columns = np.asarray(angles, float), np.asarray(jacobian, float)
    if columns.ndim < 2 or columns.shape[:-1] != shapes.shape:
        raise BadInputError('jacobian', columns.shape, f'shape {(*shapes.shape, "m")}')
    m = columns.shape[-1]
    u = shape_directions(m) if directions is None else np.asarray(directions, float)
    if u.ndim < 2 or u.shape[-1] != m or u.shape[-2] < m:
        raise BadInputError('directions', u.shape, f'at least {m} directions of {m} numbers')
    # Directions outermost: within one, each shape is a good guess for the next.
    rates = np.moveaxis(columns @ np.swapaxes(u, -1, -2), -1, 0)
    xi = np.moveaxis(motion.body_velocity(np.broadcast_to(shapes, rates.shape), rates), 0, -2)
    matrix = np.swapaxes(np.linalg.pinv(u) @ xi, -1, -2)
    error = u @ np.swapaxes(matrix, -1, -2) - xi
    size = np.array([1.0, 1.0, 0.5 * motion.chain.lengths.sum()])
    missed, whole = (np.square(v * size).sum(axis=(-2, -1)) for v in (error, xi))
    share = np.divide(missed, whole, out=np.zeros_like(whole), where=whole > 0.0)
    return LocalConnection(matrix, np.sqrt(share))
