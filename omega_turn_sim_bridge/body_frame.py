"""Heading of the mean body axis of a body that does not lie level."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def tilted_heading(turns: Array, bends: Array, weights: Array) -> float:
    """Heading whose mean body axis agrees best with the axes of all bodies (own derivation).

    Each body's axis, seen from above and turned back by its yaw bend, is a vote for the heading; a
    body that stands on end votes next to nothing. On level ground all votes are the same.

    Args:
        turns: orientations of the bodies in the world, quaternions x, y, z, w, shape (B, 4).
        bends: of the bodies by yaw joints, from the mean body axis [rad], shape (B,).
        weights: of the bodies, shape (B,).

    Returns:
        Heading [rad], -pi..pi.
    """
    x, y, z, w = turns.T
    axes = 1.0 - 2.0 * (y * y + z * z) + 2j * (x * y + w * z)
    # Upside down the yaw joints turn the other way, seen from above.
    up = np.copysign(1.0, weights @ (1.0 - 2.0 * (x * x + y * y)))
    return float(np.angle((weights * axes) @ np.exp(-1j * up * bends)))
