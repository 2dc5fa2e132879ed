"""Where a path through shape space takes the body (eq:lineintegral, nonlinear force balance)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import body_velocity

Array = NDArray[np.float64]


def heading_along(chain: PlanarChain, path: ArrayLike) -> Array:
    """Heading of the mean body axis along a path of shapes, 0 at its start.

    Rate-independent: only the sequence of shapes counts. Midpoint rule, so the error falls with
    the square of the step.

    Args:
        chain: the robot.
        path: yaw joint angles [rad], shape (..., T, N), T >= 2.

    Returns:
        Heading [rad], shape (..., T).
    """
    shapes = np.asarray(path, float)
    step = np.diff(shapes, axis=-2)
    turn = body_velocity(chain, shapes[..., :-1, :] + 0.5 * step, step)[..., 2]
    heading = np.zeros(shapes.shape[:-1])
    np.cumsum(turn, axis=-1, out=heading[..., 1:])
    return heading


def pose_along(chain: PlanarChain, path: ArrayLike) -> Array:
    """Pose of the mean body frame along one path of shapes, starting at the origin.

    Each step is an exact SE(2) motion with constant body velocity.

    Args:
        chain: the robot.
        path: yaw joint angles [rad], shape (T, N), T >= 2.

    Returns:
        x [m], y [m], heading [rad] in the world, shape (T, 3).
    """
    shapes = np.asarray(path, float)
    step = np.diff(shapes, axis=0)
    return integrate_twists(body_velocity(chain, shapes[:-1] + 0.5 * step, step))


def integrate_twists(twists: ArrayLike) -> Array:
    """Chain SE(2) motions, each of constant body velocity for one unit of time.

    Args:
        twists: body velocities [m, m, rad] per step, shape (T, 3).

    Returns:
        Poses from the origin: x [m], y [m], heading [rad], shape (T + 1, 3).
    """
    vx, vy, turn = np.asarray(twists, float).T
    heading = np.concatenate([[0.0], np.cumsum(turn)])
    # sinc forms stay exact as the turn goes to zero
    a = np.sinc(turn / np.pi)
    b = 0.5 * turn * np.sinc(0.5 * turn / np.pi) ** 2
    dx, dy = a * vx - b * vy, b * vx + a * vy
    c, s = np.cos(heading[:-1]), np.sin(heading[:-1])
    pose = np.zeros((heading.size, 3))
    np.cumsum(c * dx - s * dy, out=pose[1:, 0])
    np.cumsum(s * dx + c * dy, out=pose[1:, 1])
    pose[:, 2] = heading
    return pose


def path_through(start: ArrayLike, waypoint: ArrayLike | None, end: ArrayLike) -> Array:
    """Straight lines from shape to shape, past a waypoint if there is one [rad], (T, N)."""
    if waypoint is None:
        return straight_path(start, end)
    return np.concatenate([straight_path(start, waypoint), straight_path(waypoint, end)[1:]])


def straight_path(start: ArrayLike, end: ArrayLike, steps: int = 40) -> Array:
    """Straight line between two shapes [rad], shape (steps + 1, N)."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    fraction = np.linspace(0.0, 1.0, steps + 1)[:, None]
    result: Array = a + fraction * (b - a)
    return result
