"""Ground a robot needs for a motion (Sec. IV.D): the convex hull of all places its body was at."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull

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
    corners = body_corners(chain, width, path, poses).reshape(-1, 2)
    length = chain.lengths.sum()
    return float(ConvexHull(corners).volume / length**2)
