"""What every gait of the two-wave family shares, however its f_1, f_2 and f_3 are prescribed."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.gaits.gait import Gait
from omega_turn_ros.gaits.postures import Postures
from omega_turn_ros.gaits.two_wave import two_wave_angles
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]


class WaveGait(Gait):
    """A closed path in [A_f, tau_f, A_t, tau_t], run through by the gait phase tau_t.

    Attributes:
        k_f: spatial frequency of the forward wave.
        k_t: spatial frequency of the turning wave (0 offset, 1 omega, k_f geometric turn).
    """

    __slots__ = ()

    complies: ClassVar[bool] = True
    scales_size: ClassVar[bool] = True
    moves: ClassVar[str] = 'yaw joints'

    k_f: float
    k_t: float

    def joints_of(self, robot: Robot) -> NDArray[np.intp]:
        """See `Gait.joints_of`."""
        return robot.yaw_indices

    def on(self, robot: Robot) -> Postures:
        """See `Gait.on`."""
        return Postures(self, robot.yaw_indices, robot.n_joints)

    def wave_phases(self, phase: float) -> tuple[float, float]:
        """See `Gait.wave_phases`."""
        _, tau_f, _, tau_t = self.waves_at(phase)
        return tau_f, tau_t

    @abstractmethod
    def phases(self, phase: ArrayLike) -> tuple[Array, Array]:
        """Return (tau_f, tau_t) [rad], each shape (...), at gait phase [rad], shape (...)."""

    @abstractmethod
    def amplitudes(self, phase: ArrayLike) -> tuple[Array, Array]:
        """Return (A_f, A_t) [rad], each shape (...), at gait phase [rad], shape (...)."""

    @abstractmethod
    def waves_at(self, phase: float) -> tuple[float, float, float, float]:
        """Return (A_f, tau_f, A_t, tau_t) [rad] at one gait phase, quickly enough for a tick."""

    @abstractmethod
    def scaled(self, factor: float) -> WaveGait:
        """Return the gait with both amplitudes multiplied."""

    def mirrored(self) -> WaveGait:
        """Return the gait that turns the other way: both amplitudes negated."""
        return self.scaled(-1.0)

    def angles(
        self,
        phase: ArrayLike,
        n_joints: int,
        scale: ArrayLike = 1.0,
        offsets: tuple[ArrayLike, ArrayLike] = (0.0, 0.0),
    ) -> Array:
        """Joint angles at a gait phase (eq:template).

        Args:
            phase: gait phase tau_t [rad], shape (...).
            n_joints: N, the number of yaw joints.
            scale: factor on both nominal amplitudes; -1 is the mirrored turn, shape (...).
            offsets: what compliance adds to (A_f, A_t) [rad], each shape (...).

        Returns:
            Yaw joint angles [rad], shape (..., N).
        """
        tau_f, tau_t = self.phases(phase)
        forward, turning = self.amplitudes(phase)
        return two_wave_angles(
            np.asarray(scale, float) * forward + np.asarray(offsets[0], float),
            tau_f,
            np.asarray(scale, float) * turning + np.asarray(offsets[1], float),
            tau_t,
            self.k_f,
            self.k_t,
            n_joints,
        )

    def sampled(self, n_joints: int, samples: int = 720) -> Array:
        """Angles over one cycle from phase 0, end excluded [rad], shape (samples, N)."""
        return self.angles(2.0 * np.pi * np.arange(samples) / samples, n_joints)
