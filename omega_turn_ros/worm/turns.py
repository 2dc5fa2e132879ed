"""Finding turns: where the body is bent back on itself."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.worm.kymograph import Kymograph

Array = NDArray[np.float64]

BEND = math.pi  # [rad] a bend that turns the body back on itself
SHORTEST = 0.5  # [s] a turn lasts at least
BRIDGED = 0.25  # [s] and may be interrupted by at most


@dataclass(frozen=True, slots=True)
class Turn:
    """Frames in which a body is bent back on itself.

    Attributes:
        start: its first frame, numbered as in the recording.
        stop: the frame after its last.
        peak: the frame of its deepest bend.
        bend: that bend, with the recording's sign [rad].
    """

    start: int
    stop: int
    peak: int
    bend: float


def deepest_bend(angles: ArrayLike) -> Array:
    """Largest angle between the directions of any two points of the body (own definition).

    It is the integral of the curvature between them. Crawling worms reach about 100 degrees; at
    180 degrees and more the body is bent back on itself, as in omega and delta turns. It depends
    neither on the number of body positions nor on which end comes first.

    Args:
        angles: joint angles [rad], shape (..., N).

    Returns:
        The bend with its sign [rad], shape (...).
    """
    joint_angles = np.asarray(angles, float)
    direction = np.zeros((*joint_angles.shape[:-1], joint_angles.shape[-1] + 1))
    np.cumsum(joint_angles, axis=-1, out=direction[..., 1:])
    sign = np.where(direction.argmax(axis=-1) > direction.argmin(axis=-1), 1.0, -1.0)
    size: Array = np.ptp(direction, axis=-1)
    return sign * size


def find_turns(trial: Kymograph, bend: float = BEND) -> list[Turn]:
    """Find the turns of a trial.

    A turn is where the deepest bend is at least `bend` for at least 0.5 s; interruptions of up to
    0.25 s are bridged.

    Raises:
        BadInputError: the bend is not positive.
    """
    if not math.isfinite(bend) or bend <= 0.0:
        raise BadInputError('bend', bend, 'a finite angle > 0 [rad]')
    signed = deepest_bend(trial.angles)
    bent = np.abs(signed) >= bend
    edges = np.flatnonzero(np.diff(np.concatenate([[False], bent, [False]])))
    runs: list[list[int]] = []
    for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist()):
        if runs and start - runs[-1][1] <= BRIDGED * trial.fps:
            runs[-1][1] = stop
        else:
            runs.append([start, stop])
    turns = []
    for start, stop in runs:
        if stop - start >= SHORTEST * trial.fps:
            peak = start + int(np.abs(signed[start:stop]).argmax())
            first = trial.first
            turns.append(Turn(first + start, first + stop, first + peak, float(signed[peak])))
    return turns
