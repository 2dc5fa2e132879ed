"""What the ground answers to a slipping contact point: one small interface for every ground.

A law gives the force on a point per unit of load, in the axes of its link (tangential, normal),
from the velocity of the point in the same axes. All act against the slip. Friction and granular
resistance depend on the direction of slip only, so a gait's displacement is independent of its
speed and of a common factor on all forces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]

# What the compiled kernel switches on.
LINEAR, COULOMB, ELLIPTIC, GRANULAR = range(4)


class ForceLaw(Protocol):
    """What a ground must offer."""

    @property
    def kind(self) -> int:
        """Branch of the compiled kernel: LINEAR, COULOMB, ELLIPTIC or GRANULAR."""

    @property
    def parameters(self) -> Array:
        """Numbers that branch reads, shape (4,)."""

    def force(self, tangential: ArrayLike, normal: ArrayLike) -> tuple[Array, Array]:
        """Force per load on a point.

        Args:
            tangential: velocity along the link [m/s], shape (...).
            normal: velocity across the link [m/s], shape (...).

        Returns:
            Tangential and normal force per unit of load, each shape (...); 0 for a point at rest.
        """


@dataclass(frozen=True, slots=True)
class LinearDrag:
    """F = -(v_t, ratio v_n): a viscous ground, on which the local connection is exact.

    Attributes:
        ratio: drag across the link over drag along it.
    """

    kind: ClassVar[int] = LINEAR
    ratio: float = 2.0

    def __post_init__(self) -> None:
        """Refuse a drag that is not positive."""
        _check_positive('ratio', self.ratio)

    @property
    def parameters(self) -> Array:
        """The ratio."""
        return np.array([self.ratio, 0.0, 0.0, 0.0])

    def force(self, tangential: ArrayLike, normal: ArrayLike) -> tuple[Array, Array]:
        """See `ForceLaw.force`."""
        return -np.asarray(tangential, float), -self.ratio * np.asarray(normal, float)


@dataclass(frozen=True, slots=True)
class CoulombFriction:
    """Kinetic Coulomb friction; isotropic it is the paper's F = -mu v/|v| (Sec. IV.A).

    With ratio c it is the maximum-dissipation law of an elliptic friction limit:
    F = -(v_t, c^2 v_n) / sqrt(v_t^2 + c^2 v_n^2) (own derivation). The coefficient mu cancels.

    Attributes:
        ratio: friction across the link over friction along it, c.
    """

    ratio: float = 1.0

    def __post_init__(self) -> None:
        """Refuse a friction that is not positive."""
        _check_positive('ratio', self.ratio)

    @property
    def kind(self) -> int:
        """COULOMB where isotropic, which is faster, else ELLIPTIC."""
        return COULOMB if self.ratio == 1.0 else ELLIPTIC

    @property
    def parameters(self) -> Array:
        """The ratio."""
        return np.array([self.ratio, 0.0, 0.0, 0.0])

    def force(self, tangential: ArrayLike, normal: ArrayLike) -> tuple[Array, Array]:
        """See `ForceLaw.force`."""
        vt, vn = np.asarray(tangential, float), np.asarray(normal, float)
        c2 = self.ratio**2
        speed = np.sqrt(vt**2 + c2 * vn**2)
        inverse = np.divide(1.0, speed, out=np.zeros_like(speed), where=speed > 0.0)
        return -vt * inverse, -c2 * vn * inverse


@dataclass(frozen=True, slots=True)
class GranularResistance:
    """Resistive force in the frictional-fluid regime of dry grains.

    With psi the angle between slip and link axis (Maladen, Ding, Li, Goldman, Science 325:314,
    2009, supporting material):

        F_perp = C_S sin(beta) + C_F sin(psi),  tan(beta) = gamma sin(psi)
        F_par  = C_F cos(psi) + C_L (1 - sin(psi))

    extended to all four quadrants by symmetry. The defaults were measured for 0.3 mm glass beads,
    loosely packed, 7.6 cm deep. A robot that lies on the surface meets less across its axis:
    `intrusion` is the share of that resistance it meets, the rest being Coulomb friction under
    its belly with the coefficient of axial sliding, C_F + C_L (own model).

    Attributes:
        c_s: C_S.
        c_f: C_F.
        c_l: C_L.
        gamma: [-].
        intrusion: 0 = on top of the grains, isotropic friction; 1 = submerged.
    """

    kind: ClassVar[int] = GRANULAR
    c_s: float = 3.21
    c_f: float = 1.34
    c_l: float = -0.82
    gamma: float = 2.79
    intrusion: float = 1.0

    def __post_init__(self) -> None:
        """Refuse a ground that would push instead of resist."""
        for field in ('c_s', 'c_f', 'gamma'):
            _check_positive(field, getattr(self, field))
        if not -self.c_f < self.c_l < math.inf:
            raise BadInputError('c_l', self.c_l, f'a finite number > -c_f = {-self.c_f}')
        if not 0.0 <= self.intrusion <= 1.0:
            raise BadInputError('intrusion', self.intrusion, 'a share in 0..1')

    @classmethod
    def close_packed(cls, intrusion: float = 1.0) -> GranularResistance:
        """Return the law of the closely packed beads of the same source."""
        return cls(5.57, 2.30, -1.74, 1.93, intrusion)

    @classmethod
    def of_ratio(cls, ratio: float) -> GranularResistance:
        """Return loose beads entered so far that F_perp / F_par at right angles is `ratio`.

        Args:
            ratio: resistance to sliding sideways over resistance to sliding along, 1 or more.

        Raises:
            BadInputError: the ratio is below 1 or above that of submerged beads.
        """
        largest = cls().ratio
        if not 1.0 <= ratio <= largest:
            raise BadInputError('ratio', ratio, f'a ratio in 1..{largest:.3g}')
        return cls(intrusion=(ratio - 1.0) / (largest - 1.0))

    @property
    def ratio(self) -> float:
        """Resistance to sliding sideways over resistance to sliding along."""
        _, across = self.force(0.0, 1.0)
        along, _ = self.force(1.0, 0.0)
        return float(across / along)

    @property
    def parameters(self) -> Array:
        """Factors of u_t, u_t |u_t| / (1 + |u_n|), gamma u_n / sqrt(1 + (gamma u_n)^2), u_n."""
        along, s = self.c_f + self.c_l, self.intrusion
        return np.array(
            [
                (s * self.c_f + (1.0 - s) * along) / along,
                s * self.c_l / along,
                s * self.c_s / along,
                self.gamma,
            ]
        )

    def drag(self, tangential: ArrayLike, normal: ArrayLike) -> tuple[Array, Array]:
        """Resistance over slip, which stays finite where a component of the slip vanishes.

        Args:
            tangential: component of the unit slip along the link, shape (...).
            normal: component across the link, shape (...).

        Returns:
            -F_par / tangential and -F_perp / normal per unit of load, both > 0, shape (...).
        """
        smooth, sharp, side, gamma = self.parameters
        ut, un = np.abs(tangential), np.asarray(normal, float)
        along = smooth + sharp * ut / (1.0 + np.abs(un))
        return along, smooth + side * gamma / np.sqrt(1.0 + (gamma * un) ** 2)

    def force(self, tangential: ArrayLike, normal: ArrayLike) -> tuple[Array, Array]:
        """See `ForceLaw.force`; per load so that axial sliding meets 1."""
        vt, vn = np.asarray(tangential, float), np.asarray(normal, float)
        psi = np.arctan2(np.abs(vn), np.abs(vt))
        moving = np.hypot(vt, vn) > 0.0
        axial, s = self.c_f + self.c_l, self.intrusion
        beta = np.arctan(self.gamma * np.sin(psi))
        across = self.c_s * np.sin(beta) + self.c_f * np.sin(psi)
        along = self.c_f * np.cos(psi) + self.c_l * (1.0 - np.sin(psi))
        across = s * across / axial + (1.0 - s) * np.sin(psi)
        along = s * along / axial + (1.0 - s) * np.cos(psi)
        return -np.sign(vt) * along * moving, -np.sign(vn) * across * moving


def _check_positive(field: str, value: float) -> None:
    if not math.isfinite(value) or value <= 0.0:
        raise BadInputError(field, value, 'a finite number > 0')
