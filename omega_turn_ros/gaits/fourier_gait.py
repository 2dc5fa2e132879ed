"""Richer gaits than the paper's: f_1, f_2 and f_3 as Fourier series (beyond eq:prescribe_amp)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.gait_fields import check_number, with_fields
from omega_turn_ros.gaits.wave_gait import WaveGait

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class FourierGait(WaveGait):
    """Two waves whose amplitudes and phase lag are series in the phases (own extension).

    f_1: A_f = F(tau_f); f_2: A_t = T(tau_t); f_3: tau_f = tau_t - L(tau_t), each a series
    c_0 + sum_m (c_{2m-1} cos(m tau) + c_{2m} sin(m tau)).

    Attributes:
        k_f: spatial frequency of the forward wave.
        k_t: spatial frequency of the turning wave.
        forward: coefficients of F [rad], odd number.
        turning: coefficients of T [rad], odd number.
        lag: coefficients of L [rad], odd number.
    """

    k_f: float
    k_t: float
    forward: tuple[float, ...]
    turning: tuple[float, ...]
    lag: tuple[float, ...]

    def __post_init__(self) -> None:
        """Refuse series that are no series of finite numbers."""
        for field in ('k_f', 'k_t'):
            check_number(field, getattr(self, field))
        for field in ('forward', 'turning', 'lag'):
            series = getattr(self, field)
            if not isinstance(series, tuple) or len(series) % 2 == 0:
                expected = 'an odd number of coefficients: mean, then cosine and sine pairs'
                raise BadInputError(f'gait field {field}', series, expected)
            for value in series:
                check_number(field, value)

    def phases(self, phase: ArrayLike) -> tuple[Array, Array]:
        """See `WaveGait.phases`."""
        _, tau_f, _, tau_t = fourier_waves(phase, self.forward, self.turning, self.lag)
        return tau_f, tau_t

    def amplitudes(self, phase: ArrayLike) -> tuple[Array, Array]:
        """See `WaveGait.amplitudes`."""
        forward, _, turning, _ = fourier_waves(phase, self.forward, self.turning, self.lag)
        return forward, turning

    def waves_at(self, phase: float) -> tuple[float, float, float, float]:
        """See `WaveGait.waves_at`."""
        tau_f = phase - _sum(self.lag, phase)
        return _sum(self.forward, tau_f), tau_f, _sum(self.turning, phase), phase

    def scaled(self, factor: float) -> FourierGait:
        """See `WaveGait.scaled`."""
        return replace(
            self,
            forward=tuple(factor * c for c in self.forward),
            turning=tuple(factor * c for c in self.turning),
        )

    @classmethod
    def from_mapping(cls, parameters: dict[str, Any]) -> FourierGait:
        """Build the gait of a library file's parameters.

        Raises:
            BadInputError: a field is missing, unknown or no series of finite numbers.
        """
        parameters = with_fields(parameters, cls.__slots__)
        series = {k: v for k, v in parameters.items() if k not in ('k_f', 'k_t')}
        for field, values in series.items():
            if not isinstance(values, list):
                raise BadInputError(f'gait field {field}', values, 'a list of coefficients')
        rest: dict[str, Any] = {k: tuple(v) for k, v in series.items()}
        return cls(k_f=parameters['k_f'], k_t=parameters['k_t'], **rest)

    def to_mapping(self) -> dict[str, Any]:
        """Parameters for a library file, rounded to 1e-9."""
        return {
            field: [round(float(c), 9) for c in value]
            if isinstance(value, tuple)
            else round(float(value), 9)
            for field, value in asdict(self).items()
        }


def fourier_waves(
    phase: ArrayLike,
    forward: Sequence[ArrayLike],
    turning: Sequence[ArrayLike],
    lag: Sequence[ArrayLike],
) -> tuple[Array, Array, Array, Array]:
    """Amplitudes and phases of many gaits at once; coefficients as in `FourierGait`.

    Args:
        phase: gait phase tau_t [rad], shape (...).
        forward: coefficients of F [rad], each broadcasting with `phase`.
        turning: coefficients of T [rad], likewise.
        lag: coefficients of L [rad], likewise.

    Returns:
        A_f, tau_f, A_t, tau_t [rad], each shape (...).
    """
    tau_t = np.asarray(phase, float)
    tau_f = tau_t - _series(lag, tau_t)
    return _series(forward, tau_f), tau_f, _series(turning, tau_t), tau_t


def _series(coefficients: Sequence[ArrayLike], tau: Array) -> Array:
    total: Array = np.asarray(coefficients[0], float) + np.zeros_like(tau)
    for m in range(1, len(coefficients) // 2 + 1):
        total = total + np.asarray(coefficients[2 * m - 1]) * np.cos(m * tau)
        total = total + np.asarray(coefficients[2 * m]) * np.sin(m * tau)
    return total


def _sum(coefficients: tuple[float, ...], tau: float) -> float:
    total = coefficients[0]
    for m in range(1, len(coefficients) // 2 + 1):
        total += coefficients[2 * m - 1] * math.cos(m * tau)
        total += coefficients[2 * m] * math.sin(m * tau)
    return total
