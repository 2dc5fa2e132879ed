"""Values of gaits in a search."""

from __future__ import annotations

import math

import numpy as np
import pytest

from omega_turn_ros.design.objective import turns
from omega_turn_ros.design.problem import DesignProblem
from omega_turn_ros.errors import ConvergenceError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_laws import GranularResistance

# One contact point per link, deep in dense grains: one random shape in 4000 has no balance that
# Newton's method finds.
PROBLEM = DesignProblem(
    PlanarChain([0.14] * 4, points_per_link=1),
    0.05,
    math.radians(80.0),
    law=GranularResistance.close_packed(),
)


def _random_steps(count: int) -> np.ndarray:
    rng = np.random.default_rng(1)
    middle, step = rng.uniform(-1.5, 1.5, (count, 3)), 0.01 * rng.normal(size=(count, 3))
    return np.stack([middle - 0.5 * step, middle + 0.5 * step], axis=1)


def test_a_path_without_a_force_balance_turns_nothing_and_spoils_no_other() -> None:
    solved, unsolved = [], []
    for path in _random_steps(20_000):
        try:
            solved.append((path, abs(PROBLEM.motion.turn(path))))
        except ConvergenceError:
            unsolved.append(path)
    assert unsolved, 'every shape is solved now: the exception in `turns` may go'
    path, turn = solved[0]
    assert turns(PROBLEM, np.array([path, unsolved[0], path])) == pytest.approx([turn, 0.0, turn])
