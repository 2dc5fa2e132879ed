"""What a gait turns: heading over amplitude scale and phase, as tables that interpolate."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]

SMALLEST_ANGLE = 1e-3  # [rad] a gait that turns less per cycle does not turn: tables carry 1e-6


@dataclass(frozen=True, slots=True)
class Calibration:
    """Predicted heading of the mean body axis for one gait on one robot.

    A cycle starts at `start_phase`, where the body is straightest. From the rest shape (straight)
    to the start shape and back is the same line in shape space, so bending costs what unbending
    returns.

    Attributes:
        start_phase: gait phase at which cycles begin and end [rad].
        scales: amplitude scales 0..1, shape (S,).
        heading: heading since the start of the cycle [rad], shape (S, M + 1), at phases
            start_phase + 2 pi m / M; the last column is the angle per cycle.
        bend_heading: heading change from rest to the start shape [rad], shape (S,).
        peak_rate: largest |d theta_i / d phase| over the cycle at scale 1 [rad/rad].
        n_joints: N of the robot it was computed for.
    """

    start_phase: float
    scales: Array
    heading: Array
    bend_heading: Array
    peak_rate: float
    n_joints: int

    def __post_init__(self) -> None:
        """Refuse tables that do not fit together."""
        for field in ('start_phase', 'peak_rate', 'scales', 'heading', 'bend_heading'):
            if not np.isfinite(getattr(self, field)).all():
                raise BadInputError(f'calibration {field}', 'NaN or Inf', 'finite numbers')
        if self.peak_rate <= 0.0:
            raise BadInputError('calibration peak_rate', self.peak_rate, 'a rate > 0 [rad/rad]')
        if self.n_joints < 2:
            raise BadInputError('calibration n_joints', self.n_joints, 'at least 2')
        count = self.scales.size
        rising = self.scales.ndim == 1 and count >= 2 and (np.diff(self.scales) > 0.0).all()
        if not rising or self.scales[0] != 0.0 or self.scales[-1] != 1.0:
            raise BadInputError('calibration scales', self.scales.tolist(), 'rising from 0 to 1')
        if self.heading.ndim != 2 or self.heading.shape[0] != count or self.heading.shape[1] < 2:
            raise BadInputError('calibration heading', self.heading.shape, f'({count}, phases)')
        if self.bend_heading.shape != (count,):
            raise BadInputError('calibration bend_heading', self.bend_heading.shape, f'({count},)')
        if self.largest_angle < SMALLEST_ANGLE:
            expected = f'an angle per cycle of at least {SMALLEST_ANGLE} rad'
            raise BadInputError('calibration heading', self.largest_angle, expected)

    @property
    def angles(self) -> Array:
        """Angle per cycle for each scale, made monotone [rad], shape (S,)."""
        monotone: Array = np.maximum.accumulate(self.heading[:, -1])
        return monotone

    @property
    def largest_angle(self) -> float:
        """Angle of one cycle at full amplitude [rad]."""
        return float(self.angles[-1])

    def angle_of(self, scale: float) -> float:
        """Angle per cycle at a signed scale in -1..1 [rad]; odd in the scale (mirrored turn)."""
        return float(np.sign(scale) * np.interp(abs(scale), self.scales, self.angles))

    def scale_of(self, angle: float) -> float:
        """Signed scale whose cycle turns by `angle` [rad], at most the largest angle."""
        size = abs(angle)
        k = int(np.clip(np.searchsorted(self.angles, size, side='left'), 1, self.scales.size - 1))
        low, high = self.angles[k - 1], self.angles[k]
        fraction = (size - low) / (high - low) if high > low else 1.0
        scale = self.scales[k - 1] + fraction * (self.scales[k] - self.scales[k - 1])
        return float(np.copysign(np.clip(scale, 0.0, self.scales[-1]), angle))

    def heading_at(self, scale: float, turned: float) -> float:
        """Heading since the start of a cycle [rad] after `turned` of phase, 0..2 pi [rad]."""
        row, weight = self._bracket(abs(scale))
        columns = self.heading.shape[1] - 1
        place = min(max(turned / math.tau, 0.0), 1.0) * columns
        j = min(int(place), columns - 1)
        # Single items as floats: arrays of two would cost a control tick more than all this.
        item = self.heading.item
        low = item(row, j) + (place - j) * (item(row, j + 1) - item(row, j))
        high = item(row + 1, j) + (place - j) * (item(row + 1, j + 1) - item(row + 1, j))
        size: float = low + weight * (high - low)
        return math.copysign(1.0, scale) * size if scale else 0.0

    def bend_heading_of(self, scale: float) -> float:
        """Heading change from rest to the start shape at a signed scale [rad]."""
        return float(np.sign(scale) * np.interp(abs(scale), self.scales, self.bend_heading))

    def _bracket(self, scale: float) -> tuple[int, float]:
        row = min(max(bisect_left(self.scales, scale) - 1, 0), self.scales.size - 2)
        low, high = self.scales.item(row), self.scales.item(row + 1)
        return row, min(max((scale - low) / (high - low), 0.0), 1.0)

    def to_mapping(self) -> dict[str, Any]:
        """Plain lists for a YAML file, angles rounded to 1e-6 rad."""
        return {
            'n_joints': self.n_joints,
            'start_phase': round(self.start_phase, 9),
            'peak_rate': round(self.peak_rate, 6),
            'scales': [round(float(s), 6) for s in self.scales],
            'bend_heading': [round(float(h), 6) for h in self.bend_heading],
            'heading': [[round(float(h), 6) for h in row] for row in self.heading],
        }


def calibration_from_mapping(data: dict[str, Any]) -> Calibration:
    """Build a calibration from a gait file's `calibration` block.

    Raises:
        BadInputError: a field is missing, has the wrong type, or the tables do not fit.
    """
    try:
        return Calibration(
            float(data['start_phase']),
            np.array(data['scales'], float),
            np.array(data['heading'], float),
            np.array(data['bend_heading'], float),
            float(data['peak_rate']),
            int(data['n_joints']),
        )
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, BadInputError):
            raise
        raise BadInputError(
            'calibration', type(error).__name__, f'complete tables ({error})'
        ) from error
