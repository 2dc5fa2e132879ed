"""Grains under the robot: resistive force on its links in place of friction under its feet."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_laws import GranularResistance
from omega_turn_ros.robot import Robot
from omega_turn_sim_bridge.engine import pybullet
from omega_turn_sim_bridge.robot import REFLECTED_INERTIA

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

HEAD = -1  # PyBullet's index of the base
CREEP = 1e-3  # [m/s] slip below which resistance falls to 0 in proportion


class GranularGround:
    """Resistance of grains against the links of one robot, implicit in its rigid motion.

    The law knows the direction of slip only, so a force that follows the present slip overshoots
    wherever slip is slow, and chatters. Here each point meets a drag, -c v: c is the law's force
    over the slip before the step, v the slip after it. Motors keep the shape's own motion, so what
    the ground changes is a rigid motion of the whole body: three unknowns, one linear equation.
    Such a drag takes energy at any time step (own derivation). It foresees nothing else that
    pushes the robot in the plane, and a joint whose motor is too weak gives way one step late.

    Points in the plane are complex numbers x + iy; in link axes, along + i across.

    Args:
        robot: what lies on the grains.
        law: of their resistance.
        friction: resistance to sliding lengthways over the weight.
        time_step: of the solver [s].
    """

    def __init__(
        self, robot: Robot, law: GranularResistance, friction: float, time_step: float
    ) -> None:
        chain = PlanarChain.of_robot(robot)
        lengths, link = chain.lengths, chain.link_of_point
        self._law = law
        self._time_step = time_step
        self._link = link
        self._first_points = np.searchsorted(link, np.arange(lengths.size))
        self._offsets = chain.point_offsets
        self._strengths = friction * chain.normal_forces
        # Matrices that take link axes to link middles and to points, from the head's own middle.
        middles = np.tril(np.ones((lengths.size, lengths.size)), -1) * -lengths
        middles -= np.diag(0.5 * lengths)
        middles[:, 0] += 0.5 * robot.head_length
        self._middles = middles
        self._points = middles[link]
        self._points[np.arange(link.size), link] += chain.point_offsets
        self._rigid = np.array([1.0, 1j, 1j])[:, None]
        self._masses = robot.module_mass * lengths / robot.module_length
        self._mass = float(self._masses.sum())
        self._mass_fractions = self._masses / self._mass
        bodies = np.diff([0, *(robot.yaw_indices + 1), robot.n_joints + 1])
        own = self._masses * (lengths**2 + robot.module_width**2) / 12.0
        self._own_inertia = float((own + REFLECTED_INERTIA * bodies).sum())
        # A link may be several bodies: its first one takes the force, at the link's middle.
        self._joints = robot.yaw_indices.tolist()
        fronts = [robot.head_length] + [robot.module_length] * len(self._joints)
        self._levers = (0.5 * (np.array(fronts) - lengths)).tolist()

    def forces(
        self, angles: ArrayLike, rates: ArrayLike, velocity: complex
    ) -> tuple[Complex, Array]:
        """Resistance during the coming step.

        Args:
            angles: of the link axes in the world [rad], head first, shape (L,).
            rates: their time derivatives [rad/s], shape (L,).
            velocity: of the middle of the head in the world, x + iy [m/s].

        Returns:
            Force on each link in its axes, along + i across [N], shape (L,), and moment about its
            middle [N m], shape (L,).
        """
        axes = np.exp(1j * np.asarray(angles, float))
        points = self._points @ axes
        into_link = axes.conj()[self._link]
        slip = (self._points @ (1j * np.asarray(rates) * axes) + velocity) * into_link
        middles = self._middles @ axes
        centre = self._mass_fractions @ middles
        # What motion along x, along y and a turn about the centre of mass add to the slip.
        rigid = self._rigid * into_link
        rigid[2] *= points - centre
        speed = np.hypot(np.abs(slip), CREEP)
        drag = np.empty((speed.size, 2))
        drag[:, 0], drag[:, 1] = self._law.drag(slip.real / speed, slip.imag / speed)
        drag *= (self._strengths / speed)[:, None]
        # As pairs of real numbers from here.
        drag, before, rigid = drag.ravel(), slip.view(float), rigid.view(float)
        dragged = rigid * drag
        system = dragged @ rigid.T
        system.flat[::4] += self._inertia(middles - centre) / self._time_step
        after = before - np.linalg.solve(system, dragged @ before) @ rigid
        force = -(drag * after).view(complex)
        moments = np.add.reduceat(self._offsets * force.imag, self._first_points)
        return np.add.reduceat(force, self._first_points), moments

    def _inertia(self, middles: Complex) -> Array:
        """Mass, mass and moment of inertia about the centre of mass, where middles count from."""
        turning = self._masses @ (middles.real**2 + middles.imag**2)
        return np.array([self._mass, self._mass, turning + self._own_inertia])

    def push(self, client: int, body: int) -> None:
        """Let the grains act on the robot during the coming solver step.

        Args:
            client: PyBullet's physics client.
            body: PyBullet's id of the robot.
        """
        _, (qx, qy, qz, qw) = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
        (vx, vy, _), (_, _, turn) = pybullet.getBaseVelocity(body, physicsClientId=client)
        states = pybullet.getJointStates(body, self._joints, physicsClientId=client)
        yaw = math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
        angles, rates = np.cumsum([(yaw, turn), *(state[:2] for state in states)], axis=0).T
        forces, moments = self.forces(angles, rates, complex(vx, vy))
        for link, lever, force, moment in zip(
            (HEAD, *self._joints), self._levers, forces.tolist(), moments.tolist()
        ):
            pybullet.applyExternalForce(
                body,
                link,
                (force.real, force.imag, 0.0),
                (lever, 0.0, 0.0),
                pybullet.LINK_FRAME,
                physicsClientId=client,
            )
            pybullet.applyExternalTorque(
                body, link, (0.0, 0.0, moment), pybullet.LINK_FRAME, physicsClientId=client
            )
