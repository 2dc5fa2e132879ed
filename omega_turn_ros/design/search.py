"""Many short climbs, then CMA-ES from the best few of the tops they found.

The turn per cycle has several basins of much the same size, so breadth comes first: quasi-Newton
climbs reach the basin of each start in about a hundred costs. They stall where a limit becomes
active, which CMA-ES does not mind.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cma
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]
Cost = Callable[[Array], Array]  # of parameter vectors, shape (P, D): shape (P,)

DIFFERENCE = 1e-3  # of parameters, for gradients
CLIMB = 10  # quasi-Newton iterations
FOLLOWED = 3  # tops that differ, from which CMA-ES goes on
STEP = 0.1  # of CMA-ES at first, in every direction
TOLERANCE, FINE_TOLERANCE = 1e-3, 1e-5  # spread of costs in a generation that has converged
EVALUATIONS, FINE_EVALUATIONS = 45, 300  # at most, per parameter
SAME = 0.05  # a climb this close to the best, relative, counts as agreeing


@dataclass(frozen=True, slots=True)
class SearchResult:
    """What a search found.

    Attributes:
        best: parameters, shape (D,).
        cost: of them.
        evaluations: of either cost, all starts.
        agreeing: starts whose short climb came within 5 % of the best.
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
        starts: how many to climb from.
        seed: of CMA-ES; equal seeds give equal results.
    """
    chosen = np.argsort(coarse(candidates), kind='stable')[:starts]
    climbs = sorted((_climb(coarse, candidates[i]) for i in chosen), key=lambda climb: climb[1])
    runs = []
    for k, top in enumerate(_different(climbs)):
        runs.append(_strategy(top, STEP, TOLERANCE, EVALUATIONS, seed * 1000 + k))
        _advance(runs[-1], coarse)
    winner = min((run.result for run in runs), key=lambda result: float(result.fbest))
    agreeing = sum(cost <= winner.fbest + SAME * abs(winner.fbest) for _, cost, _ in climbs)
    # The winner's spread tells how far the finer search has to look in each direction.
    spread = np.maximum(3.0 * winner.stds, 3e-3)
    last = _strategy(
        winner.xbest, 1.0, FINE_TOLERANCE, FINE_EVALUATIONS, seed * 1000 + 999, spread
    )
    _advance(last, fine)
    evaluations = len(candidates) + sum(count for _, _, count in climbs)
    evaluations += sum(run.result.evaluations for run in (*runs, last))
    found = last.result
    reason = ', '.join(last.stop())
    return SearchResult(np.array(found.xbest), float(found.fbest), evaluations, agreeing, reason)


def _climb(cost: Cost, start: Array) -> tuple[Array, float, int]:
    """Short quasi-Newton descent; returns the end, its cost and the number of costs."""
    steps = DIFFERENCE * np.eye(start.size)
    count = 0

    def value_and_gradient(x: Array) -> tuple[float, Array]:
        nonlocal count
        values = cost(np.vstack([x, x + steps]))
        count += values.size
        return float(values[0]), (values[1:] - values[0]) / DIFFERENCE

    options = {'maxiter': CLIMB}
    end = minimize(value_and_gradient, start, jac=True, method='BFGS', options=options)
    return end.x, float(end.fun), count


def _different(climbs: list[tuple[Array, float, int]]) -> list[Array]:
    """Ends of the best climbs, one of those that came out alike."""
    tops: list[tuple[Array, float]] = []
    for end, cost, _ in climbs:
        if all(abs(cost - other) > 1e-3 * abs(other) for _, other in tops):
            tops.append((end, cost))
    return [end for end, _ in tops[:FOLLOWED]]


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


def _advance(run: cma.CMAEvolutionStrategy, cost: Cost) -> None:
    while not run.stop():
        batch = run.ask()
        run.tell(batch, cost(np.array(batch)).tolist())
