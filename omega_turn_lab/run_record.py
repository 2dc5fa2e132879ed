"""What a run looked like from outside: plain arrays, for pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RunRecord:
    """One run, sampled at T instants; every value is finite.

    Attributes:
        time: simulated or robot time, never decreasing [s], shape (T,).
        pose: mean body frame in the world: x [m], y [m], heading [rad, continuous], shape (T, 3).
        joint_positions: measured, head to tail [rad], shape (T, n_joints); negated while the robot
            lies on its back, so that they look as from above.
        joint_commands: what the gait asked for, head to tail [rad], shape (T, n_joints).
        remaining: angle still to turn [rad], shape (T,).
    """

    time: Array
    pose: Array
    joint_positions: Array
    joint_commands: Array
    remaining: Array

    def __post_init__(self) -> None:
        """Refuse arrays that do not belong together."""
        samples = np.shape(self.time)[:1]
        joints = np.shape(self.joint_positions)[1:2]
        if np.ndim(self.time) != 1 or samples[0] < 2:
            raise BadInputError('time', np.shape(self.time), 'shape (T,), T >= 2')
        expected = {
            'time': samples,
            'pose': (*samples, 3),
            'joint_positions': (*samples, *(joints or ('n_joints',))),
            'joint_commands': (*samples, *(joints or ('n_joints',))),
            'remaining': samples,
        }
        for field, shape in expected.items():
            value = getattr(self, field)
            if np.shape(value) != shape:
                raise BadInputError(field, np.shape(value), f'shape {shape}')
            if not np.isfinite(value).all():
                raise BadInputError(field, value[~np.isfinite(value)][0], 'finite numbers')
        if np.any(np.diff(self.time) < 0.0) or self.time[-1] <= self.time[0]:
            raise BadInputError('time', self.time, 'times that never decrease and do pass [s]')
