"""The admittance law on the two wave amplitudes (eq:admittance), as one pure step.

    M d'' + B d' + K d = J tau_ext,    A = A_nominal(phase) + d

The paper writes the law for A about a constant A_0; acting on the offset d is the same there and
leaves a gait with time-varying amplitudes exact while nothing pushes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class AdmittanceConfig:
    """Constants of the law, one per wave (forward, turning).

    Attributes:
        mass: diagonal of M [N m s^2/rad], > 0.
        damping: diagonal of B [N m s/rad], >= 0.
        stiffness: diagonal of K [N m/rad], > 0.
        offset_limit: |d| stays within this [rad].
        rate_limit: |d'| stays within this [rad/s].
    """

    mass: tuple[float, float] = (1.0, 1.0)
    damping: tuple[float, float] = (8.0, 8.0)
    stiffness: tuple[float, float] = (8.0, 8.0)
    offset_limit: float = 0.5
    rate_limit: float = 1.0

    def __post_init__(self) -> None:
        """Refuse constants that make the law unstable or deaf."""
        for field in ('mass', 'damping', 'stiffness'):
            values = getattr(self, field)
            floor_ok = all(math.isfinite(v) and v >= 0.0 for v in values)
            if len(values) != 2 or not floor_ok or (field != 'damping' and min(values) == 0.0):
                bound = '>= 0' if field == 'damping' else '> 0'
                raise BadInputError(field, values, f'two finite numbers {bound}')
        for field in ('offset_limit', 'rate_limit'):
            value = getattr(self, field)
            if not math.isfinite(value) or value <= 0.0:
                raise BadInputError(field, value, 'a finite number > 0')


@dataclass(frozen=True, slots=True)
class AdmittanceState:
    """Amplitude offsets of (forward, turning) wave.

    Attributes:
        offset: d [rad], shape (2,).
        rate: d' [rad/s], shape (2,).
    """

    offset: tuple[float, float] = (0.0, 0.0)
    rate: tuple[float, float] = (0.0, 0.0)


def wave_jacobian(
    phase_forward: float, phase_turning: float, k_forward: float, k_turning: float, n_joints: int
) -> Array:
    """D theta / d(A_f, A_t), transposed: the J of eq:admittance.

    Returns:
        Row 0: sin(tau_f + 2 pi k_f i/N); row 1: the same of the turning wave; shape (2, N).
    """
    position = 2.0 * np.pi * np.arange(1, n_joints + 1) / n_joints
    return np.sin(
        np.stack(
            [phase_forward + k_forward * position, phase_turning + k_turning * position], axis=0
        )
    )


def admittance_step(
    state: AdmittanceState, force: ArrayLike, dt: float, config: AdmittanceConfig
) -> AdmittanceState:
    """Advance the law by one step of semi-implicit Euler.

    Damping and stiffness act on the new rate, so no choice of constants makes the step unstable.
    The bounds act inside the integrator: a saturated offset carries no rate into its bound and
    leaves it the moment the force turns (anti-windup).

    Args:
        state: offsets and their rates.
        force: J tau_ext [N m], shape (2,).
        dt: [s], >= 0; 0 changes nothing.
        config: constants.
    """
    if dt <= 0.0:
        return state
    offsets, rates = [], []
    values = np.asarray(force, float)
    for i in range(2):
        m, b, k = config.mass[i], config.damping[i], config.stiffness[i]
        old = state.offset[i]
        rate = (m * state.rate[i] + dt * (float(values[i]) - k * old)) / (m + dt * b + dt * dt * k)
        rate = min(max(rate, -config.rate_limit), config.rate_limit)
        offset = min(max(old + dt * rate, -config.offset_limit), config.offset_limit)
        offsets.append(offset)
        rates.append((offset - old) / dt)
    return AdmittanceState((offsets[0], offsets[1]), (rates[0], rates[1]))


def relax_step(state: AdmittanceState, dt: float, rate: float) -> AdmittanceState:
    """Bring the offsets to 0 at no more than `rate` [rad/s]: what happens without torques."""
    if dt <= 0.0:
        return state
    offsets = tuple(math.copysign(max(abs(d) - rate * dt, 0.0), d) for d in state.offset)
    rates = tuple((new - old) / dt for new, old in zip(offsets, state.offset))
    return AdmittanceState((offsets[0], offsets[1]), (rates[0], rates[1]))


def stored_energy(state: AdmittanceState, config: AdmittanceConfig) -> float:
    """Storage function of the law: d' M d'/2 + d K d/2 [N m]."""
    return 0.5 * sum(
        m * v * v + k * d * d
        for m, k, d, v in zip(config.mass, config.stiffness, state.offset, state.rate)
    )
