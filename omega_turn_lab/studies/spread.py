"""Means of seeded trials, and how sure they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import bootstrap

RESAMPLES = 9999
LEVEL = 0.95


@dataclass(frozen=True, slots=True)
class Spread:
    """What a sample tells.

    Attributes:
        mean: of the sample.
        deviation: standard deviation of the sample.
        low: lower end of the 95 % bootstrap interval of the mean.
        high: its upper end.
    """

    mean: float
    deviation: float
    low: float
    high: float


def spread_of(values: Sequence[float], seed: int) -> Spread:
    """Mean, standard deviation and bootstrap interval (percentile) of at least two values.

    Args:
        values: the sample.
        seed: of the resampling.
    """
    sample = np.asarray(values, float)
    found = bootstrap(
        (sample,),
        np.mean,
        n_resamples=RESAMPLES,
        confidence_level=LEVEL,
        method='percentile',
        random_state=np.random.default_rng(seed),
    )
    low, high = found.confidence_interval
    return Spread(float(sample.mean()), float(sample.std(ddof=1)), float(low), float(high))
