"""The ground's answer written out point by point, to check the arrays against."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from omega_turn_ros.mechanics.chain import PlanarChain


@dataclass(frozen=True)
class RandomMotions:
    """Seeded joint angles and rates, each shape (count, N)."""

    angles: np.ndarray
    rates: np.ndarray


@dataclass(frozen=True)
class ContactPoint:
    """One point of the body on the ground, in world-like axes of the mean body frame."""

    link: int
    x: float
    y: float
    vx: float
    vy: float
    normal_force: float


class PlainChain:
    """The same kinematics and friction, link by link in plain Python, for one shape."""

    def __init__(self, chain: PlanarChain, angles: np.ndarray, rates: np.ndarray) -> None:
        self.chain = chain
        lengths = [float(v) for v in chain.lengths]
        total = sum(lengths)
        alpha, spin = [0.0], [0.0]
        for angle, rate in zip(angles, rates):
            alpha.append(alpha[-1] + float(angle))
            spin.append(spin[-1] + float(rate))
        mean = sum(w * a for w, a in zip(lengths, alpha)) / total
        mean_spin = sum(w * s for w, s in zip(lengths, spin)) / total
        self.alpha = [a - mean for a in alpha]
        spin = [s - mean_spin for s in spin]
        # Walk from the head tip backwards; every link hangs on the end of the one before.
        tip, tip_rate = np.zeros(2), np.zeros(2)
        centres, centre_rates, self.joints = [], [], []
        for length, a, s in zip(lengths, self.alpha, spin):
            along = np.array([math.cos(a), math.sin(a)])
            across = np.array([-math.sin(a), math.cos(a)])
            centres.append(tip - 0.5 * length * along)
            centre_rates.append(tip_rate - 0.5 * length * s * across)
            tip, tip_rate = tip - length * along, tip_rate - length * s * across
            self.joints.append(tip)
        self.joints.pop()
        middle = sum(w * c for w, c in zip(lengths, centres)) / total
        middle_rate = sum(w * c for w, c in zip(lengths, centre_rates)) / total
        self.joints = [joint - middle for joint in self.joints]
        self.points = []
        for link, offset, force in zip(
            chain.link_of_point, chain.point_offsets, chain.normal_forces
        ):
            a, s = self.alpha[link], spin[link]
            x, y = centres[link] - middle + offset * np.array([math.cos(a), math.sin(a)])
            vx, vy = (
                centre_rates[link]
                - middle_rate
                + offset * s * np.array([-math.sin(a), math.cos(a)])
            )
            self.points.append(ContactPoint(int(link), x, y, vx, vy, float(force)))

    def slips(self, xi: np.ndarray) -> list[tuple[float, float]]:
        """Ground velocity of every point once the body moves with xi."""
        return [(p.vx + xi[0] - xi[2] * p.y, p.vy + xi[1] + xi[2] * p.x) for p in self.points]

    def forces(self, xi: np.ndarray, friction: float = 1.0) -> list[tuple[float, float]]:
        """Kinetic Coulomb friction at every point (paper: F = -mu v/|v|)."""
        return [
            (
                -friction * p.normal_force * ux / math.hypot(ux, uy),
                -friction * p.normal_force * uy / math.hypot(ux, uy),
            )
            for p, (ux, uy) in zip(self.points, self.slips(xi))
        ]

    def sticking(self, xi: np.ndarray) -> list[int]:
        """Points that slip less than a thousandth of the mean: static friction holds them."""
        speeds = np.hypot(*np.array(self.slips(xi)).T)
        return [int(i) for i in np.flatnonzero(speeds < 1e-3 * speeds.mean())]

    def dissipation(self, xi: np.ndarray) -> float:
        """Sum of normal force times slip speed."""
        return sum(
            p.normal_force * math.hypot(ux, uy) for p, (ux, uy) in zip(self.points, self.slips(xi))
        )
