"""How far a turn has come: predicted by the model, corrected by measured heading."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

JUMP = 0.7  # [rad] a measurement this far from the prediction is a restart, not a motion


@dataclass(frozen=True, slots=True)
class HeadingTracker:
    """Progress of a turn, summed from small changes, so it has no branch cut.

    Measured headings replace the prediction since the measurement before. A gap is bridged by the
    prediction and made good when measurements return. A jump (simulator reset, tracker restart)
    is left out.

    Attributes:
        progress: heading change since the turn began [rad].
        last: last measured heading [rad]; None before the first.
        unconfirmed: part of the progress predicted since then [rad].
        jumps: measurements left out so far.
    """

    progress: float = 0.0
    last: float | None = None
    unconfirmed: float = 0.0
    jumps: int = 0

    def restarted(self) -> HeadingTracker:
        """Begin a new turn at the present heading."""
        return replace(self, progress=0.0)

    def advanced(self, predicted: float, measured: float | None) -> HeadingTracker:
        """Add one step.

        Args:
            predicted: heading change the model expects of this step [rad].
            measured: heading now, any branch [rad]; None without a fresh measurement.
        """
        progress = self.progress + predicted
        unconfirmed = self.unconfirmed + predicted
        if measured is None:
            return HeadingTracker(progress, self.last, unconfirmed, self.jumps)
        if self.last is None:
            return replace(self, progress=progress, last=measured, unconfirmed=0.0)
        error = math.remainder(measured - self.last - unconfirmed, math.tau)
        if abs(error) > JUMP:
            return HeadingTracker(progress, measured, 0.0, self.jumps + 1)
        return HeadingTracker(progress + error, measured, 0.0, self.jumps)
