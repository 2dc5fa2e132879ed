"""Successive halving with CMA-ES, on costs whose minimum is known."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from omega_turn_ros.design.search import SearchResult, search

Array = np.ndarray
DEEP, SHALLOW = np.array([1.0, -0.5, 0.3]), np.array([-1.0, 0.8, -0.4])


def two_basins(x: Array) -> Array:
    """A wide basin of depth 1 and a narrower one of depth 2."""
    deep = 2.0 * np.exp(-2.0 * np.square(x - DEEP).sum(axis=1))
    return -np.maximum(deep, np.exp(-np.square(x - SHALLOW).sum(axis=1)))


def directions(x: Array) -> Array:
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def found(cost=two_basins, starts: int = 8, seed: int = 1) -> SearchResult:
    candidates = np.random.default_rng(seed).uniform(-2.0, 2.0, (200, 3))
    return search(cost, cost, directions, candidates, starts, seed)


@pytest.mark.parametrize('seed', range(6))
def test_the_deeper_basin_is_found_and_its_bottom(seed: int) -> None:
    result = found(seed=seed)
    np.testing.assert_allclose(result.best, DEEP, atol=0.02)
    assert result.cost == pytest.approx(-2.0, abs=1e-3)


def test_equal_seeds_give_equal_results_whatever_else_draws_random_numbers() -> None:
    def drawing(x: Array) -> Array:
        np.random.random(7)
        return two_basins(x)

    alone = found()
    assert found(drawing).best.tolist() == alone.best.tolist()
    with ThreadPoolExecutor(2) as pool:
        for other in pool.map(lambda _: found(), range(2)):
            assert other.best.tolist() == alone.best.tolist()
    assert found(seed=2).best.tolist() != alone.best.tolist()


def test_accounts_are_of_what_was_done() -> None:
    counted = 0

    def counting(x: Array) -> Array:
        nonlocal counted
        counted += len(x)
        return two_basins(x)

    result = found(counting, starts=8)
    assert result.evaluations == counted
    assert 4 <= result.starts <= 8
    assert result.tops == tuple(sorted(result.tops, reverse=True))
    assert result.tops[0] == pytest.approx(2.0, abs=0.05)
    assert result.reason


def test_candidates_too_much_alike_make_fewer_starts() -> None:
    along = np.linspace(0.5, 2.0, 40)[:, None] * DEEP
    result = search(two_basins, two_basins, directions, along, 8, 1)
    assert result.starts == 1
    np.testing.assert_allclose(result.best, DEEP, atol=0.02)


def test_a_flat_cost_ends_the_search() -> None:
    assert found(lambda x: np.zeros(len(x))).cost == 0.0
