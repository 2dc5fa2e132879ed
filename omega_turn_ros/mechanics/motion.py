"""Where shapes take a body whose ground answers at once: rate-independent, step by step."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.trajectory import integrate_twists

Array = NDArray[np.float64]


class Motion(ABC):
    """A body on a ground.

    Attributes:
        chain: its links, whose mean body frame all displacements are given in.
    """

    chain: PlanarChain

    @property
    def n_joints(self) -> int:
        """Joint angles that make a shape; the yaw joints of the chain unless there are more."""
        return self.chain.n_joints

    @abstractmethod
    def body_velocity(self, angles: ArrayLike, rates: ArrayLike) -> Array:
        """Velocity of the mean body frame at which ground forces and torque balance.

        Args:
            angles: joint angles [rad], shape (..., N).
            rates: their time derivatives [rad/s], shape (..., N).

        Returns:
            [xi_x, xi_y, xi_theta] in the mean body frame [m/s, m/s, rad/s], shape (..., 3).
        """

    def displacements(self, path: ArrayLike) -> Array:
        """Body displacement in each step along a path of shapes, by the midpoint rule.

        Args:
            path: joint angles [rad], shape (..., T, N), T >= 2.

        Returns:
            Motion during each step in the mean body frame at its middle [m, m, rad], shape
            (..., T - 1, 3). Rate-independent: only the sequence of shapes counts.
        """
        shapes = self._checked('path', path)
        step = np.diff(shapes, axis=-2)
        return self.body_velocity(shapes[..., :-1, :] + 0.5 * step, step)

    def heading_along(self, path: ArrayLike) -> Array:
        """Heading of the mean body axis along a path [rad], 0 at its start.

        Args:
            path: joint angles [rad], shape (..., T, N), T >= 2.

        Returns:
            Heading, shape (..., T).
        """
        turn = self.displacements(path)[..., 2]
        heading = np.zeros((*turn.shape[:-1], turn.shape[-1] + 1))
        np.cumsum(turn, axis=-1, out=heading[..., 1:])
        return heading

    def pose_along(self, path: ArrayLike) -> Array:
        """Pose of the mean body frame along one path from the origin, exact in SE(2) per step.

        Args:
            path: joint angles [rad], shape (T, N), T >= 2.

        Returns:
            x [m], y [m], heading [rad] in the world, shape (T, 3).
        """
        return integrate_twists(self.displacements(path))

    def turn(self, path: ArrayLike) -> float:
        """Heading change over a path [rad]; for a closed path the angle per cycle."""
        return float(self.displacements(path)[..., 2].sum())

    def _checked(self, field: str, values: ArrayLike) -> Array:
        array = np.asarray(values, float)
        if array.ndim < 1 or array.shape[-1] != self.n_joints:
            raise BadInputError(field, array.shape, f'shape (..., {self.n_joints})')
        if not np.isfinite(array).all():
            raise BadInputError(field, 'NaN or Inf', 'finite numbers')
        return array
