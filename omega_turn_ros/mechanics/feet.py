"""Where the feet of a robot with legs are, how they move and what they carry; without numba."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.foot_loads import LOADS
from omega_turn_ros.robot import LeggedRobot

Array = NDArray[np.float64]

DOWN = 1e-12  # [rad] of lift up to which a foot counts as down
LEFT_RIGHT = np.array([1.0, -1.0])


class Feet:
    """Kinematics of the feet in the mean body frame of the segments.

    Args:
        robot: the robot.
        loads: how the feet that are down share the weight: 'equal' as in the paper, or 'static',
            see `foot_loads`.

    Raises:
        BadInputError: no such way of sharing.
    """

    def __init__(self, robot: LeggedRobot, loads: str = 'equal') -> None:
        if loads not in LOADS:
            raise BadInputError('loads', loads, f'one of {sorted(LOADS)}')
        self.robot = robot
        self.chain = PlanarChain(robot.planar_link_lengths, robot.weight, points_per_link=1)
        self._share = LOADS[loads]
        self._yaw = robot.yaw_indices
        axes = np.array(robot.joint_axes)
        self._swing = np.flatnonzero(axes == 'swing')
        self._lift = np.flatnonzero(axes == 'lift')

    def places(self, angles: ArrayLike) -> Array:
        """Feet in the mean body frame [m], shape (..., 2 n, 2), left before right, head first.

        Args:
            angles: all joint angles [rad], shape (..., 5 n - 1); lift moves no foot sideways here.
        """
        q = np.asarray(angles, float)
        return self.moving(q, np.zeros_like(q))[0]

    def hips(self, angles: ArrayLike) -> Array:
        """Swing axes in the mean body frame [m], shape and angles as for `places`."""
        body = np.asarray(angles, float)[..., self._yaw]
        links = self.chain.state(body, np.zeros_like(body))
        alpha = links.link_angles
        left = np.stack([-np.sin(alpha), np.cos(alpha)], axis=-1)
        side = LEFT_RIGHT[:, None] * self.robot.legs.hip_offset
        hips = links.points[..., :, None, :] + side * left[..., :, None, :]
        return hips.reshape(*body.shape[:-1], -1, 2)

    def down(self, angles: ArrayLike) -> NDArray[np.bool_]:
        """Whether each foot is down, shape (..., 2 n), at joint angles [rad], (..., 5 n - 1)."""
        down: NDArray[np.bool_] = np.asarray(angles, float)[..., self._lift] <= DOWN
        return down

    def loads(self, angles: ArrayLike) -> Array:
        """Share of the weight on each foot, sum 1, shape (..., 2 n); angles as for `down`."""
        return self._share(self.places(angles), self.down(angles))

    def moving(self, q: Array, dq: Array) -> tuple[Array, Array]:
        """Feet [m] and their velocities with the body held [m/s], each shape (..., 2 n, 2).

        Args:
            q: all joint angles [rad], shape (..., 5 n - 1).
            dq: their rates [rad/s], in the same shape.
        """
        body, turn = q[..., self._yaw], self.chain.link_angles(dq[..., self._yaw])
        links = self.chain.state(body, dq[..., self._yaw])
        tangent = np.stack([np.cos(links.link_angles), np.sin(links.link_angles)], axis=-1)
        pairs = (*q.shape[:-1], -1, 2)
        swing, rate = q[..., self._swing].reshape(pairs), dq[..., self._swing].reshape(pairs)
        legs = self.robot.legs
        along = legs.reach * np.sin(swing)
        left = LEFT_RIGHT * (legs.hip_offset + legs.reach * np.cos(swing))
        # In the link's axes; a turning link adds turn z x (along, left).
        spin = turn[..., None]
        place = np.stack([along, left], axis=-1)
        moves = np.stack(
            [
                legs.reach * np.cos(swing) * rate - spin * left,
                -LEFT_RIGHT * along * rate + spin * along,
            ],
            axis=-1,
        )
        points = links.points[..., :, None, :] + _turned(place, tangent)
        velocities = links.velocities[..., :, None, :] + _turned(moves, tangent)
        feet = (*q.shape[:-1], -1, 2)
        return points.reshape(feet), velocities.reshape(feet)


def _turned(vectors: Array, tangent: Array) -> Array:
    """Vectors (..., L, 2, 2) out of the axes of links with tangents (..., L, 2)."""
    c, s = tangent[..., None, 0], tangent[..., None, 1]
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
