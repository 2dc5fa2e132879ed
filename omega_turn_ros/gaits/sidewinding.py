"""Sidewinding, and its frequency turn: a horizontal and a vertical wave a quarter period apart.

    yaw_i   =  a_h sin(phase + 2 pi k_h s_i)
    pitch_i = -a_v cos(phase + 2 pi k_v s_i)

with s the place of a joint along the body, i/N for yaw joint i. Equal spatial frequencies lay the
body down in parallel tracks: it moves sideways without turning. With k_v / k_h off 1 the contact
phase drifts along the body and the path curves (frequency turn: Astley et al., PNAS 112:6200,
2015; Chong et al., Int. J. Robotics Research, 2021). Head to tail the quarter period is at s = 0.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.gait import Gait
from omega_turn_ros.gaits.gait_fields import check_number, with_fields
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Sidewinding(Gait):
    """Sidewinding whose scale modulates the ratio of spatial frequencies.

    The ratio k_v / k_h runs from 1 at scale 0, where the robot moves sideways and keeps its
    heading, to `turning_ratio` at scale +-1. A negative scale is the mirror image: sidewinding to
    the other side, turning the other way.

    Attributes:
        k_h: spatial frequency of the horizontal wave, waves on the body.
        a_h: its amplitude [rad].
        a_v: amplitude of the vertical wave [rad].
        turning_ratio: k_v / k_h at scale +-1.
    """

    k_h: float
    a_h: float
    a_v: float
    turning_ratio: float

    def __post_init__(self) -> None:
        """Refuse anything that is not a finite number, and waves that are none."""
        for field in self.__slots__:
            value = getattr(self, field)
            check_number(field, value)
            if field != 'a_h' and value <= 0.0:  # a negative a_h is the mirror image
                raise BadInputError(f'gait field {field}', value, 'a number > 0')

    def on(self, robot: Robot) -> SidewindingPostures:
        """See `Gait.on`."""
        return SidewindingPostures(self, robot)

    def wave_phases(self, phase: float) -> tuple[float, float]:
        """Phases of the horizontal and the vertical wave at the head [rad]."""
        return phase, phase - 0.5 * math.pi

    def ratio(self, scale: float) -> float:
        """Return k_v / k_h at a scale in -1..1."""
        return 1.0 + abs(scale) * (self.turning_ratio - 1.0)

    @classmethod
    def from_mapping(cls, parameters: dict[str, Any]) -> Sidewinding:
        """Build the gait of a library file's parameters.

        Raises:
            BadInputError: a field is missing, unknown or not a finite number.
        """
        return cls(**with_fields(parameters, cls.__slots__))

    def to_mapping(self) -> dict[str, Any]:
        """Parameters for a library file, rounded to 1e-9."""
        return {field: round(float(value), 9) for field, value in asdict(self).items()}


class SidewindingPostures:
    """A `PlayedGait` of sidewinding.

    Args:
        gait: the waves.
        robot: whose yaw joints take the horizontal wave, whose pitch joints the vertical one.

    Raises:
        BadInputError: the robot has no pitch joints, or other joints too.
    """

    def __init__(self, gait: Sidewinding, robot: Robot) -> None:
        axes = np.array(robot.joint_axes)
        yaw, pitch = axes == 'yaw', axes == 'pitch'
        if not pitch.any() or not (yaw | pitch).all():
            raise BadInputError('robot', robot.name, 'yaw and pitch joints, for sidewinding')
        self._flat = yaw
        place = np.arange(robot.n_joints) + robot.head_length / robot.module_length
        lag = 2.0 * math.pi * gait.k_h * place / robot.n_joints
        self.rest: Array = np.zeros(robot.n_joints)
        # Where the wave is straight, what the scale adds, and how high it is, joint by joint.
        self._lag = np.where(yaw, lag, lag - 0.5 * math.pi)
        self._drift = np.where(yaw, 0.0, (gait.turning_ratio - 1.0) * lag)
        self._left = np.where(yaw, gait.a_h, gait.a_v)
        self._right = np.where(yaw, -gait.a_h, gait.a_v)

    def at(self, phase: float, scale: float, offsets: tuple[float, float]) -> Array:
        """See `PlayedGait.at`; offsets are ignored."""
        amplitude = self._left if scale >= 0.0 else self._right
        posture: Array = amplitude * np.sin(phase + self._lag + abs(scale) * self._drift)
        return posture

    def waypoint(self, posture: Array) -> Array:
        """See `PlayedGait.waypoint`: bent, but flat on the ground.

        Lifted half way the robot tips from one rest to another; flat it bends and unbends alike.
        """
        return np.where(self._flat, posture, 0.0)

    def cycle(self, phases: Array, scale: float) -> Array:
        """Postures at many phases [rad], shape (T,), at one scale [rad], (T, n_joints)."""
        amplitude = self._left if scale >= 0.0 else self._right
        lag = self._lag + abs(scale) * self._drift
        postures: Array = amplitude * np.sin(phases[:, None] + lag)
        return postures
