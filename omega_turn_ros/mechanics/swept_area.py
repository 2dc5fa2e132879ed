"""Ground a robot needs for a motion (Sec. IV.D): the convex hull of all places its body was at."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain

Array = NDArray[np.float64]


def body_corners(chain: PlanarChain, width: float, path: ArrayLike, poses: ArrayLike) -> Array:
    """Corners of all links in the world.

    Args:
        chain: the robot.
        width: of its links [m]; 0 gives the body axis.
        path: yaw joint angles [rad], shape (T, N).
        poses: of the mean body frame, x [m], y [m], heading [rad], shape (T, 3).

    Returns:
        Front left, front right, rear right, rear left of each link [m], shape (T, L, 4, 2).
    """
    axis = chain.outline(path, poses)
    front, rear = axis[:, :-1], axis[:, 1:]
    along = (front - rear) / chain.lengths[:, None]
    side = 0.5 * width * np.stack([-along[..., 1], along[..., 0]], axis=-1)
    return np.stack([front + side, front - side, rear - side, rear + side], axis=-2)


def swept_area(chain: PlanarChain, width: float, path: ArrayLike, poses: ArrayLike) -> float:
    """Area of the convex hull of everything the body covered, in body lengths squared.

    Args:
        chain: the robot.
        width: of its links [m]; 0 takes the body axis alone, as markers on a backbone would.
        path: yaw joint angles [rad], shape (T, N).
        poses: of the mean body frame, shape (T, 3).
    """
    return hull_area(body_corners(chain, width, path, poses)) / float(chain.lengths.sum()) ** 2


def swept_area_by_start(
    chain: PlanarChain, path: ArrayLike, poses: ArrayLike, starts: int
) -> Array:
    """Area that one cycle of the body axis sweeps, by where the cycle starts.

    The body has turned when it comes back to a shape, so it matters (own derivation: the next
    cycle is this one moved on by the displacement of a cycle).

    Args:
        chain: the robot.
        path: yaw joint angles of one cycle, both ends [rad], shape (T, N).
        poses: of the mean body frame, x [m], y [m], heading [rad], shape (T, 3).
        starts: how many, spread along the cycle, the given one first.

    Returns:
        Areas in body lengths squared, shape (starts,).

    Raises:
        BadInputError: no start.
    """
    if starts < 1:
        raise BadInputError('starts', starts, 'at least 1')
    axis, pose = chain.outline(path, poses), np.asarray(poses, float)
    turn = pose[-1, 2] - pose[0, 2]
    c, s = np.cos(turn), np.sin(turn)
    moved = (axis - pose[0, :2]) @ np.array([[c, s], [-s, c]]) + pose[-1, :2]
    two = np.concatenate([axis, moved[1:]])
    steps = len(axis) - 1
    begins = np.arange(starts) * steps // starts
    hulls = np.array([hull_area(two[begin : begin + steps + 1]) for begin in begins])
    areas: Array = hulls / float(chain.lengths.sum()) ** 2
    return areas


def hull_area(points: Array) -> float:
    """Area of the convex hull [m^2] of points, shape (..., 2)."""
    return float(ConvexHull(points.reshape(-1, 2)).volume)
