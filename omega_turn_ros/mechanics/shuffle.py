"""What it costs in heading to shuffle into another posture; without numba, for the nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from omega_turn_ros.mechanics.feet import Feet
from omega_turn_ros.mechanics.force_balance import solve_balance
from omega_turn_ros.mechanics.trajectory import straight_path

STEPS = 12


def shuffle_heading(feet: Feet, start: ArrayLike, end: ArrayLike) -> float:
    """Heading change of the mean body axis from one posture joint-linearly to another [rad].

    Args:
        feet: of the robot.
        start: all joint angles [rad], shape (5 n - 1,).
        end: the same where it ends. Where no foot is down on the way nothing turns.
    """
    path = straight_path(start, end, STEPS)
    middles, steps = 0.5 * (path[1:] + path[:-1]), np.diff(path, axis=0)
    stands = feet.down(middles).any(axis=-1)
    middles, steps = middles[stands], steps[stands]
    points, velocities = feet.moving(middles, steps)
    heading = 0.0
    for p, v, load in zip(points, velocities, feet.loads(middles)):
        carries = load > 0.0
        heading += solve_balance(p[None, carries], v[None, carries], load[carries])[0, 2]
    return float(heading)
