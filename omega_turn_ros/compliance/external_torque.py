"""External torque: what joint efforts hold beyond what the gait needs on open ground.

Signs. An effort is the torque an actuator exerts on the body behind its joint, positive towards
positive angles. In quasi-static motion it balances ground and obstacles:

    effort + tau_ground + tau_ext = 0,    needed = -tau_ground,    tau_ext = needed - effort

so a push from outside towards positive angles is a positive external torque, although the actuator
answers it with a negative effort.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import joint_torques

Array = NDArray[np.float64]

STILL = 1e-3  # [rad/s] slower than this, friction may point anywhere: nothing is predicted


@dataclass(frozen=True, slots=True)
class TorqueConfig:
    """How efforts become external torques.

    Attributes:
        effort_sign: +1 where a positive effort drives its joint towards positive angles.
        friction: friction coefficient of the open ground the prediction assumes; 0 predicts
            nothing, so the whole effort counts as external.
        filter_time: time constant of the low-pass filter [s].
        dead_band: external torques up to this count as 0, larger ones by their excess [N m].
    """

    effort_sign: int = 1
    friction: float = 0.5
    filter_time: float = 0.1
    dead_band: float = 1.0

    def __post_init__(self) -> None:
        """Refuse settings without meaning."""
        if self.effort_sign not in (1, -1):
            raise BadInputError('effort_sign', self.effort_sign, '1 or -1')
        for field in ('friction', 'filter_time', 'dead_band'):
            value = getattr(self, field)
            if not math.isfinite(value) or value < 0.0:
                raise BadInputError(field, value, 'a finite number >= 0')


def needed_torques(chain: PlanarChain, angles: Array, rates: Array, friction: float) -> Array:
    """Actuator torques the motion needs on open ground [N m], shape (N,); see `joint_torques`."""
    if friction == 0.0 or np.abs(rates).max() < STILL:
        return np.zeros_like(angles)
    return joint_torques(chain, angles, rates, friction)


def external_torque_step(
    filtered: Array, efforts: Array, needed: Array, dt: float, config: TorqueConfig
) -> tuple[Array, Array]:
    """Advance the filter and return (filtered, external) torques.

    Args:
        filtered: state of the low-pass filter [N m], shape (N,).
        efforts: measured joint efforts [N m], shape (N,).
        needed: torques the gait needs on open ground [N m], shape (N,).
        dt: [s], >= 0.
        config: settings.

    Returns:
        The new filter state and the dead-banded external torque [N m], each shape (N,).
    """
    raw = needed - config.effort_sign * efforts
    weight = 1.0 if config.filter_time == 0.0 else -math.expm1(-dt / config.filter_time)
    filtered = filtered + weight * (raw - filtered)
    excess = np.maximum(np.abs(filtered) - config.dead_band, 0.0)
    return filtered, np.copysign(excess, filtered)
