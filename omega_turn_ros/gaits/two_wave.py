"""The two-wave template (eq:template) and the turning gaits that are its members.

    theta_i = A_f sin(tau_f + 2 pi k_f i/N) + A_t sin(tau_t + 2 pi k_t i/N),   i = 1..N

tau_t = 2 pi omega t and tau_f = tau_t - psi (f_3 of eq:prescribe_amp). A gait is a closed path:
its amplitudes are functions of the phases (f_1, f_2). The mirrored turn negates both amplitudes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError


def two_wave_angles(
    amplitude_forward: ArrayLike,
    phase_forward: ArrayLike,
    amplitude_turning: ArrayLike,
    phase_turning: ArrayLike,
    k_forward: float,
    k_turning: float,
    n_joints: int,
) -> NDArray[np.float64]:
    """Evaluate eq:template for any broadcastable set of amplitudes and phases.

    Args:
        amplitude_forward: A_f [rad], shape (...).
        phase_forward: tau_f [rad], shape (...).
        amplitude_turning: A_t [rad], shape (...).
        phase_turning: tau_t [rad], shape (...).
        k_forward: spatial frequency k_f, waves on the body.
        k_turning: spatial frequency k_t, waves on the body.
        n_joints: N, the number of yaw joints.

    Returns:
        Yaw joint angles theta_1..theta_N [rad], shape (..., N).
    """
    position = 2.0 * np.pi * np.arange(1, n_joints + 1) / n_joints
    forward = _wave(amplitude_forward, phase_forward, k_forward * position)
    return forward + _wave(amplitude_turning, phase_turning, k_turning * position)


def _wave(amplitude: ArrayLike, phase: ArrayLike, lag: NDArray[np.float64]) -> NDArray[np.float64]:
    """A sin(phase + lag) by the addition theorem: sines of T phases and N lags, not of T N."""
    size, angle = np.asarray(amplitude, float), np.asarray(phase, float)
    sine, cosine = (size * np.sin(angle))[..., None], (size * np.cos(angle))[..., None]
    result: NDArray[np.float64] = sine * np.cos(lag) + cosine * np.sin(lag)
    return result


def serpenoid(amplitude: ArrayLike, phase: ArrayLike, k: float, n: int) -> NDArray[np.float64]:
    """Serpenoid curve (eq:serpenoidOri): the forward wave alone. Shapes as `two_wave_angles`."""
    return two_wave_angles(amplitude, phase, 0.0, 0.0, k, 0.0, n)


def offset_turn(
    amplitude: ArrayLike, phase: ArrayLike, offset: ArrayLike, k: float, n: int
) -> NDArray[np.float64]:
    """Offset turn (eq:serpenoid, eq:offset): k_t = 0 makes the turning wave an offset kappa.

    Args:
        amplitude: A [rad], shape (...).
        phase: 2 pi omega t [rad], shape (...).
        offset: kappa [rad], added to every joint, shape (...).
        k: spatial frequency of the serpenoid wave.
        n: number of yaw joints.

    Returns:
        Yaw joint angles [rad], shape (..., n).
    """
    return two_wave_angles(amplitude, phase, offset, 0.5 * np.pi, k, 0.0, n)


def geometric_turn(r_1: ArrayLike, r_2: ArrayLike, k: float, n: int) -> NDArray[np.float64]:
    """Geometric turn (eq:basis): a sine and a cosine mode, i.e. two waves of equal k, psi = pi/2.

    Args:
        r_1: weight of sin(2 pi k i/N) [rad], shape (...).
        r_2: weight of cos(2 pi k i/N) [rad], shape (...).
        k: spatial frequency of both modes.
        n: number of yaw joints.

    Returns:
        Yaw joint angles [rad], shape (..., n).
    """
    return two_wave_angles(r_1, 0.0, r_2, 0.5 * np.pi, k, k, n)


@dataclass(frozen=True, slots=True)
class TwoWaveGait:
    """One turning gait: a closed path in [A_f, tau_f, A_t, tau_t] (eq:prescribe_amp).

    f_1: A_f = a_f (gamma + sin(tau_f + phi_f)); f_2: A_t = a_o (1 + sin(tau_t + phi_o));
    f_3: tau_f = tau_t - psi.

    Attributes:
        k_f: spatial frequency of the forward wave.
        k_t: spatial frequency of the turning wave (0 offset, 1 omega, k_f geometric turn).
        a_f: [rad].
        gamma: mean of f_1 over a_f.
        phi_f: [rad].
        a_o: [rad].
        phi_o: [rad].
        psi: phase of the turning wave ahead of the forward wave [rad].
    """

    k_f: float
    k_t: float
    a_f: float
    gamma: float
    phi_f: float
    a_o: float
    phi_o: float
    psi: float

    def __post_init__(self) -> None:
        """Refuse anything that is not a finite number."""
        for field in self.__slots__:
            value = getattr(self, field)
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise BadInputError(f'gait field {field}', value, 'a number')
            if not math.isfinite(value):
                raise BadInputError(f'gait field {field}', value, 'a finite number')

    def phases(self, phase: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return (tau_f, tau_t) [rad], each shape (...), at gait phase tau_t [rad], (...)."""
        tau_t = np.asarray(phase, float)
        return tau_t - self.psi, tau_t

    def amplitudes(self, phase: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return (A_f, A_t) [rad], each shape (...), at gait phase [rad], shape (...)."""
        tau_f, tau_t = self.phases(phase)
        forward = self.a_f * (self.gamma + np.sin(tau_f + self.phi_f))
        turning = self.a_o * (1.0 + np.sin(tau_t + self.phi_o))
        return forward, turning

    def angles(
        self,
        phase: ArrayLike,
        n_joints: int,
        scale: ArrayLike = 1.0,
        offsets: tuple[ArrayLike, ArrayLike] = (0.0, 0.0),
    ) -> NDArray[np.float64]:
        """Joint angles at a gait phase.

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

    def mirrored(self) -> TwoWaveGait:
        """Return the gait that turns the other way: both amplitudes negated."""
        return replace(self, a_f=-self.a_f, a_o=-self.a_o)

    def sampled(self, n_joints: int, samples: int = 720) -> NDArray[np.float64]:
        """Angles over one cycle from phase 0, end excluded [rad], shape (samples, N)."""
        return self.angles(2.0 * np.pi * np.arange(samples) / samples, n_joints)
