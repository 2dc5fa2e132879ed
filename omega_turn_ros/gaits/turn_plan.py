"""Turn planning: any angle becomes a number of whole cycles and one amplitude scale."""

from __future__ import annotations

import math
from dataclasses import dataclass

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.calibration import Calibration


@dataclass(frozen=True, slots=True)
class TurnPlan:
    """Whole cycles of equal amplitude.

    Attributes:
        cycles: how many, >= 0.
        scale: signed amplitude scale in -1..1; negative is the mirrored turn.
        angle: predicted angle of all cycles, rest to rest [rad].
    """

    cycles: int
    scale: float
    angle: float


def plan_turn(angle: float, calibration: Calibration, ground_ratio: float = 1.0) -> TurnPlan:
    """Choose cycles and amplitude for a turn from rest to rest.

    Bending into the first cycle and out of the last follow one line in shape space, so their
    headings cancel; what a turn from another posture costs on top is the caller's to subtract.

    Args:
        angle: turn [rad], + = counter-clockwise, any size.
        calibration: of the gait.
        ground_ratio: how much this ground turns the robot for each predicted radian, > 0.

    Raises:
        BadInputError: the angle is not finite, or the ratio is not positive.
    """
    if not math.isfinite(angle):
        raise BadInputError('angle', angle, 'a finite angle [rad]')
    if not math.isfinite(ground_ratio) or ground_ratio <= 0.0:
        raise BadInputError('ground_ratio', ground_ratio, 'a finite number > 0')
    if angle == 0.0:
        return TurnPlan(0, 0.0, 0.0)
    model_angle = angle / ground_ratio
    if not math.isfinite(model_angle / calibration.largest_angle):
        raise BadInputError('angle', angle, 'an angle of countable cycles [rad]')
    # The slack keeps a turn of exactly n largest cycles at n.
    cycles = max(1, math.ceil(abs(model_angle) / calibration.largest_angle - 1e-9))
    scale = calibration.scale_of(model_angle / cycles)
    return TurnPlan(cycles, scale, ground_ratio * cycles * calibration.angle_of(scale))
