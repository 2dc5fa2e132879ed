"""What the turning controller can play: any gait with one phase and one scale that turns it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]


class PlayedGait(Protocol):
    """A gait on one robot, a single phase at a time: what a control tick needs, without delay."""

    @property
    def rest(self) -> Array:
        """Posture between turns [rad], shape (n_joints,)."""

    def waypoint(self, posture: Array) -> Array | None:
        """Posture to pass between rest and a posture [rad], (n_joints,); None: straight there."""

    def at(self, phase: float, scale: float, offsets: tuple[float, float]) -> Array:
        """Angles of all joints of the robot [rad], shape (n_joints,).

        Args:
            phase: gait phase [rad]; postures repeat after 2 pi.
            scale: what the turn planner chooses, -1..1; the calibration tells the angle it gives.
            offsets: what compliance adds to the two wave amplitudes [rad]; ignored by a gait that
                does not comply.
        """


class Gait(ABC):
    """A cycle of postures. The scale modulates it: amplitudes, a frequency ratio, an offset.

    Attributes:
        complies: amplitude offsets apply to it.
        scales_size: the scale multiplies every angle, so start postures lie on one line from rest
            and errors of the prediction grow with it. Others go through rest to another scale.
        moves: what it calls the joints it moves.
        rolls: on its back, every joint reversed, it moves the robot as on its belly.
    """

    __slots__ = ()

    complies: ClassVar[bool] = False
    scales_size: ClassVar[bool] = False
    moves: ClassVar[str] = 'joints'
    rolls: ClassVar[bool] = True

    def joints_of(self, robot: Robot) -> NDArray[np.intp]:
        """Places of the joints it moves; its calibration counts these, shape (N,)."""
        return np.arange(robot.n_joints)

    @abstractmethod
    def on(self, robot: Robot) -> PlayedGait:
        """Prepare the gait for control ticks on a robot.

        Raises:
            BadInputError: it does not fit the robot.
        """

    @abstractmethod
    def wave_phases(self, phase: float) -> tuple[float, float]:
        """Phases of its two waves [rad] at a gait phase [rad], for `wave_phases`."""

    @abstractmethod
    def to_mapping(self) -> dict[str, Any]:
        """Parameters for a library file."""
