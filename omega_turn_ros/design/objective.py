"""From parameters to a cost, and from the best parameters to a gait: shared by all searches."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.design.problem import Design, DesignProblem
from omega_turn_ros.design.search import Cost, Likeness, SearchResult
from omega_turn_ros.errors import BadInputError, ConvergenceError
from omega_turn_ros.gaits.fourier_gait import fourier_waves
from omega_turn_ros.gaits.two_wave import two_wave_angles
from omega_turn_ros.gaits.wave_gait import WaveGait

Array = NDArray[np.float64]
Coefficients = tuple[Sequence[Array], Sequence[Array], Sequence[Array]]


def cost_of(
    problem: DesignProblem,
    family: Callable[[Array], Coefficients],
    value: Callable[[DesignProblem, Array], Array],
    stride: int = 1,
) -> Cost:
    """Cost of parameter vectors: minus the value of their gaits, scaled to just keep the limits.

    Args:
        problem: limits are kept on its samples of the cycle.
        family: coefficients of F, T and L (see `FourierGait`), each shape (P, 1), of parameter
            vectors, shape (P, D), at any scale.
        value: of closed paths, shape (P, T, N), the larger the better, shape (P,).
        stride: the value is taken on every so many samples.
    """

    def cost(x: Array) -> Array:
        paths = _paths(problem, family, x)
        factors = np.array([problem.feasible_factor(path) for path in paths])
        return -value(problem, factors[:, None, None] * paths[:, ::stride])

    return cost


def likeness_of(problem: DesignProblem, family: Callable[[Array], Coefficients]) -> Likeness:
    """Direction of parameter vectors' gaits in the space of paths; mirrored gaits are opposite."""

    def likeness(x: Array) -> Array:
        flat = _paths(problem, family, x).reshape(len(x), -1)
        directions: Array = flat / np.linalg.norm(flat, axis=1, keepdims=True)
        return directions

    return likeness


def _paths(problem: DesignProblem, family: Callable[[Array], Coefficients], x: Array) -> Array:
    """Closed paths of parameter vectors at any scale [rad], shape (P, T, N), of (P, D)."""
    forward, tau_f, turning, tau_t = fourier_waves(problem.phases, *family(x))
    n = problem.chain.n_joints
    return two_wave_angles(forward, tau_f, turning, tau_t, problem.k_f, problem.k_t, n)


def turns(problem: DesignProblem, paths: Array) -> Array:
    """Angle per cycle of closed paths without its sign [rad], shape (P,), of (P, T, N).

    A path on which the force balance of a shape is not found counts as turning nothing: one
    random shape in a million must not end a search.
    """
    try:
        return _turns(problem, paths)
    except ConvergenceError:
        return np.array([_turn_or_nothing(problem, path) for path in paths])


def _turns(problem: DesignProblem, paths: Array) -> Array:
    result: Array = np.abs(problem.motion.displacements(paths)[..., 2].sum(axis=-1))
    return result


def _turn_or_nothing(problem: DesignProblem, path: Array) -> float:
    try:
        return float(_turns(problem, path))
    except ConvergenceError:
        return 0.0


def turning_speed(angle: ArrayLike, path: Array) -> Array:
    """Heading per peak joint travel of closed paths at a uniform clock [rad/rad].

    Times the largest joint speed [rad/s] it is the mean turning speed [rad/s]: at uniform phase
    rate a cycle takes 2 pi (peak rate) / (largest speed) (own derivation).

    Args:
        angle: per cycle [rad], shape (...).
        path: both ends of the cycle included [rad], shape (..., T + 1, N).
    """
    samples = path.shape[-2] - 1
    fastest = np.abs(np.diff(path, axis=-2)).max(axis=(-2, -1))
    result: Array = np.abs(angle) / (samples * fastest)
    return result


def finish(problem: DesignProblem, gait: WaveGait, found: SearchResult, method: str) -> Design:
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
        found.starts,
        found.tops,
        found.reason,
    )
