"""Orientation of the mean body frame, also of a body that does not lie level."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def projected_heading(turns: Array, weights: Array) -> float:
    """Mean direction of the bodies as seen from above (own derivation).

    Directions are counted on from body to body, so the mean has no branch cut within the robot,
    and says the same whichever side is up. The more a body stands on end, the less it counts. On
    level ground this is the mean body axis.

    Args:
        turns: orientations of the bodies in the world, head to tail, quaternions x, y, z, w,
            shape (B, 4).
        weights: of the bodies, shape (B,).

    Returns:
        Heading [rad], on any branch.
    """
    x, y, z, w = turns.T
    axes = 1.0 - 2.0 * (y * y + z * z) + 2j * (x * y + w * z)
    seen = np.abs(axes)
    directions = np.angle(axes)
    before = directions[seen.argmax()]
    for i, share in enumerate(seen):
        step = math.remainder(directions[i] - before, math.tau)
        directions[i] = before + step
        before += share * step  # what a body on end says of its own direction is chance
    return float(np.average(directions, weights=weights * seen))


def mean_roll(turns: Array, weights: Array) -> float:
    """Roll that agrees best with the rolls of all bodies about their own axes (own derivation).

    Args:
        turns: as for `projected_heading`.
        weights: of the bodies, shape (B,).

    Returns:
        Roll [rad], -pi..pi; 0 lying as it was put, +-pi upside down.
    """
    x, y, z, w = turns.T
    left, up = 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
    return math.atan2(float(weights @ left), float(weights @ up))


def orientation_of(heading: float, roll: float) -> tuple[float, float, float, float]:
    """Quaternion x, y, z, w of a heading and a roll about it [rad]."""
    c, s = math.cos(0.5 * heading), math.sin(0.5 * heading)
    cr, sr = math.cos(0.5 * roll), math.sin(0.5 * roll)
    return c * sr, s * sr, s * cr, c * cr
