"""Principal components and their sines, beside numpy's own decomposition."""

from __future__ import annotations

import numpy as np
import pytest
from waves_of import recorded, steady, turning, undulating

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.worm.components import centred, common_positions, principal_components
from omega_turn_ros.worm.sines import MOST_K, best_k, fit_sine, sine_basis


def test_components_are_those_of_the_singular_value_decomposition() -> None:
    trials = [centred(recorded(undulating(frames=n), noise=0.05, seed=n)) for n in (200, 90)]
    found = principal_components(trials, 5)
    _, sizes, shapes = np.linalg.svd(np.concatenate(trials), full_matrices=False)
    np.testing.assert_allclose(found.variance, sizes**2 / (sizes**2).sum(), atol=1e-12)
    np.testing.assert_allclose(np.abs(found.shapes @ shapes[:5].T), np.eye(5), atol=1e-9)
    for trial, scores in zip(trials, found.scores):
        np.testing.assert_allclose(scores, trial @ found.shapes.T)
    assert found.explained == pytest.approx(found.variance[:5].sum())


def test_components_know_neither_the_side_nor_the_mean_posture_of_a_trial() -> None:
    trial = recorded(turning())
    other = type(trial)('other', 0.07 - trial.angles, trial.fps)
    alone = principal_components([centred(trial)] * 2, 4)
    pooled = principal_components([centred(trial), centred(other)], 4)
    np.testing.assert_allclose(pooled.shapes, alone.shapes, atol=1e-9)
    kept = principal_components([centred(t, 'keep') for t in (trial, other)], 4)
    assert np.abs(kept.shapes - alone.shapes).max() > 0.01


@pytest.mark.parametrize('count', [1, 25])
def test_a_number_of_components_out_of_range_is_refused(count: int) -> None:
    with pytest.raises(BadInputError, match=r'^components: '):
        principal_components([centred(recorded(steady(1.0, 1.5)))], count)


def test_other_refusals_name_the_field() -> None:
    with pytest.raises(BadInputError, match=r'^mean_posture: '):
        centred(recorded(steady(1.0, 1.5)), 'drop')
    with pytest.raises(BadInputError, match=r'^trials: '):
        common_positions([])


def test_trials_are_brought_to_the_fewest_positions() -> None:
    trials = common_positions([recorded(turning(), n) for n in (48, 20, 30)])
    assert [trial.n_positions for trial in trials] == [20, 20, 20]


@pytest.mark.parametrize('k', [0.3, 0.75, 1.0, 1.5, 2.2])
def test_the_sine_of_a_shape_comes_back(k: float) -> None:
    shape = sine_basis([k], 24) @ (0.3, -0.2)
    fit = fit_sine(shape)
    assert fit.k == pytest.approx(k, abs=1e-4)
    assert (fit.sine, fit.cosine) == pytest.approx((0.3, -0.2), abs=1e-3)
    assert fit.explained == pytest.approx(1.0) and fit.k_std < 1e-3
    np.testing.assert_allclose(fit.values(24), shape, atol=1e-5)


def test_the_fits_standard_deviation_is_the_scatter_of_fits() -> None:
    rng = np.random.default_rng(3)
    clean = sine_basis([1.2], 24) @ (0.3, 0.1)
    fits = [fit_sine(clean + rng.normal(0.0, 0.04, 24)) for _ in range(300)]
    scatter = np.std([fit.k for fit in fits])
    assert np.sqrt(np.mean([fit.k_std**2 for fit in fits])) == pytest.approx(scatter, rel=0.15)


def test_the_best_k_beats_every_other() -> None:
    rng = np.random.default_rng(4)
    for shape in rng.normal(size=(5, 20)):
        k = best_k(np.outer(shape, shape))
        grid = np.linspace(0.1, MOST_K, 800)
        others = max(fit_sine(shape, other).explained for other in grid)
        assert fit_sine(shape, k).explained >= others - 1e-5
