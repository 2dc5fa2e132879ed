"""Quasi-static motion on slipping feet: legs carry the body, the ground answers at the feet only.

The force balance is that of `force_balance`, with the feet that are down in place of contact
points along the links. Their positions move in the links, which adds the velocity of the swing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError, ConvergenceError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.foot_loads import LOADS
from omega_turn_ros.mechanics.kernel import velocities_of_feet
from omega_turn_ros.mechanics.motion import Motion
from omega_turn_ros.robot import LeggedRobot

Array = NDArray[np.float64]

DOWN = 1e-12  # [rad] of lift up to which a foot counts as down
LEFT_RIGHT = np.array([1.0, -1.0])


class LeggedMotion(Motion):
    """A legged robot on level ground with isotropic Coulomb friction.

    A shape is all joint angles in the robot's order; a foot is down where its lift is 0.

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

    @property
    def n_joints(self) -> int:
        """All joints of the robot."""
        return self.robot.n_joints

    def feet(self, angles: ArrayLike) -> Array:
        """Feet in the mean body frame [m], shape (..., 2 n, 2), left before right, head first.

        Args:
            angles: all joint angles [rad], shape (..., 5 n - 1); lift moves no foot sideways here.
        """
        q = self._checked('angles', angles)
        return self._feet(q, np.zeros_like(q))[0]

    def contact(self, angles: ArrayLike) -> NDArray[np.bool_]:
        """Whether each foot is down, shape (..., 2 n), at joint angles [rad], (..., 5 n - 1)."""
        down: NDArray[np.bool_] = np.asarray(angles, float)[..., self._lift] <= DOWN
        return down

    def loads(self, angles: ArrayLike) -> Array:
        """Share of the weight on each foot, sum 1, shape (..., 2 n); angles as for `contact`."""
        q = self._checked('angles', angles)
        return self._share(self.feet(q), self.contact(q))

    def body_velocity(self, angles: ArrayLike, rates: ArrayLike) -> Array:
        """See `Motion.body_velocity`; angles and rates of all joints, shape (..., 5 n - 1).

        Raises:
            BadInputError: the last axis is wrong, a value is not finite, or no foot is down.
            ConvergenceError: a shape was not solved.
        """
        q, dq = np.broadcast_arrays(self._checked('angles', angles), self._checked('rates', rates))
        batch = q.shape[:-1]
        flat = (-1, self.n_joints)
        q, dq = q.reshape(flat), dq.reshape(flat)
        if not self.contact(q).any(axis=-1).all():
            raise BadInputError('angles', 'all feet up', 'at least one foot down')
        points, velocities = self._feet(q, dq)
        size = 0.5 * self.robot.length
        xi, failed = velocities_of_feet(
            points, velocities, self._share(points, self.contact(q)), size
        )
        if failed:
            raise ConvergenceError(f'force balance: {failed} of {xi.shape[0]} shapes unsolved')
        result: Array = xi.reshape(*batch, 3)
        return result

    def _feet(self, q: Array, dq: Array) -> tuple[Array, Array]:
        """Feet and their velocities with the body held, each (..., 2 n, 2)."""
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
