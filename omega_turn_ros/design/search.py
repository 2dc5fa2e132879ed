"""Many short runs of CMA-ES, of which fewer and fewer go on (successive halving).

The turn per cycle has several basins of much the same size, and kinks where a limit becomes
active, over which gradients stumble. So breadth comes first: CMA-ES from starts that differ, until
it is seen which basins are worth more costs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import cma
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Cost = Callable[[Array], Array]  # of parameter vectors, shape (P, D): shape (P,)
Likeness = Callable[[Array], Array]  # of parameter vectors (P, D): unit vectors, shape (P, F)

ALIKE_STARTS, ALIKE_TOPS = 0.7, 0.95  # cosine from which two gaits count as one
ROUNDS = ((10, 16), (15, 8), (40, 3), (40, 1))  # costs per parameter of each run; how many go on
STEP = 0.15  # of a run at first, in every direction
TOLERANCE, FINE_TOLERANCE = 1e-3, 3e-5  # spread of costs in a generation that has converged
FINE_EVALUATIONS = 250  # at most, per parameter


@dataclass(frozen=True, slots=True)
class SearchResult:
    """What a search found.

    Attributes:
        best: parameters, shape (D,).
        cost: of them.
        starts: how many runs began: fewer than asked where the candidates are too much alike.
        evaluations: of either cost, all runs.
        tops: minus the cost that the runs of the last round reached, best first.
        reason: why the last search stopped.
    """

    best: Array
    cost: float
    starts: int
    evaluations: int
    tops: tuple[float, ...]
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
        starts: how many runs to begin with, at most.
        seed: of CMA-ES; equal seeds give equal results, whatever else draws random numbers.
    """
    order = np.argsort(coarse(candidates), kind='stable')
    chosen = _different(likeness(candidates[order]), starts, ALIKE_STARTS)
    runs = [
        _strategy(candidates[order[i]], STEP, TOLERANCE, (seed, k)) for k, i in enumerate(chosen)
    ]
    evaluations = len(candidates)
    for costs, kept in ROUNDS:
        evaluations += sum(_advance(run, coarse, costs * candidates.shape[1]) for run in runs)
        runs.sort(key=lambda run: float(run.result.fbest))
        tops = tuple(-float(run.result.fbest) for run in runs)
        ends = np.array([run.result.xbest for run in runs])
        runs = [runs[i] for i in _different(likeness(ends), kept, ALIKE_TOPS)]
    winner = runs[0].result
    # The winner's spread tells how far the finer search has to look in each direction.
    spread = np.maximum(3.0 * winner.stds, 3e-3)
    finest = _strategy(winner.xbest, 1.0, FINE_TOLERANCE, (seed, len(chosen)), spread)
    evaluations += _advance(finest, fine, FINE_EVALUATIONS * candidates.shape[1])
    found = finest.result
    reason = ', '.join(finest.stop()) or f'{found.evaluations} costs'
    best, cost = np.array(found.xbest), float(found.fbest)
    return SearchResult(best, cost, len(chosen), evaluations, tops, reason)


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
    start: Array, step: float, tolerance: float, seed: Sequence[int], spread: Array | None = None
) -> cma.CMAEvolutionStrategy:
    rng = np.random.default_rng(seed)
    options: dict[str, Any] = {
        # Numbers of its own: left alone, all runs draw from numpy's global state.
        'randn': lambda *size: rng.standard_normal(size),
        'seed': np.nan,
        'verbose': -9,
        'tolfun': tolerance,
        'tolflatfitness': 10,
    }
    if spread is not None:
        options['CMA_stds'] = spread
    return cma.CMAEvolutionStrategy(start, step, options)


def _advance(run: cma.CMAEvolutionStrategy, cost: Cost, costs: int) -> int:
    """Go on until the run has converged or has had so many more costs; return how many."""
    before = int(run.countevals)
    while not run.stop() and run.countevals - before < costs:
        batch = run.ask()
        run.tell(batch, cost(np.array(batch)).tolist())
    return int(run.countevals) - before
