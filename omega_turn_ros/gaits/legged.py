"""Waves of a robot with legs (Sec. IV.J): body undulation, leg swing, contact, turning offset.

All four follow one phase phi. With n leg pairs, duty factor D, spatial frequency xi, the delay of
leg pair i is delta_i = 2 pi (xi/n) (i - 1), and a leg's own phase is phi - delta_i on the left and
phi - delta_i + pi on the right. Coordination after B. Chong et al., "A general locomotion control
framework for multi-legged locomotors", Bioinspir. Biomim. 17 046015, 2022, also used in J. He et
al., arXiv 2411.07183:

    contact    a foot is down while its phase, modulo 2 pi, is below 2 pi D
    swing      Theta_leg cos(phase/(2 D)) while down,
               -Theta_leg cos((phase - 2 pi D)/(2 (1 - D))) while up; + = forward
    body       -(Theta_body cos(phi_b - delta_i) + w_3),  i = 1..n-1,
               with phi_b = phi - (xi/n + 1/2) pi, which gives the longest steps (tested)

The body has a minus because here a positive joint angle turns the links *behind* it
counter-clockwise; w_3 > 0 bends the head to the left and turns counter-clockwise.

*What w_3 can turn.* Mirrored left to right, legs and body wave are those of half a cycle later. So
the mirror image of a path w_3(phi) is -w_3(phi + pi), and a path that is its own mirror image
cannot turn (own derivation; the same argument as for constant amplitudes without legs). The path
that the paper prints, w_3 = A_3 sin(phi), is one. Hence the family

    w_3 = A_3 (sigma + (1 - sigma) sin(phi + phi_3))

with the paper's path for sigma = 0 and phi_3 = 0, and a constant bend for sigma = 1. We turn with
sigma = 1/2, phi_3 = -pi/2: the law of the turning amplitude in eq:prescribe_amp, f_2, in place of
the constant one. The bend is 0 and at rest where cycles begin, so turning begins and ends in
walking.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.gait import Gait
from omega_turn_ros.gaits.gait_fields import check_number, with_fields
from omega_turn_ros.robot import LeggedRobot, Robot

Array = NDArray[np.float64]

CYCLE = 2.0 * math.pi
SIDES = 2  # left, right
JOINTS_PER_PAIR = 5  # swing and lift of the left leg, of the right leg, and the yaw joint behind


@dataclass(frozen=True, slots=True)
class LeggedGait(Gait):
    """A walking gait that turns with the amplitude of its offset.

    Attributes:
        n_pairs: n, leg pairs; n - 1 body joints lie between them.
        theta_leg: Theta_leg, amplitude of leg swing [rad].
        theta_body: Theta_body, amplitude of body undulation [rad].
        theta_lift: how far a leg is raised in swing [rad].
        a_3: A_3, amplitude of the turning offset at scale 1 [rad].
        duty: D, share of the cycle that a foot is down.
        xi: spatial frequency, waves on the body.
        raising: share of a leg's swing that it takes to raise it, and again to lower it.
        sigma: share of w_3 that is constant.
        phi_3: phase of the rest [rad].
    """

    rolls: ClassVar[bool] = False  # on its back legs still swing forward to walk forward

    n_pairs: int
    theta_leg: float
    theta_body: float
    theta_lift: float
    a_3: float
    duty: float = 0.6
    xi: float = 1.0
    raising: float = 0.25
    sigma: float = 0.5
    phi_3: float = -0.5 * math.pi

    def __post_init__(self) -> None:
        """Refuse what is no gait."""
        for field in self.__slots__:
            check_number(field, getattr(self, field))
        if not isinstance(self.n_pairs, int):
            raise BadInputError('gait field n_pairs', self.n_pairs, 'a whole number')
        for field, low, high in (
            ('n_pairs', 2, math.inf),
            ('duty', 1e-3, 1.0 - 1e-3),
            ('raising', 1e-3, 0.5),
            ('sigma', 0.0, 1.0),
        ):
            if not low <= getattr(self, field) <= high:
                raise BadInputError(f'gait field {field}', getattr(self, field), f'{low}..{high}')

    @property
    def n_joints(self) -> int:
        """Joints of the robot."""
        return JOINTS_PER_PAIR * self.n_pairs - 1

    def leg_phases(self, phase: ArrayLike) -> Array:
        """Phase of each leg, 0..2 pi [rad], shape (..., n, 2), at phi [rad], shape (...)."""
        delay = CYCLE * self.xi / self.n_pairs * np.arange(self.n_pairs)
        side = math.pi * np.arange(SIDES)
        result: Array = np.mod(
            np.asarray(phase, float)[..., None, None] - delay[:, None] + side, CYCLE
        )
        return result

    def contact(self, phase: ArrayLike) -> NDArray[np.bool_]:
        """Whether each foot is down, shape (..., n, 2), at phi [rad], shape (...)."""
        down: NDArray[np.bool_] = self.leg_phases(phase) < CYCLE * self.duty
        return down

    def swing(self, phase: ArrayLike) -> Array:
        """Protraction of each leg, + = forward [rad], shape (..., n, 2), at phi, shape (...)."""
        leg = self.leg_phases(phase)
        stance = CYCLE * self.duty
        down = np.cos(leg / (2.0 * self.duty))
        up = -np.cos((leg - stance) / (2.0 * (1.0 - self.duty)))
        result: Array = self.theta_leg * np.where(leg < stance, down, up)
        return result

    def lift(self, phase: ArrayLike) -> Array:
        """Lift angle of each leg, + = up [rad], shape (..., n, 2), at phi [rad], shape (...).

        The contact wave as a joint can follow it: 0 while down; raised, held and lowered again in
        swing, with minimum jerk.
        """
        stance = CYCLE * self.duty
        share = (self.leg_phases(phase) - stance) / (CYCLE - stance)
        edge = np.clip(np.minimum(share, 1.0 - share) / self.raising, 0.0, 1.0)
        result: Array = self.theta_lift * edge**3 * (10.0 - 15.0 * edge + 6.0 * edge**2)
        return result

    def undulation(self, phase: ArrayLike) -> Array:
        """Body wave Theta_body cos(phi_b - delta_i) [rad], shape (..., n - 1), at phi [rad]."""
        step = self.xi / self.n_pairs
        phi_b = np.asarray(phase, float) - (step + 0.5) * math.pi
        delay = CYCLE * step * np.arange(self.n_pairs - 1)
        result: Array = self.theta_body * np.cos(phi_b[..., None] - delay)
        return result

    def offset(self, phase: ArrayLike) -> Array:
        """Turning offset w_3 [rad], shape (...), at phi [rad], shape (...)."""
        wave = np.sin(np.asarray(phase, float) + self.phi_3)
        result: Array = self.a_3 * (self.sigma + (1.0 - self.sigma) * wave)
        return result

    def body(self, phase: ArrayLike, scale: ArrayLike = 1.0) -> Array:
        """Body yaw joint angles [rad], shape (..., n - 1).

        Args:
            phase: phi [rad], shape (...).
            scale: factor on A_3; the legs do not feel it, shape (...).
        """
        turning = np.asarray(scale, float) * self.offset(phase)
        result: Array = -(self.undulation(phase) + turning[..., None])
        return result

    def angles(self, phase: ArrayLike, scale: ArrayLike = 1.0) -> Array:
        """All joint angles, in the order of `robot.LeggedRobot` [rad], shape (..., 5 n - 1).

        Args:
            phase: phi [rad], shape (...).
            scale: factor on A_3, shape (...).
        """
        body = self.body(phase, scale)
        legs = np.stack([self.swing(phase), self.lift(phase)], axis=-1)
        legs = np.broadcast_to(legs, (*body.shape[:-1], self.n_pairs, SIDES, 2))
        result = np.zeros((*body.shape[:-1], self.n_pairs, JOINTS_PER_PAIR))
        result[..., :-1] = legs.reshape(*legs.shape[:-2], -1)
        result[..., :-1, -1] = body
        return result.reshape(*body.shape[:-1], -1)[..., :-1]

    def on(self, robot: Robot) -> LeggedPostures:
        """See `Gait.on`."""
        return LeggedPostures(self, robot)

    def wave_phases(self, phase: float) -> tuple[float, float]:
        """Phases of the body wave at its head, phi_b, and of the turning offset [rad]."""
        return phase - (self.xi / self.n_pairs + 0.5) * math.pi, phase + self.phi_3

    def to_mapping(self) -> dict[str, Any]:
        """Parameters for a library file."""
        return asdict(self)

    @classmethod
    def from_mapping(cls, parameters: dict[str, Any]) -> LeggedGait:
        """Build the gait of a library file's parameters.

        Raises:
            BadInputError: a parameter is missing, unknown or out of range.
        """
        return cls(**with_fields(parameters, cls.__slots__))


class LeggedPostures:
    """A `PlayedGait` of a robot with legs. Between turns it stands in mid-stride, at phase 0.

    There every cycle begins and ends, whatever its scale, so cycles follow one another at once.

    Args:
        gait: the waves.
        robot: with as many leg pairs.

    Raises:
        BadInputError: it has no legs, or another number of pairs.
    """

    def __init__(self, gait: LeggedGait, robot: Robot) -> None:
        if not isinstance(robot, LeggedRobot) or robot.n_pairs != gait.n_pairs:
            raise BadInputError('robot', robot.name, f'one with {gait.n_pairs} leg pairs')
        self._gait = gait
        self.rest: Array = gait.angles(0.0, 0.0)

    def at(self, phase: float, scale: float, offsets: tuple[float, float]) -> Array:
        """See `PlayedGait.at`; offsets are ignored."""
        return self._gait.angles(phase, scale)

    def waypoint(self, posture: Array) -> None:
        """See `PlayedGait.waypoint`: straight there."""
