"""Quasi-static motion on slipping feet: legs carry the body, the ground answers at the feet only.

The force balance is that of `force_balance`, with the feet that are down in place of contact
points along the links. Their positions move in the links, which adds the velocity of the swing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError, ConvergenceError
from omega_turn_ros.mechanics.feet import Feet
from omega_turn_ros.mechanics.kernel import velocities_of_feet
from omega_turn_ros.mechanics.motion import Motion
from omega_turn_ros.robot import LeggedRobot

Array = NDArray[np.float64]


class LeggedMotion(Motion):
    """A legged robot on level ground with isotropic Coulomb friction.

    A shape is all joint angles in the robot's order; a foot is down where its lift is 0.

    Attributes:
        robot: the robot.
        feet: where they are and what they carry.

    Args:
        robot: the robot.
        loads: see `Feet`.

    Raises:
        BadInputError: no such way of sharing loads.
    """

    def __init__(self, robot: LeggedRobot, loads: str = 'equal') -> None:
        self.robot = robot
        self.feet = Feet(robot, loads)
        self.chain = self.feet.chain

    @property
    def n_joints(self) -> int:
        """All joints of the robot."""
        return self.robot.n_joints

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
        if not self.feet.down(q).any(axis=-1).all():
            raise BadInputError('angles', 'all feet up', 'at least one foot down')
        points, velocities = self.feet.moving(q, dq)
        size = 0.5 * self.robot.length
        xi, failed = velocities_of_feet(points, velocities, self.feet.loads(q), size)
        if failed:
            raise ConvergenceError(f'force balance: {failed} of {xi.shape[0]} shapes unsolved')
        result: Array = xi.reshape(*batch, 3)
        return result
