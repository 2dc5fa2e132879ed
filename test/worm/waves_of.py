"""Kymographs of known waves, for tests."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from omega_turn_ros.worm.components import centred
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.template import TwoWaves, fit_two_waves

FPS = 32.0


@dataclass(frozen=True)
class Truth:
    """Two waves: A sin(tau + 2 pi k i/N), turning first."""

    k: tuple[float, float]
    amplitudes: tuple[np.ndarray, np.ndarray]
    phases: tuple[np.ndarray, np.ndarray]

    def angles(self, positions: int) -> np.ndarray:
        """Joint angles of a body of 24 positions, told at so many [rad]."""
        place = 2.0 * np.pi * np.arange(1, positions + 1) / positions
        waves = (
            a[:, None] * np.sin(tau[:, None] + k * place)
            for k, a, tau in zip(self.k, self.amplitudes, self.phases)
        )
        return sum(waves) * 24.0 / positions


def steady(k_t: float, k_f: float, frames: int = 200, sign: float = -1.0) -> Truth:
    """Waves of constant amplitude on one clock; sign -1 travels from head to tail."""
    tau = sign * 2.0 * np.pi * 0.6 * np.arange(frames) / FPS
    return Truth((k_t, k_f), (np.full(frames, 0.4), np.full(frames, 0.3)), (tau, tau + 1.0))


def turning(k_t: float = 1.0, k_f: float = 1.5, frames: int = 200, sign: float = -1.0) -> Truth:
    """The paper's kind of turn: amplitudes that change with the phase (eq:prescribe_amp)."""
    tau_t, tau_f = steady(k_t, k_f, frames, sign).phases
    amplitudes = 0.4 * (1.0 + np.sin(tau_t + 0.3)), 0.3 * (0.2 + np.sin(tau_f + 0.5))
    return Truth((k_t, k_f), amplitudes, (tau_t, tau_f))


def undulating(k_t: float = 1.0, k_f: float = 1.5, frames: int = 600) -> Truth:
    """Waves on clocks of their own: four independent components; reverses half-way."""
    time = np.arange(frames) / FPS
    tau = 2.0 * np.pi * 0.5 * np.abs(time - 0.5 * time[-1])
    amplitudes = 0.5 + 0.1 * np.sin(0.7 * time), 0.3 + 0.1 * np.cos(1.1 * time)
    return Truth((k_t, k_f), amplitudes, (tau, 1.6 * tau + 0.4))


def recorded(
    truth: Truth, positions: int = 24, noise: float = 0.015, seed: int = 0, name: str = 'made'
) -> Kymograph:
    """A recording of the waves; noise [rad] of 24 positions."""
    angles = truth.angles(positions)
    rng = np.random.default_rng(seed)
    angles = angles + rng.normal(0.0, noise, angles.shape) * 24.0 / positions
    return Kymograph(name, angles, FPS)


def fitted(*trials: Kymograph) -> TwoWaves:
    """The template fitted to recordings."""
    return fit_two_waves([centred(t) for t in trials], [t.angles for t in trials], FPS)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt((np.abs(values) ** 2).mean()))
