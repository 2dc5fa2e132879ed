"""The paper's gaits: amplitudes and phase lag prescribed by eq:prescribe_amp."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.gaits.gait_fields import check_number, with_fields
from omega_turn_ros.gaits.wave_gait import WaveGait


@dataclass(frozen=True, slots=True)
class TwoWaveGait(WaveGait):
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
            check_number(field, getattr(self, field))

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

    def waves_at(self, phase: float) -> tuple[float, float, float, float]:
        """See `WaveGait.waves_at`."""
        tau_f = phase - self.psi
        forward = self.a_f * (self.gamma + math.sin(tau_f + self.phi_f))
        return forward, tau_f, self.a_o * (1.0 + math.sin(phase + self.phi_o)), phase

    def scaled(self, factor: float) -> TwoWaveGait:
        """See `WaveGait.scaled`."""
        return replace(self, a_f=self.a_f * factor, a_o=self.a_o * factor)

    @classmethod
    def from_mapping(cls, parameters: dict[str, Any]) -> TwoWaveGait:
        """Build the gait of a library file's parameters.

        Raises:
            BadInputError: a field is missing, unknown or not a finite number.
        """
        return cls(**with_fields(parameters, cls.__slots__))

    def to_mapping(self) -> dict[str, Any]:
        """Parameters for a library file, rounded to 1e-9."""
        return {field: round(float(value), 9) for field, value in asdict(self).items()}
