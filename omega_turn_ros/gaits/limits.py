"""The last word on every joint command: position, velocity and step limits."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class JointLimits:
    """Limits of every joint.

    Attributes:
        position: |q| stays within this [rad].
        velocity: |change of q| per second stays within this [rad/s].
        step: |change of q| from one command to the next stays within this [rad].
    """

    position: float
    velocity: float
    step: float

    def __post_init__(self) -> None:
        """Refuse limits that would stop or free the robot."""
        for field in ('position', 'velocity', 'step'):
            value = getattr(self, field)
            if not math.isfinite(value) or value <= 0.0:
                raise BadInputError(f'limit {field}', value, 'a finite number > 0')


def limit_command(
    previous: Array, target: Array, dt: float, limits: JointLimits
) -> tuple[Array, bool]:
    """Move from the previous command towards the target as far as the limits allow.

    The step is measured against the previous command, not the measured position: a tracking
    error must not slow the motion.

    Args:
        previous: last command [rad], shape (n_joints,), inside the position limit.
        target: wanted command [rad], shape (n_joints,); a joint at NaN stays where it is.
        dt: time since the last command [s], >= 0.
        limits: what to keep.

    Returns:
        The command [rad], shape (n_joints,), and whether any limit changed it.
    """
    reach = min(limits.velocity * dt, limits.step)
    # Within reach is the rule, and cheap to see; NaN compares false.
    if np.abs(target - previous).max() <= reach and np.abs(target).max() <= limits.position:
        return target, False
    known = np.where(np.isnan(target), previous, target)
    command = np.clip(known, previous - reach, previous + reach)
    np.clip(command, -limits.position, limits.position, out=command)
    return command, not bool((np.abs(command - target) <= 1e-12).all())
