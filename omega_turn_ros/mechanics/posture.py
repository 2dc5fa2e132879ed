"""What leaving a posture costs in heading."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.trajectory import heading_along, straight_path


def unbend_heading(chain: PlanarChain, angles: ArrayLike) -> float:
    """Heading change of the mean body axis when a posture is straightened joint-linearly [rad].

    Args:
        chain: the robot.
        angles: yaw joint angles of the posture [rad], shape (N,).
    """
    posture = np.asarray(angles, float)
    return float(heading_along(chain, straight_path(posture, np.zeros_like(posture)))[-1])
