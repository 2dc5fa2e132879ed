"""The paper's way to a gait: one function at a time, each on its own height function (Sec. III.C).

With two of f_1, f_2, f_3 held the gait is a path in a plane of shapes, and its turn is a surface
integral there. The three are improved in turn 'until a local maximum in turning angle per gait
cycle is reached'. The surface integral rests on the linear connection, which is only near what
friction does; so it proposes, and the nonlinear force balance decides: a gait is replaced only by
one whose integrated angle is larger.
"""

from __future__ import annotations

import numpy as np

from omega_turn_ros.design.plane_search import propose
from omega_turn_ros.design.problem import Design, DesignProblem
from omega_turn_ros.design.sub_shape import PLANES, SubShape
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait

DRAWS = 60  # random gaits of which each start takes the best
PROPOSALS = 5  # of a plane, integrated
ROUNDS = 30  # at most, each through all three planes
# Spread of the candidates at first, and the gain of a round below which it is halved.
FAR, FAR_GAIN = 1.0, 0.005
NEAR, NEAR_GAIN = 0.3, 0.0005  # for the best start, once more
CLOSER, LAST_SPREAD = 0.5, 0.01


def design_hierarchical(problem: DesignProblem, seed: int = 0, starts: int = 8) -> Design:
    """Design a gait by alternating over the three planes, from several random starts.

    Args:
        problem: body, ground, wave numbers and limits.
        seed: of starts and candidates; equal seeds give equal gaits.
        starts: how many.

    Returns:
        The best gait, turning counter-clockwise, within all limits on a fine grid.

    Raises:
        BadInputError: no start asked for, or no gait found that turns.
    """
    if starts < 1:
        raise BadInputError('starts', starts, 'at least 1')
    climbs = [_Climb(problem, np.random.default_rng((seed, k))) for k in range(starts)]
    best = max(climbs, key=lambda climb: climb.angle)
    tops = tuple(sorted((climb.angle for climb in climbs), reverse=True))
    best.climb(NEAR, NEAR_GAIN)
    if not best.angle > 0.0:
        raise BadInputError('problem', problem, 'a body that can turn within its limits')
    gait = problem.fitted(best.gait)
    path = problem.path(gait)
    return Design(
        gait=gait,
        angle=problem.turn(path),
        clearance=problem.clearance(path),
        method='hierarchical',
        evaluations=sum(climb.evaluations for climb in climbs),
        starts=starts,
        tops=tops,
        reason=best.reason,
    )


class _Climb:
    """The way up from one start; afterwards `gait`, its `angle` [rad] and the `reason` to stop."""

    def __init__(self, problem: DesignProblem, rng: np.random.Generator) -> None:
        self.problem = problem
        self.rng = rng
        self.gait = _random_gait(problem, rng)
        self.angle = 0.0
        self.evaluations = 0
        for _ in range(DRAWS):
            self._take_if_better(_random_gait(problem, rng))
        self.climb(FAR, FAR_GAIN)

    def climb(self, spread: float, gain: float) -> None:
        """Improve plane after plane, looking closer where a round gains too little."""
        for _ in range(ROUNDS):
            before = self.angle
            for plane in PLANES:
                sub = SubShape(self.problem, self.gait, plane)
                for gait in propose(sub, spread, self.rng, PROPOSALS):
                    self._take_if_better(gait)
            if self.angle < (1.0 + gain) * before:
                spread *= CLOSER
            if spread < LAST_SPREAD:
                self.reason = f'no plane gains {gain:.2%} more'
                return
        self.reason = f'{ROUNDS} rounds'

    def _take_if_better(self, gait: TwoWaveGait) -> None:
        """Bring a gait to its limits, or its mirror image, and keep it if it turns further."""
        path = self.problem.path(gait, self.problem.samples)
        factor = self.problem.feasible_factor(path)
        angle = self.problem.turn(factor * path)
        self.evaluations += 1
        if abs(angle) > self.angle:
            self.gait, self.angle = gait.scaled(factor if angle > 0.0 else -factor), abs(angle)


def _random_gait(problem: DesignProblem, rng: np.random.Generator) -> TwoWaveGait:
    """Any mixture of the two waves, at any scale."""
    share, gamma = rng.uniform(0.2, 0.8), rng.uniform(-1.0, 1.0)
    phi_f, phi_o, psi = rng.uniform(-np.pi, np.pi, 3).tolist()
    return TwoWaveGait(problem.k_f, problem.k_t, share, gamma, phi_f, 1.0 - share, phi_o, psi)
