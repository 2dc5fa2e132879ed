"""How much a ground really turns the robot, learned cycle by cycle."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

BELIEVED = (0.3, 3.0)  # ratios of measured to predicted angle worth believing
LEARNED_FROM = 0.5  # [rad] predicted; small cycles turn otherwise than large ones
LEAST_SHARE = 0.25  # of what remains that a cycle plans for, however often it overshot
GROWTH = 1.5  # of the share, each time a cycle has not overshot


@dataclass(frozen=True, slots=True)
class GroundResponse:
    """What the next cycle is planned by (own derivation).

    Among obstacles what a cycle turns is part chance. So one cycle moves the ratio halfway only,
    on a logarithmic scale, and after an overshoot the next plans for half the share. Corrections
    then shrink, where at full share they would throw the robot about as far as they bring it.

    Attributes:
        ratio: measured over predicted angle per cycle, in this turn.
        usual: the same, learned from large cycles; where the next turn starts from.
        share: of what remains, that the next cycle plans for.
    """

    ratio: float = 1.0
    usual: float = 1.0
    share: float = 1.0

    @property
    def planned(self) -> float:
        """Ratio to plan the rest of the turn by: the larger, the smaller the next cycle."""
        return self.ratio / self.share

    def restarted(self) -> GroundResponse:
        """Begin a new turn."""
        return GroundResponse(self.usual, self.usual)

    def judged(
        self, measured: float, predicted: float, remaining: float, firm: bool
    ) -> GroundResponse:
        """Learn from a cycle.

        Args:
            measured: its angle [rad].
            predicted: by the calibration [rad], not 0.
            remaining: angle still to turn after it [rad].
            firm: a small cycle that fell short is reason to push harder than usual.
        """
        seen = min(max(measured / predicted, BELIEVED[0]), BELIEVED[1])
        overshot = (remaining + measured) * remaining < 0.0
        share = max(0.5 * self.share, LEAST_SHARE) if overshot else min(GROWTH * self.share, 1.0)
        ratio = math.sqrt(self.ratio * seen)
        learned = replace(self, ratio=ratio, share=share)
        if abs(predicted) >= LEARNED_FROM:
            return replace(learned, usual=0.5 * (self.usual + seen))
        return learned if firm else replace(learned, ratio=max(ratio, self.usual))
