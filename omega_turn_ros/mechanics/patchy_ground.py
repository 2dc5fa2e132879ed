"""Level ground that bears a body in patches only, such as the tops of rocks (own derivation)."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import norm

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import solve_balance

Array = NDArray[np.float64]

WAVES = 40  # plane waves summed to a random field
WAVE_SPREAD = 0.15  # standard deviation of their wave numbers, relative
HANGING = 1e-3  # load of a point over a gap over that of one on a patch: never all without load


class PatchyGround:
    """Many grounds of one kind: patches a spacing apart, anywhere.

    A patch is where a random field, the sum of plane waves of about one length from all
    directions, is high. The body's weight rests on the patches under it, evenly.

    Args:
        bearing: share of the ground that bears, in (0, 1].
        spacing: length of the waves [m]: patches are about so far apart.
        count: G, how many grounds.
        seed: of the fields.

    Raises:
        BadInputError: an argument is out of range.
    """

    def __init__(self, bearing: float, spacing: float, count: int, seed: int) -> None:
        if not 0.0 < bearing <= 1.0:
            raise BadInputError('bearing', bearing, 'a share in (0, 1]')
        if not 0.0 < spacing < np.inf:
            raise BadInputError('spacing', spacing, 'a length > 0 [m]')
        if count < 1:
            raise BadInputError('count', count, 'at least 1')
        rng = np.random.default_rng(seed)
        numbers = 2.0 * np.pi / spacing * rng.normal(1.0, WAVE_SPREAD, (count, 1, WAVES))
        directions = rng.uniform(0.0, 2.0 * np.pi, (count, 1, WAVES))
        self._x, self._y = numbers * np.cos(directions), numbers * np.sin(directions)
        self._phases = rng.uniform(0.0, 2.0 * np.pi, (count, 1, WAVES))
        self.count = count
        self._least = float(norm.ppf(1.0 - bearing)) * math.sqrt(0.5 * WAVES)  # as good as normal

    def bears(self, points: Array) -> NDArray[np.bool_]:
        """Whether patches lie under points in the world [m], shape (G, P, 2); shape (G, P)."""
        x, y = points[..., :1], points[..., 1:]
        field = np.cos(self._x * x + self._y * y + self._phases).sum(axis=-1)
        result: NDArray[np.bool_] = field > self._least
        return result


def headings_on_patches(chain: PlanarChain, path: ArrayLike, ground: PatchyGround) -> Array:
    """Headings of the mean body axis along a path of shapes, by force balance on each ground.

    Each step is a motion with constant body velocity at the load of its middle shape and first
    pose, so the error falls with the step.

    Args:
        chain: the robot.
        path: yaw joint angles [rad], shape (T, N), T >= 2.
        ground: G grounds; the robot starts at the origin of each, along x.

    Returns:
        Heading [rad], shape (T, G), 0 at the start.

    Raises:
        ConvergenceError: a force balance was not solved.
    """
    shapes = np.asarray(path, float)
    pose = np.zeros((ground.count, 3))
    headings = np.zeros((len(shapes), ground.count))
    for i, (first, last) in enumerate(itertools.pairwise(shapes)):
        state = chain.state(0.5 * (first + last), last - first)
        loads = np.where(ground.bears(_in_world(pose, state.points)), 1.0, HANGING)
        shape = (ground.count, *state.points.shape)
        step = solve_balance(
            np.broadcast_to(state.points, shape),
            np.broadcast_to(state.velocities, shape),
            chain.normal_forces * loads,
        )
        middle = pose + [0.0, 0.0, 0.5] * step
        pose[:, :2] += _turned(middle[:, 2:], step[:, None, :2])[:, 0]
        pose[:, 2] += step[:, 2]
        headings[i + 1] = pose[:, 2]
    return headings


def _in_world(pose: Array, points: Array) -> Array:
    return pose[:, None, :2] + _turned(pose[:, 2:], points)


def _turned(heading: Array, vectors: Array) -> Array:
    """Turn vectors (..., n, 2) by headings (G, 1) [rad]; shape (G, n, 2)."""
    c, s = np.cos(heading), np.sin(heading)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)
