"""The paper's way to a gait: one function at a time, each on its own height function (Sec. III.C).

With two of f_1, f_2, f_3 held the gait is a path in a plane of shapes, and the turn it makes is a
surface integral there. The three are improved in turn 'until a local maximum in turning angle per
gait cycle is reached'. The surface integral rests on the linear connection, which Coulomb friction
keeps only roughly; so it proposes, and the nonlinear force balance decides: a step is taken only if
the integrated angle grows.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from omega_turn_ros.design.plane_search import propose
from omega_turn_ros.design.problem import Design, DesignProblem
from omega_turn_ros.design.sub_shape import PLANES, SubShape
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave import TwoWaveGait

DRAWS = 40  # random gaits of which each start takes the best
PROPOSALS = 5  # of a plane, tried with the nonlinear force balance
ROUNDS = 30  # at most, each through all three planes
FIRST_SPREAD, LAST_SPREAD = 1.0, 0.01
AGREEMENT = 0.01
GAIN = 0.01
SHRINK = 0.5


def design_hierarchical(problem: DesignProblem, seed: int = 0, starts: int = 8) -> Design:
    """Design a gait by alternating over the three planes, from several random starts.

    Args:
        problem: body, ground, wave numbers and limits.
        seed: of the starts and candidates; the same seed gives the same gait.
        starts: how many.

    Returns:
        The best gait, turning counter-clockwise and within all limits on a fine grid.

    Raises:
        BadInputError: no start asked for, or nothing that keeps the limits turns.
    """
    if starts < 1:
        raise BadInputError('starts', starts, 'at least 1')
    climbs = [_Climb(problem, np.random.default_rng((seed, k))) for k in range(starts)]
    for climb in climbs:
        climb.run()
    best = max(climbs, key=lambda climb: climb.angle)
    gait = problem.fitted(best.gait)
    return Design(
        gait=gait,
        angle=problem.turn(problem.path(gait)),
        clearance=problem.clearance(problem.path(gait)),
        method='hierarchical',
        evaluations=sum(climb.evaluations for climb in climbs),
        starts=starts,
        agreeing=sum(climb.angle >= (1.0 - AGREEMENT) * best.angle for climb in climbs),
        reason=best.reason,
    )


@dataclass
class _Climb:
    """One start and its way up."""

    problem: DesignProblem
    rng: np.random.Generator
    gait: TwoWaveGait = field(init=False)
    angle: float = 0.0
    evaluations: int = 0
    reason: str = ''

    def run(self) -> None:
        for _ in range(DRAWS):
            self.consider(_random_gait(self.problem, self.rng))
        spread = FIRST_SPREAD
        for rounds in range(ROUNDS):
            before = self.angle
            for plane in PLANES:
                sub = SubShape(self.problem, self.gait, plane)
                for candidate in propose(sub, spread, self.rng, PROPOSALS):
                    self.consider(candidate)
            if self.angle < (1.0 + GAIN) * before:
                spread *= SHRINK
            if spread < LAST_SPREAD:
                self.reason = f'converged'
                return
        self.reason = f'stopped after {ROUNDS} rounds'

    def consider(self, candidate: TwoWaveGait) -> None:
        fitted = _fit(self.problem, candidate)
        if fitted is None:
            return
        angle = self.problem.turn(self.problem.path(fitted, self.problem.samples))
        self.evaluations += 1
        if abs(angle) > self.angle and (angle > 0 or not self.angle):
            self.gait, self.angle = (fitted if angle > 0.0 else fitted.mirrored()), abs(angle)


def _random_gait(problem, rng):
    gamma, phi_f, phi_o, psi = rng.uniform(-1, 1), *rng.uniform(-np.pi, np.pi, 3)
    share = rng.uniform(0.2, 0.8)
    return TwoWaveGait(problem.k_f, problem.k_t, share, gamma, phi_f, 1 - share, phi_o, psi)


def _fit(problem, gait):
    path = problem.path(gait, problem.samples)[:-1]
    largest = np.abs(path).max()
    scale = problem.theta_max / largest
    path *= scale
    if problem.clearance(path) < 0:
        lo, hi = 0.85, 1.0
        if problem.clearance(path * lo) < 0:
            return None
        for _ in range(6):
            mid = 0.5 * (lo + hi)
            if problem.clearance(path * mid) >= 0:
                lo = mid
            else:
                hi = mid
        scale *= lo
    return replace(gait, a_f=float(gait.a_f * scale), a_o=float(gait.a_o * scale))
