"""Where a path of postures takes a robot that lifts part of its body: the feet that carry rub.

The force balance of Sec. IV.A, each foot's friction in proportion to its load. Quasi-static and
independent of speed; a robot that tips from one rest to the next is taken to land at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.force_balance import solve_balance
from omega_turn_ros.mechanics.resting_chain import RestingChain
from omega_turn_ros.mechanics.trajectory import integrate_twists, path_through

Array = NDArray[np.float64]


def resting_pose_along(chain: RestingChain, path: ArrayLike) -> Array:
    """Pose of the mean body frame along one path of postures from the origin.

    Args:
        chain: the robot.
        path: angles of all joints [rad], shape (T, n_joints), T >= 2.

    Returns:
        x [m], y [m], heading [rad] in the world, shape (T, 3).

    Raises:
        BadInputError: wrong shape, or a value that is not finite.
        ConvergenceError: a posture did not settle, or its friction was not balanced.
    """
    postures = np.asarray(path, float)
    if postures.ndim != 2 or postures.shape[0] < 2:
        raise BadInputError('path', postures.shape, 'shape (T, n_joints), T >= 2')
    state = chain.state(postures)
    feet = state.feet[..., :2]
    middle, change = 0.5 * (feet[1:] + feet[:-1]), np.diff(feet, axis=0)
    loads = 0.5 * (state.loads[1:] + state.loads[:-1])
    return integrate_twists(solve_balance(middle, change, loads))


def resting_heading_along(chain: RestingChain, path: ArrayLike) -> Array:
    """Heading alone of `resting_pose_along` [rad], shape (T,)."""
    return resting_pose_along(chain, path)[:, 2]


def lie_down_heading(
    chain: RestingChain, angles: ArrayLike, waypoint: ArrayLike | None = None
) -> float:
    """Heading change when a posture is straightened joint-linearly [rad].

    Args:
        chain: the robot.
        angles: of all joints [rad], shape (n_joints,).
        waypoint: posture passed on the way, likewise.
    """
    posture = np.asarray(angles, float)
    path = path_through(posture, waypoint, 0.0 * posture)
    return float(resting_heading_along(chain, path)[-1])
