"""Readings of 'the area swept by the body' (Sec. IV.D), in body lengths squared.

The paper's words: 'the convex hull of all points the tracked positions on the robot passed through
over the course of a cycle'. They leave open where the cycle starts, and because the body has moved
on when it comes back to a shape, that matters.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.swept_area import body_corners, hull_area, swept_area_by_start

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

    squared = float(chain.lengths.sum()) ** 2
    joints = chain.outline(path, poses)[:, 1:-1]
    covered = union_all(polygons(body_corners(chain, width, path, poses).reshape(-1, 4, 2)))
    by_start = swept_area_by_start(chain, path, poses, STARTS)
    areas = {
        'swept_area': float(by_start[0]),
        'swept_area_least': float(by_start.min()),
        'swept_area_most': float(by_start.max()),
        'swept_area_markers': hull_area(joints) / squared,
        'swept_area_union': float(covered.area) / squared,
    }
    return {name: areas[name] for name in READINGS}
