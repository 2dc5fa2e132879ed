"""Means of seeded trials, and how sure they are."""

from __future__ import annotations

import numpy as np
import pytest

from omega_turn_lab.studies.spread import spread_of


def test_interval_covers_the_true_mean_about_as_often_as_it_says() -> None:
    rng = np.random.default_rng(0)
    covered = 0
    for k in range(60):
        spread = spread_of(rng.normal(3.0, 2.0, 20).tolist(), k)
        covered += spread.low <= 3.0 <= spread.high
    assert 51 <= covered < 60  # 95 % of 60 is 57


def test_interval_shrinks_with_the_root_of_the_sample() -> None:
    rng = np.random.default_rng(1)
    few, many = (spread_of(rng.normal(0.0, 1.0, n).tolist(), 0) for n in (25, 400))
    assert (few.high - few.low) / (many.high - many.low) == pytest.approx(4.0, rel=0.35)


def test_equal_seeds_give_equal_intervals() -> None:
    sample = [1.0, 4.0, 2.0, 8.0]
    assert spread_of(sample, 3) == spread_of(sample, 3)
    assert spread_of(sample, 3).deviation == pytest.approx(np.std(sample, ddof=1))
