"""Driving: a velocity becomes the pace of the gait and the turn of each cycle (own derivation)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import LibraryGait


@dataclass(frozen=True, slots=True)
class Drive:
    """A wanted velocity of the mean body frame.

    Attributes:
        linear: forward [m/s], >= 0.
        angular: turning rate [rad/s], + = counter-clockwise.
    """

    linear: float = 0.0
    angular: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what no gait can do."""
        if not (math.isfinite(self.linear) and self.linear >= 0.0):
            raise BadInputError('cmd_vel linear.x', self.linear, 'a finite speed >= 0 [m/s]')
        if not math.isfinite(self.angular):
            raise BadInputError('cmd_vel angular.z', self.angular, 'a finite rate [rad/s]')


@dataclass(frozen=True, slots=True)
class Pace:
    """How to play a gait.

    Attributes:
        share: of the full phase rate, 0..1.
        scale: of the cycles, -1..1.
    """

    share: float
    scale: float


def pace_of(drive: Drive, gait: LibraryGait, period: float) -> Pace:
    """Pace that comes nearest to a velocity.

    A gait that walks turns only while it walks: where no speed is asked for, or too little for the
    turning rate, it walks just fast enough. A gait that only turns keeps its full rate and lets
    the scale choose the angle of each cycle; it knows no speed.

    Args:
        drive: the velocity. What is too fast is cut.
        gait: with its calibration and, if it walks, its advance.
        period: of a cycle at the full rate [s].
    """
    if drive == Drive():
        return Pace(0.0, 0.0)
    table = gait.calibration
    turning = min(abs(drive.angular) * period / table.largest_angle, 1.0)
    if gait.advance > 0.0:
        share = max(min(drive.linear * period / gait.advance, 1.0), turning)
    else:
        share = 1.0 if drive.angular != 0.0 else 0.0
    if share == 0.0:  # a speed, of a gait that knows none
        return Pace(0.0, 0.0)
    angle = min(abs(drive.angular) * period / share, table.largest_angle)
    return Pace(share, table.scale_of(math.copysign(angle, drive.angular)))
