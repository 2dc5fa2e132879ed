"""Telling a jam: cycles that turn the robot by next to nothing while its motors strain."""

from __future__ import annotations

from dataclasses import dataclass

STRAIN = 0.8  # of a motor's largest torque, from which it strains
STRAINED = 0.03  # of a cycle's time; on open ground none, in a jam 4 % and more (own trials)
PROGRESS = 0.25  # of the predicted angle, below which a cycle got nowhere


@dataclass(frozen=True, slots=True)
class JamWatch:
    """What tells a jam.

    Attributes:
        strained: time in the present cycle with a motor straining [s].
        jammed: the last cycle that was judged was one in a jam.
        cycles: how many were, since the start.
    """

    strained: float = 0.0
    jammed: bool = False
    cycles: int = 0

    def advanced(self, effort: float, limit: float, dt: float) -> JamWatch:
        """Take in one step of a cycle.

        Args:
            effort: largest |effort| of any joint [N m]; 0 where it is not measured.
            limit: largest torque of a motor [N m].
            dt: [s], >= 0.
        """
        if effort < STRAIN * limit:
            return self
        return JamWatch(self.strained + dt, self.jammed, self.cycles)

    def judged(self, measured: float, predicted: float, duration: float) -> JamWatch:
        """End a cycle.

        Args:
            measured: angle of the cycle [rad].
            predicted: by the calibration [rad], not 0.
            duration: of a cycle [s].
        """
        jammed = self.strained > STRAINED * duration and measured / predicted < PROGRESS
        return JamWatch(0.0, jammed, self.cycles + jammed)
