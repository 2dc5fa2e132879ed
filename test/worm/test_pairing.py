"""Travelling waves are told from standing ones and from strangers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from waves_of import FPS, Truth, recorded

from omega_turn_ros.worm.components import Components, centred, principal_components
from omega_turn_ros.worm.pairing import pair_components, typical_frequency

TIME = np.arange(640) / FPS


def components_of(truth: Truth, count: int) -> Components:
    return principal_components([centred(recorded(truth, noise=0.002))], count)


def two_waves(k: tuple[float, float], rates: tuple[float, float]) -> Truth:
    phases = tuple(-2.0 * np.pi * rate * TIME for rate in rates)
    sizes = (np.full(TIME.size, 0.5), np.full(TIME.size, 0.2))
    return Truth(k, sizes, (phases[0], phases[1]))


def test_two_waves_of_orthogonal_shapes_are_two_pairs() -> None:
    pairs = pair_components(components_of(two_waves((1.0, 2.0), (0.4, 0.65)), 4), FPS)
    assert [pair.components for pair in pairs] == [(0, 1), (2, 3)]
    for pair, k in zip(pairs, (1.0, 2.0)):
        assert pair.k == pytest.approx(k, abs=0.02)
        assert abs(pair.space_phase) == pytest.approx(0.5 * math.pi, abs=0.05)
        assert pair.quality > 0.95 and pair.travels
    assert pairs[0].variance + pairs[1].variance == pytest.approx(1.0, abs=0.01)


def test_a_wave_that_turns_round_still_travels() -> None:
    there_and_back = 2.0 * np.pi * 0.5 * np.abs(TIME - TIME[-1] / 2)
    still = np.zeros(TIME.size)
    truth = Truth((1.0, 2.0), (still + 0.5, still), (there_and_back, still))
    (pair,) = pair_components(components_of(truth, 2), FPS)
    assert pair.time_quadrature > 0.8 and pair.travels


def test_a_standing_wave_beside_another_is_no_travelling_wave() -> None:
    """Two shapes a quarter wave apart that swing to and fro together."""
    rng = np.random.default_rng(0)
    swing = np.cos(2.0 * np.pi * 0.4 * TIME)
    place = 2.0 * np.pi * np.arange(1, 25) / 24
    shapes = np.stack([np.sin(place), np.cos(place)]) / math.sqrt(12.0)
    drift = 0.1 * rng.normal(size=TIME.size)
    scores = np.column_stack([swing, 0.9 * swing + drift])
    found = Components(shapes, np.array([0.55, 0.45]), (scores,))
    (pair,) = pair_components(found, FPS)
    assert pair.space_quadrature > 0.95
    assert pair.time_quadrature < 0.25 and not pair.travels


def test_shapes_of_different_wavelength_are_no_wave() -> None:
    place = 2.0 * np.pi * np.arange(1, 25) / 24
    shapes = np.stack([np.sin(place), np.cos(3.0 * place)]) / math.sqrt(12.0)
    angle = 2.0 * np.pi * 0.4 * TIME
    found = Components(
        shapes, np.array([0.5, 0.5]), (np.column_stack([np.cos(angle), np.sin(angle)]),)
    )
    (pair,) = pair_components(found, FPS)
    assert pair.time_quadrature > 0.9
    assert not pair.travels


def test_an_odd_component_stays_alone() -> None:
    pairs = pair_components(components_of(two_waves((1.0, 2.0), (0.4, 0.65)), 3), FPS)
    assert len(pairs) == 1


def test_the_typical_frequency_is_that_of_the_undulation() -> None:
    found = components_of(two_waves((1.0, 2.0), (0.4, 0.4)), 2)
    assert typical_frequency(found.scores, FPS) == pytest.approx(0.4, abs=0.05)
