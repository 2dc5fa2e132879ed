"""Many short climbs, then CMA-ES from the best few of the tops they found.

The turn per cycle has several basins of much the same size, so breadth comes first: quasi-Newton
climbs, from starts that differ, reach the basin of each start in about a hundred costs. They
stall where a limit becomes active, which CMA-ES does not mind.
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
Likeness = Callable[[Array], Array]  # of parameter vectors (P, D): unit vectors, shape (P, F)

DIFFERENCE = 1e-3  # of parameters, for gradients
CLIMB, LINE_SEARCH = 10, 5  # gradients of a climb, and of each of its line searches, at most
ALIKE_STARTS, ALIKE_TOPS = 0.7, 0.95  # cosine from which two gaits count as one
FOLLOWED = 3  # tops that differ, from which CMA-ES goes on
STEP = 0.1  # of CMA-ES at first, in every direction
TOLERANCE, FINE_TOLERANCE = 1e-3, 3e-5  # spread of costs in a generation that has converged
EVALUATIONS, FINE_EVALUATIONS = 45, 100  # at most, per parameter
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


def search(
    coarse: Cost, fine: Cost, likeness: Likeness, candidates: Array, starts: int, seed: int
) -> SearchResult:
    """Minimise from the best candidates that differ, then on a finer cost from the winner.

    Args:
        coarse: cost of parameter vectors, quick.
        fine: the cost that counts.
        likeness: parameter vectors are as alike as these unit vectors are parallel, either way.
        candidates: parameter vectors to choose the starts from, shape (C, D), C >= starts.
        starts: how many to climb from.
        seed: of CMA-ES; equal seeds give equal results.
    """
    order = np.argsort(coarse(candidates), kind='stable')
    chosen = _different(likeness(candidates[order]), starts, ALIKE_STARTS)
    climbs = [_climb(coarse, candidates[order[i]]) for i in chosen]
    climbs.sort(key=lambda climb: climb[1])
    tops = np.array([end for end, _, _ in climbs])
    runs: list[cma.CMAEvolutionStrategy] = []
    for i in _different(likeness(tops), FOLLOWED, ALIKE_TOPS):
        runs.append(_strategy(tops[i], STEP, TOLERANCE, EVALUATIONS, seed * 1000 + len(runs)))
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

    # Without the bounds on line searches, those over a kink take most of the costs.
    options = {'maxfun': CLIMB, 'maxls': LINE_SEARCH}
    end = minimize(value_and_gradient, start, jac=True, method='L-BFGS-B', options=options)
    return end.x, float(end.fun), count


def _different(directions: Array, count: int, alike: float) -> list[int]:
    """First vectors, at most `count`, of which no two are alike."""
    kept: list[int] = []
    for i, direction in enumerate(directions):
        if all(abs(direction @ directions[k]) < alike for k in kept):
            kept.append(i)
        if len(kept) == count:
            break
    return kept


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
