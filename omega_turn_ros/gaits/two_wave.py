"""The two-wave template (eq:template) and the turning gaits that are its members.

    theta_i = A_f sin(tau_f + 2 pi k_f i/N) + A_t sin(tau_t + 2 pi k_t i/N),   i = 1..N

with tau_t = 2 pi omega t and tau_f = tau_t - psi (f_3 of eq:prescribe_amp).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


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
