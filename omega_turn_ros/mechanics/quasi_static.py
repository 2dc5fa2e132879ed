"""Quasi-static motion of a chain on a ground, compiled: one shape, a batch, or a path.

The same mechanics as `force_balance`, some hundred times faster and for any force law; that module
needs numpy only, so the nodes stay small, and checks this one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import ConvergenceError
from omega_turn_ros.mechanics.chain import PlanarChain, ShapeState
from omega_turn_ros.mechanics.force_balance import (
    joint_torques,
    slip_velocities,
    torques_of_forces,
    torques_of_slip,
)
from omega_turn_ros.mechanics.force_laws import COULOMB, CoulombFriction, ForceLaw
from omega_turn_ros.mechanics.kernel import velocities
from omega_turn_ros.mechanics.motion import Motion

Array = NDArray[np.float64]

ISOTROPIC = CoulombFriction()
STICKING = 1e-3  # slip of a point over the mean shape speed below which it may stick


class QuasiStatic(Motion):
    """A chain on a ground (Sec. IV.A: body velocity from force and torque balance).

    Args:
        chain: the robot.
        law: of the ground, isotropic kinetic Coulomb friction if not given.
    """

    def __init__(self, chain: PlanarChain, law: ForceLaw = ISOTROPIC) -> None:
        self.chain = chain
        self.law = law
        self._arguments = (
            law.kind,
            law.parameters,
            chain.lengths,
            chain.link_of_point,
            chain.point_offsets,
            chain.point_sides,
            chain.normal_forces / chain.normal_forces.sum(),
        )

    def body_velocity(self, angles: ArrayLike, rates: ArrayLike) -> Array:
        """Velocity of the mean body frame at which ground forces and torque balance.

        Each shape of a batch starts from the solution of the one before, so a batch in the order
        of a path is solved fastest.

        Args:
            angles: yaw joint angles [rad], shape (..., N).
            rates: their time derivatives [rad/s], shape (..., N).

        Returns:
            [xi_x, xi_y, xi_theta] in the mean body frame [m/s, m/s, rad/s], shape (..., 3).

        Raises:
            BadInputError: the last axis is not N, or a value is not finite.
            ConvergenceError: a shape was not solved.
        """
        q = self._checked('angles', angles)
        dq = self._checked('rates', rates)
        q, dq = np.broadcast_arrays(q, dq)
        flat = (-1, self.chain.n_joints)
        xi, failed = velocities(
            *self._arguments,
            np.ascontiguousarray(q.reshape(flat)),
            np.ascontiguousarray(dq.reshape(flat)),
        )
        if failed:
            raise ConvergenceError(f'force balance: {failed} of {xi.shape[0]} shapes unsolved')
        result: Array = xi.reshape(*q.shape[:-1], 3)
        return result

    def joint_torques(self, angles: ArrayLike, rates: ArrayLike, friction: float) -> Array:
        """Actuator torques against the ground, as `force_balance.joint_torques` gives, sooner.

        A point that sticks has a force, but no slip to tell it by. Isotropic friction gives it
        the force that balances; other laws that of whatever slip is left.

        Args:
            angles: yaw joint angles [rad], shape (..., N).
            rates: their time derivatives [rad/s], shape (..., N).
            friction: kinetic friction coefficient mu; of other laws the force that a load of 1
                makes 1 of theirs.

        Returns:
            Torques on the link behind each joint, + = counter-clockwise [N m], shape (..., N).
        """
        angles, rates = np.broadcast_arrays(np.asarray(angles, float), np.asarray(rates, float))
        xi = self.body_velocity(angles, rates).reshape(-1, 3)
        flat = (-1, self.chain.n_joints)
        q, dq = angles.reshape(flat), rates.reshape(flat)
        state = self.chain.state(q, dq)
        slip = slip_velocities(state.points, state.velocities, xi)
        if self.law.kind != COULOMB:
            force = friction * self._forces(state, slip)
            return torques_of_forces(self.chain, state, force).reshape(np.shape(angles))
        torques = torques_of_slip(self.chain, state, slip, friction)
        # The smoothed balance knows the force of a point that sticks.
        speeds = np.hypot(slip[..., 0], slip[..., 1])
        sticks = speeds.min(axis=-1) < STICKING * np.abs(state.velocities).mean(axis=(-2, -1))
        if sticks.any():
            torques[sticks] = joint_torques(self.chain, q[sticks], dq[sticks], friction)
        return torques.reshape(np.shape(angles))

    def _forces(self, state: ShapeState, slip: Array) -> Array:
        """Forces of the law on the points of B shapes, in the mean body frame, (B, P, 2)."""
        angles = state.link_angles[:, self.chain.link_of_point]
        c, s = np.cos(angles), np.sin(angles)
        x, y = slip[..., 0], slip[..., 1]
        along, across = self.law.force(c * x + s * y, c * y - s * x)
        force = np.stack([c * along - s * across, s * along + c * across], axis=-1)
        result: Array = self.chain.normal_forces[:, None] * force
        return result
