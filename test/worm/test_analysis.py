"""The whole analysis, and how sure it says it is."""

from __future__ import annotations

import numpy as np
import pytest
from waves_of import recorded, turning, undulating

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.worm.analysis import analyse
from omega_turn_ros.worm.components import centred, principal_components
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.resampling import resample
from omega_turn_ros.worm.template import best_pair


def test_the_stated_spread_is_the_scatter_of_fresh_recordings() -> None:
    """Noise that differs from frame to frame: the standard deviation can be known."""
    truth = undulating(0.9, 1.6, 240)
    postures = [centred(recorded(truth, noise=0.08, seed=k)) for k in range(50)]
    pairs = np.array([best_pair(x.T @ x, (0.9, 1.6), 1e-3) for x in postures])
    shapes = np.eye(24)[:2]
    spreads = [resample([x], shapes, (0.9, 1.6), 1.0, 0, 40) for x in postures[:4]]
    stated = [spread.pair.std(axis=0) for spread in spreads]
    np.testing.assert_allclose(np.mean(stated, axis=0), pairs.std(axis=0), rtol=0.35)


def test_equal_seeds_give_equal_spreads() -> None:
    posture = centred(recorded(turning()))
    shapes = principal_components([posture], 3).shapes
    spreads = [resample([posture], shapes, (1.0, 1.5), 53.0, seed, 20) for seed in (5, 5, 6)]
    np.testing.assert_array_equal(spreads[0].pair, spreads[1].pair)
    np.testing.assert_array_equal(spreads[0].component_k, spreads[1].component_k)
    assert np.any(spreads[0].pair != spreads[2].pair)
    assert spreads[0].component_k.shape == (20, 3)
    assert spreads[0].block == 200 // 8


def test_trials_of_unequal_length_and_positions_are_analysed_together() -> None:
    trials = [recorded(turning(frames=n), m, seed=n) for n, m in ((150, 24), (64, 48), (90, 30))]
    found = analyse(trials)
    assert (found.waves.k_t, found.waves.k_f) == pytest.approx((1.0, 1.5), abs=0.02)
    assert [trial.n_positions for trial in found.trials] == [24, 24, 24]
    assert found.components.explained > 0.99


def test_what_cannot_be_analysed_together_is_refused() -> None:
    trial = recorded(turning())
    slow = Kymograph('slow', trial.angles, 30.0)
    with pytest.raises(BadInputError, match=r'^fps: '):
        analyse([trial, slow])
    for count in (1, 13):
        with pytest.raises(BadInputError, match=r'^components: '):
            analyse([trial], count)
