"""The two-wave fit gets back the waves that a recording was made of."""

from __future__ import annotations

import numpy as np
import pytest
from waves_of import Truth, fitted, recorded, rms, steady, turning, undulating

from omega_turn_ros.worm.components import centred
from omega_turn_ros.worm.sines import sine_basis
from omega_turn_ros.worm.template import LEAST_APART, best_pair

PAIRS = [(1.0, 1.5), (0.5, 1.5), (1.0, 2.0), (0.8, 1.7)]
MADE = [steady, turning, undulating]


def check(truth: Truth, positions: int, seed: int = 0) -> None:
    waves = fitted(recorded(truth, positions, seed=seed))
    assert (waves.k_t, waves.k_f) == pytest.approx(truth.k, abs=0.02)
    found = (waves.turning[0], waves.forward[0])
    for wave, amplitude, phase in zip(found, truth.amplitudes, truth.phases):
        told = amplitude * 24.0 / positions
        assert rms(wave.amplitude) == pytest.approx(rms(told), rel=0.02)
        true = told * np.exp(1j * phase)
        # k and phase trade off along the body: where k is 0.01 off, so is the phase
        assert rms(wave.signal - true) < 0.08 * rms(true)
    assert waves.distinct and waves.explained > 0.98


@pytest.mark.parametrize('pair', PAIRS)
@pytest.mark.parametrize('make', MADE)
def test_known_waves_come_back(make: type[Truth], pair: tuple[float, float]) -> None:
    check(make(*pair), 24)


@pytest.mark.parametrize('positions', [16, 48, 100])
def test_the_number_of_body_positions_does_not_matter(positions: int) -> None:
    check(turning(), positions)


def test_one_short_turn_is_enough() -> None:
    check(turning(frames=70), 48)


def test_both_turn_senses_and_sides_and_either_end_first_give_the_same_waves() -> None:
    trial = recorded(turning())
    waves = fitted(trial)
    other = [-trial.angles, trial.angles[:, ::-1], trial.angles[::-1]]
    for angles in other:
        again = fitted(type(trial)('other', angles, trial.fps))
        assert (again.k_t, again.k_f) == pytest.approx((waves.k_t, waves.k_f), abs=1e-3)
        for one, two in ((again.turning, waves.turning), (again.forward, waves.forward)):
            assert rms(one[0].amplitude) == pytest.approx(rms(two[0].amplitude), rel=1e-3)


@pytest.mark.parametrize('sign', [-1.0, 1.0])
def test_direction_and_frequency_of_travel_are_told(sign: float) -> None:
    waves = fitted(recorded(steady(1.0, 1.5, sign=sign)))
    for wave in (*waves.turning, *waves.forward):
        assert wave.backward_share == pytest.approx(0.5 - 0.5 * sign, abs=0.02)
        assert wave.frequency == pytest.approx(0.6, rel=0.03)
        assert wave.phase[-1] - wave.phase[0] == pytest.approx(
            sign * 2.0 * np.pi * 0.6 * 199 / 32.0, abs=0.3
        )


def test_waves_and_residual_add_up_to_the_recording_but_for_a_rest_posture() -> None:
    trial = recorded(turning(), noise=0.03)
    waves = fitted(trial)
    both = waves.turning[0].angles(24) + waves.forward[0].angles(24)
    rest = trial.angles - both - waves.residual[0]
    assert np.ptp(rest, axis=0).max() < 1e-12
    assert rms(waves.residual[0]) == pytest.approx(0.03 * np.sqrt(20 / 24), rel=0.05)


def test_a_rest_posture_does_not_move_the_spatial_frequencies() -> None:
    trial = recorded(turning(frames=320))
    posture = 0.1 * np.cos(np.linspace(0.0, 9.0, 24))
    bent = type(trial)('bent', trial.angles + posture, trial.fps)
    first, second = fitted(trial), fitted(bent)
    assert (second.k_t, second.k_f) == pytest.approx((first.k_t, first.k_f), abs=1e-6)


def test_trials_are_pooled() -> None:
    trials = [recorded(turning(frames=48), noise=0.06, seed=k) for k in range(12)]
    pooled = fitted(*trials)
    assert (pooled.k_t, pooled.k_f) == pytest.approx((1.0, 1.5), abs=0.02)
    alone = [fitted(trial) for trial in trials]
    worst = max(abs(waves.k_f - 1.5) for waves in alone)
    assert abs(pooled.k_f - 1.5) < worst
    assert len(pooled.turning) == 12 and pooled.turning[5].signal.shape == (48,)


def test_one_wave_that_grows_along_the_body_is_not_two() -> None:
    tau = -2.0 * np.pi * 0.6 * np.arange(200) / 32.0
    place = np.arange(1, 25) / 24
    angles = np.sin(tau[:, None] + 2.0 * np.pi * 1.3 * place) * (0.2 + 0.3 * place)
    waves = fitted(type(recorded(steady(1, 2)))('one', angles, 32.0))
    assert not waves.distinct
    assert waves.k_f - waves.k_t == pytest.approx(LEAST_APART, abs=1e-3)


def test_the_search_finds_what_trying_every_pair_finds() -> None:
    """Against a slow search with numpy's own least squares, frame by frame."""
    posture = centred(recorded(undulating(0.9, 1.6, 120), noise=0.05))
    best = min(
        (
            float(np.linalg.lstsq(sine_basis([k_t, k_f], 24), posture.T, rcond=None)[1].sum()),
            k_t,
            k_f,
        )
        for k_t in np.arange(0.7, 1.2, 0.02)
        for k_f in np.arange(1.4, 1.8, 0.02)
    )
    assert best_pair(posture.T @ posture) == pytest.approx(best[1:], abs=0.011)
