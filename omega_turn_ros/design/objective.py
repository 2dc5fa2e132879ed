"""From parameters to a cost, and from the best parameters to a gait: shared by all searches."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.design.problem import Design, DesignProblem
from omega_turn_ros.design.search import SearchResult
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.wave_gait import WaveGait

Array = NDArray[np.float64]


def cost_of(
    problem: DesignProblem,
    family: Callable[[Array], WaveGait],
    value: Callable[[DesignProblem, Array], float],
    stride: int = 1,
) -> Callable[[Array], float]:
    """Cost of a parameter vector: minus the value of its gait, scaled to just keep the limits.

    Args:
        problem: limits are kept on its samples of the cycle.
        family: gait of a parameter vector, at any scale.
        value: of a closed path, the larger the better.
        stride: the value is taken on every so many samples.
    """

    def cost(x: Array) -> float:
        path = family(x).angles(problem.phases, problem.chain.n_joints)
        return -value(problem, problem.feasible_factor(path) * path[::stride])

    return cost


def turning_speed(angle: float, path: Array) -> float:
    """Heading per peak joint travel of a closed path at a uniform clock [rad/rad].

    Times the largest joint speed [rad/s] it is the mean turning speed [rad/s]: at uniform phase
    rate a cycle takes 2 pi (peak rate) / (largest speed) (own derivation).

    Args:
        angle: per cycle [rad].
        path: both ends of the cycle included [rad], shape (T + 1, N).
    """
    samples = path.shape[0] - 1
    return abs(angle) / (samples * float(np.abs(np.diff(path, axis=0)).max()))


def finish(
    problem: DesignProblem, gait: WaveGait, found: SearchResult, starts: int, method: str
) -> Design:
    """Enforce the limits on a fine grid, turn counter-clockwise, and account for the search.

    Raises:
        BadInputError: the gait does not turn.
    """
    gait = problem.fitted(gait)
    path = problem.path(gait)
    angle = problem.turn(path)
    if abs(angle) < 1e-6:
        raise BadInputError('problem', f'{angle:.2g} rad per cycle', 'a family that can turn')
    return Design(
        gait if angle > 0.0 else gait.mirrored(),
        abs(angle),
        problem.clearance(path),
        method,
        found.evaluations,
        starts,
        found.agreeing,
        found.reason,
    )
