"""Readings of 'the area swept by the body' (Sec. IV.D), in body lengths squared.

The paper's words: 'the convex hull of all points the tracked positions on the robot passed through
over the course of a cycle'. They leave open where the cycle starts, and because the body has moved
on when it comes back to a shape, that matters.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.swept_area import body_corners

Array = NDArray[np.float64]

READINGS = {
    'swept_area': 'hull of the body axis',
    'swept_area_least': 'hull, least over where the cycle starts',
    'swept_area_most': 'hull, most over where the cycle starts',
    'swept_area_markers': 'hull of the yaw joints',
    'swept_area_union': 'union of what the body in its width covers',
}
STARTS = 20  # along the cycle


def area_readings(
    chain: PlanarChain, width: float, path: ArrayLike, poses: ArrayLike
) -> dict[str, float]:
    """Every reading of the area swept in a cycle.

    Args:
        chain: the robot.
        width: of its links [m].
        path: yaw joint angles of one cycle, both ends [rad], shape (T, N).
        poses: of the mean body frame, x [m], y [m], heading [rad], shape (T, 3).

    Returns:
        Area [BL^2] by name, in the order of `READINGS`.
    """
    from shapely import polygons, union_all

    axis = chain.outline(path, poses)
    corners = body_corners(chain, width, path, poses)
    covered = union_all(polygons(corners.reshape(-1, 4, 2)))
    by_start = _hulls_by_start(axis, np.asarray(poses, float))
    areas = {
        'swept_area': by_start[0],
        'swept_area_least': min(by_start),
        'swept_area_most': max(by_start),
        'swept_area_markers': _hull(axis[:, 1:-1]),
        'swept_area_union': float(covered.area),
    }
    return {name: areas[name] / float(chain.lengths.sum()) ** 2 for name in READINGS}


def _hulls_by_start(axis: Array, poses: Array) -> list[float]:
    """Hull of one cycle [m^2] for starts spread along it, the given start first.

    Args:
        axis: points on the body [m], shape (T, P, 2).
        poses: shape (T, 3).
    """
    # The next cycle is this one moved on by the displacement of a cycle.
    turn = poses[-1, 2] - poses[0, 2]
    c, s = np.cos(turn), np.sin(turn)
    moved = (axis - poses[0, :2]) @ np.array([[c, s], [-s, c]]) + poses[-1, :2]
    two = np.concatenate([axis, moved[1:]])
    steps = len(axis) - 1
    starts = np.arange(STARTS) * steps // STARTS
    return [_hull(two[start : start + steps + 1]) for start in starts]


def _hull(points: Array) -> float:
    """Area of the convex hull [m^2] of points, shape (..., 2)."""
    return float(ConvexHull(points.reshape(-1, 2)).volume)
