"""A two-wave gait on one robot, a single phase at a time, without delay."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from omega_turn_ros.gaits.wave_gait import WaveGait

Array = NDArray[np.float64]


class Postures:
    """A `PlayedGait` of two waves: the same angles as `WaveGait.angles`, for scalars.

    By the sum formula each wave is sin(tau) cos(2 pi k i/N) + cos(tau) sin(2 pi k i/N). The
    factors of the joints never change, so a posture is one product of 4 numbers and a table.

    Args:
        gait: the waves.
        yaw_indices: places of the yaw joints among all, shape (N,).
        n_joints: number of all joints; the others stay straight.
    """

    def __init__(self, gait: WaveGait, yaw_indices: NDArray[np.intp], n_joints: int) -> None:
        self._gait = gait
        self.rest: Array = np.zeros(n_joints)
        n = yaw_indices.size
        position = 2.0 * np.pi * np.arange(1, n + 1) / n
        waves = (gait.k_f * position, gait.k_t * position)
        self._table = np.zeros((4, n_joints))
        self._table[:, yaw_indices] = [f(wave) for wave in waves for f in (np.cos, np.sin)]

    def waypoint(self, posture: Array) -> None:
        """See `PlayedGait.waypoint`."""

    def at(self, phase: float, scale: float, offsets: tuple[float, float]) -> Array:
        """Joint angles [rad], shape (n_joints,).

        Args:
            phase: gait phase tau_t [rad].
            scale: factor on both nominal amplitudes; -1 is the mirrored turn.
            offsets: what compliance adds to (A_f, A_t) [rad].
        """
        forward, tau_f, turning, tau_t = self._gait.waves_at(phase)
        forward = scale * forward + offsets[0]
        turning = scale * turning + offsets[1]
        weights = (
            forward * math.sin(tau_f),
            forward * math.cos(tau_f),
            turning * math.sin(tau_t),
            turning * math.cos(tau_t),
        )
        posture: Array = np.dot(weights, self._table)
        return posture
