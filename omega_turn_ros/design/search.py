"""Several starts of CMA-ES that race: the worse half gives up after each round."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cma
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Cost = Callable[[Array], Array]  # of parameter vectors, shape (P, D): shape (P,)

STEP = 0.4  # standard deviation at first, in every direction
ROUND = 15  # generations between two halvings
TOLERANCE, FINE_TOLERANCE = 1e-3, 1e-5  # spread of costs in a generation that has converged
EVALUATIONS, FINE_EVALUATIONS = 90, 300  # at most, per parameter
SAME = 0.01  # relative difference of two optima that count as one


@dataclass(frozen=True, slots=True)
class SearchResult:
    """What a search found.

    Attributes:
        best: parameters, shape (D,).
        cost: of them.
        evaluations: of either cost, all starts.
        agreeing: starts whose coarse optimum was within 1 % of the best.
        reason: why the last search stopped.
    """

    best: Array
    cost: float
    evaluations: int
    agreeing: int
    reason: str


def search(coarse: Cost, fine: Cost, candidates: Array, starts: int, seed: int) -> SearchResult:
    """Minimise from the best of the candidates, then on a finer cost from the winner.

    Args:
        coarse: cost of parameter vectors, quick.
        fine: the cost that counts.
        candidates: parameter vectors to choose the starts from, shape (C, D), C >= starts.
        starts: how many to follow.
        seed: of CMA-ES; equal seeds give equal results.
    """
    values = coarse(candidates)
    chosen = np.argsort(values, kind='stable')[:starts]
    runs = [
        _strategy(candidates[index], STEP, TOLERANCE, EVALUATIONS, seed * 1000 + k)
        for k, index in enumerate(chosen)
    ]
    racing = runs
    while not all(run.stop() for run in racing):
        for run in racing:
            _advance(run, coarse, ROUND)
        racing = sorted(racing, key=lambda run: float(run.result.fbest))
        racing = racing[: max(2, (len(racing) + 1) // 2)]
    best = racing[0].result
    agreeing = sum(run.result.fbest <= best.fbest + SAME * abs(best.fbest) for run in runs)
    # The winner's spread tells how far the finer search has to look in each direction.
    spread = np.maximum(3.0 * best.stds, 3e-3)
    last = _strategy(best.xbest, 1.0, FINE_TOLERANCE, FINE_EVALUATIONS, seed * 1000 + 999, spread)
    _advance(last, fine)
    evaluations = len(candidates) + sum(run.result.evaluations for run in (*runs, last))
    reason = ', '.join(last.stop())
    found = last.result
    return SearchResult(np.array(found.xbest), float(found.fbest), evaluations, agreeing, reason)


def _strategy(
    start: Array,
    step: float,
    tolerance: float,
    evaluations: int,
    seed: int,
    spread: Array | None = None,
) -> cma.CMAEvolutionStrategy:
    options: dict[str, Any] = {
        'seed': seed + 1,
        'verbose': -9,
        'tolfun': tolerance,
        'tolflatfitness': 10,
    }
    options['maxfevals'] = evaluations * len(start)
    if spread is not None:
        options['CMA_stds'] = spread
    return cma.CMAEvolutionStrategy(start, step, options)


def _advance(run: cma.CMAEvolutionStrategy, cost: Cost, generations: int | None = None) -> None:
    count = 0
    while not run.stop() and (generations is None or count < generations):
        batch = run.ask()
        run.tell(batch, cost(np.array(batch)).tolist())
        count += 1
