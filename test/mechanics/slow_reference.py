"""The body velocity by scipy, one shape at a time, to twelve digits: slow, another method.

Under an elliptic friction law the dissipation is convex in the body velocity. Its minimum is
either where all points slip and the forces add up to zero, or where the body pivots on a point.
"""

from __future__ import annotations

import numpy as np
from plain_chain import PlainChain
from scipy.optimize import brentq, minimize, root

from omega_turn_ros.mechanics.chain import PlanarChain


class SlowReference:
    """Friction of one shape in motion.

    Args:
        chain: the robot.
        angles: [rad], shape (N,).
        rates: [rad/s], shape (N,).
        ratio: friction across a link over friction along it.
    """

    def __init__(
        self, chain: PlanarChain, angles: np.ndarray, rates: np.ndarray, ratio: float = 1.0
    ) -> None:
        plain = PlainChain(chain, angles, rates)
        self.x, self.y, vx, vy, w = np.array(
            [(p.x, p.y, p.vx, p.vy, p.normal_force) for p in plain.points]
        ).T
        self.w = w / w.sum()
        link = np.array([plain.alpha[p.link] for p in plain.points])
        # Stretched across the link, the elliptic law is the isotropic one.
        self.axes = np.stack(
            [
                np.stack([np.cos(link), np.sin(link)], axis=-1),
                ratio * np.stack([-np.sin(link), np.cos(link)], axis=-1),
            ],
            axis=-2,
        )
        self.size = float(np.hypot(self.x, self.y).max())
        self.speed = float(np.mean(np.hypot(vx, vy)))
        self.shape_slip = np.stack([vx, vy], axis=-1) / self.speed

    def slip(self, xi: np.ndarray) -> np.ndarray:
        """Stretched slip of all points at the scaled body velocity, shape (P, 2)."""
        turn = xi[2] / self.size * np.stack([-self.y, self.x], axis=-1)
        return np.einsum('pij,pj->pi', self.axes, self.shape_slip + xi[:2] + turn)

    def dissipation(self, xi: np.ndarray) -> float:
        return float(self.w @ np.linalg.norm(self.slip(xi), axis=1))

    def gradient(self, xi: np.ndarray, leave_out: int = -1) -> np.ndarray:
        """Force and torque of all points but one, shape (3,)."""
        slip = self.slip(xi)
        unit = slip / np.maximum(np.linalg.norm(slip, axis=1), 1e-300)[:, None]
        bearing = self.w.copy()
        if leave_out >= 0:
            bearing[leave_out] = 0.0
        return self.pull(unit * bearing[:, None])

    def pull(self, stretched: np.ndarray) -> np.ndarray:
        """Force and torque of forces on all points, given in stretched axes, shape (3,)."""
        force = np.einsum('pij,pi->pj', self.axes, stretched)
        torque = (self.x * force[:, 1] - self.y * force[:, 0]) / self.size
        return np.array([*force.sum(axis=0), torque.sum()])

    def solve(self) -> tuple[np.ndarray, int]:
        """Body velocity [m/s, m/s, rad/s], and the point that sticks or -1."""
        pivots = [self.pivoting(j) for j in range(self.w.size)]
        pivot = int(np.argmin([self.dissipation(xi) for xi in pivots]))
        xi, slipping = pivots[pivot], self.slipping()
        if slipping is not None and self.dissipation(slipping) < self.dissipation(xi):
            xi, pivot = slipping, -1
        return xi * self.speed / np.array([1.0, 1.0, self.size]), pivot

    def slipping(self) -> np.ndarray | None:
        """Scaled body velocity at which all forces vanish: by BFGS on |v| smoothed, then root."""
        xi = np.zeros(3)
        for epsilon in (1e-1, 1e-2, 1e-3, 1e-4):

            def smoothed(x: np.ndarray, e: float = epsilon) -> tuple[float, np.ndarray]:
                slip = self.slip(x)
                norm = np.sqrt((slip**2).sum(axis=1) + e**2)
                return float(self.w @ norm), self.pull(slip / norm[:, None] * self.w[:, None])

            xi = minimize(smoothed, xi, jac=True, method='BFGS', options={'gtol': 1e-9}).x
        xi = root(self.gradient, xi, tol=1e-14).x
        return xi if np.abs(self.gradient(xi)).max() < 1e-11 else None

    def pivoting(self, j: int) -> np.ndarray:
        """Scaled body velocity of least dissipation with point j at rest."""

        def held(spin: float) -> np.ndarray:
            turn = spin / self.size * np.array([-self.y[j], self.x[j]])
            return np.array([*(-self.shape_slip[j] - turn), spin])

        arm = np.array([self.y[j] / self.size, -self.x[j] / self.size, 1.0])
        spin = brentq(lambda s: self.gradient(held(s), j) @ arm, -50.0, 50.0, xtol=1e-15)
        return held(spin)
