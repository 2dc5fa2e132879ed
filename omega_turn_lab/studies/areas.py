"""Readings of 'the area swept by the body' (Sec. IV.D), in body lengths squared."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.swept_area import body_corners

# Quantity -> what is measured. The paper's words: 'the convex hull of all points the tracked
# positions on the robot passed through over the course of a cycle'.
READINGS = {
    'swept_area': 'convex hull of the body axis',
    'swept_area_markers': 'convex hull of the yaw joints',
    'swept_area_width': 'convex hull of the body in its width',
    'swept_area_union': 'union of what the body in its width covers',
}


def area_readings(
    chain: PlanarChain, width: float, path: ArrayLike, poses: ArrayLike
) -> dict[str, float]:
    """Every reading of the area swept along a path.

    Args:
        chain: the robot.
        width: of its links [m].
        path: yaw joint angles [rad], shape (T, N).
        poses: of the mean body frame, x [m], y [m], heading [rad], shape (T, 3).

    Returns:
        Area [BL^2] by name, in the order of `READINGS`.
    """
    from shapely import polygons, union_all

    axis = chain.outline(path, poses)
    corners = body_corners(chain, width, path, poses)
    covered = union_all(polygons(corners.reshape(-1, 4, 2)))
    joints = axis[:, 1:-1]
    areas = {
        'swept_area': _hull(axis),
        'swept_area_markers': _hull(joints),
        'swept_area_width': _hull(corners),
        'swept_area_union': float(covered.area),
    }
    return {name: areas[name] / float(chain.lengths.sum()) ** 2 for name in READINGS}


def _hull(points: np.ndarray) -> float:
    """Area of the convex hull [m^2] of points, shape (..., 2)."""
    return float(ConvexHull(points.reshape(-1, 2)).volume)
