"""Quasi-static body velocity under kinetic Coulomb friction (Sec. IV.A: F = -mu v/|v|).

Friction forces balance exactly where the dissipation sum_j w_j |v_j| is smallest over the body
velocity: three unknowns, convex. Newton's method on the norm smoothed by epsilon, with epsilon
lowered in steps and each step started from the last (own derivation).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import ConvergenceError
from omega_turn_ros.mechanics.chain import PlanarChain, ShapeState

Array = NDArray[np.float64]

# Relative to the mean shape speed. The last value bounds the error of a sticking point's force.
SMOOTHING = (1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5)
NEWTON_STEPS = 25
GRADIENT_TOLERANCE = 1e-8  # relative to mu times the weight


def body_velocity(chain: PlanarChain, angles: ArrayLike, rates: ArrayLike) -> Array:
    """Velocity of the mean body frame that balances friction force and torque.

    Independent of the friction coefficient (uniform, isotropic) and linear in a common factor on
    `rates`.

    Args:
        chain: the robot.
        angles: yaw joint angles [rad], shape (..., N).
        rates: their time derivatives [rad/s], shape (..., N).

    Returns:
        [xi_x, xi_y, xi_theta] in the mean body frame [m/s, m/s, rad/s], shape (..., 3).

    Raises:
        ConvergenceError: Newton's method stopped short of the tolerance.
    """
    angles, rates = np.broadcast_arrays(np.asarray(angles, float), np.asarray(rates, float))
    batch = angles.shape[:-1]
    state = chain.state(angles.reshape(-1, chain.n_joints), rates.reshape(-1, chain.n_joints))
    velocity = solve_balance(state.points, state.velocities, chain.normal_forces)
    return velocity.reshape(*batch, 3)


def solve_balance(points: Array, velocities: Array, weights: Array) -> Array:
    """Minimise sum_j w_j |v_j + xi_xy + xi_theta z x p_j| over xi for each of B shapes.

    Args:
        points: [m], shape (B, P, 2).
        velocities: at xi = 0 [m/s], shape (B, P, 2).
        weights: friction strengths, any unit, shape (P,), or (B, P) where the load shifts.

    Returns:
        xi, shape (B, 3).

    Raises:
        ConvergenceError: Newton's method stopped short of the tolerance.
    """
    speed = _mean_speed(velocities, weights)
    moving = speed > 0.0
    xi = np.zeros((points.shape[0], 3))
    if not moving.any():
        return xi
    # Unit speed and unit body size make one tolerance fit every shape.
    size = float(np.abs(points).max())
    p = points[moving] / size
    v = velocities[moving] / speed[moving, None, None]
    w = _shares(weights) if weights.ndim == 1 else _shares(weights[moving])
    solution = np.zeros((p.shape[0], 3))
    for epsilon in SMOOTHING:
        solution = _newton(p, v, w, solution, epsilon)
    xi[moving] = solution * speed[moving, None]
    xi[moving, 2] /= size
    return xi


def _mean_speed(velocities: Array, weights: Array) -> Array:
    """Weighted mean of |v_x| + |v_y| of each shape, shape (B,)."""
    subscripts = 'j,bjx->b' if weights.ndim == 1 else 'bj,bjx->b'
    mean: Array = np.einsum(subscripts, _shares(weights), np.abs(velocities))
    return mean


def _shares(weights: Array) -> Array:
    share: Array = weights / weights.sum(axis=-1, keepdims=True)
    return share


def _rows(w: Array, which: NDArray[np.intp]) -> Array:
    """Weights of some of the shapes, where each has its own."""
    return w if w.ndim == 1 else w[which]


def _summed(values: Array, w: Array) -> Array:
    """Weighted sums of (B, P) over P, shape (B,)."""
    result: Array = values @ w if w.ndim == 1 else np.einsum('bp,bp->b', values, w)
    return result


def _newton(p: Array, v: Array, w: Array, xi: Array, epsilon: float) -> Array:
    """Damped Newton from `xi` for every shape at one smoothing length."""
    xi = xi.copy()
    open_ = np.arange(xi.shape[0])
    for _ in range(NEWTON_STEPS):
        gradient, hessian = _derivatives(p[open_], v[open_], _rows(w, open_), xi[open_], epsilon)
        unfinished = np.abs(gradient).max(axis=1) > GRADIENT_TOLERANCE
        open_ = open_[unfinished]
        if open_.size == 0:
            return xi
        step = np.linalg.solve(hessian[unfinished], -gradient[unfinished][..., None])[..., 0]
        rows = (p[open_], v[open_], _rows(w, open_), xi[open_])
        xi[open_] = _line_search(*rows, step, epsilon)
    gradient, _ = _derivatives(p[open_], v[open_], _rows(w, open_), xi[open_], epsilon)
    worst = float(np.abs(gradient).max())
    # Near the end rounding in the objective, not the optimum, can stop the line search.
    if worst > 1e3 * GRADIENT_TOLERANCE:
        raise ConvergenceError(f'force balance: residual {worst:.2g} of the friction force')
    return xi


def slip_velocities(p: Array, v: Array, xi: Array) -> Array:
    """Velocity of every point once the body moves with xi [m/s], shape (B, P, 2).

    Args:
        p: points [m], shape (B, P, 2).
        v: their velocities at xi = 0 [m/s], shape (B, P, 2).
        xi: body velocity [m/s, m/s, rad/s], shape (B, 3).
    """
    turn = xi[:, 2, None, None] * np.stack([-p[..., 1], p[..., 0]], axis=-1)
    return v + xi[:, None, :2] + turn


def _dissipation(p: Array, v: Array, w: Array, xi: Array, epsilon: float) -> Array:
    slip = slip_velocities(p, v, xi)
    return _summed(np.sqrt((slip**2).sum(axis=-1) + epsilon**2), w)


def _derivatives(p: Array, v: Array, w: Array, xi: Array, epsilon: float) -> tuple[Array, Array]:
    """Gradient (B, 3) and Hessian (B, 3, 3) of the smoothed dissipation."""
    slip = slip_velocities(p, v, xi)
    norm = np.sqrt((slip**2).sum(axis=-1) + epsilon**2)
    x, y = p[..., 0], p[..., 1]
    unit = slip / norm[..., None]
    ux, uy = unit[..., 0], unit[..., 1]
    lever = x * uy - y * ux  # (z x p) . unit
    gradient = np.stack([_summed(u, w) for u in (ux, uy, lever)], axis=-1)
    k = w / norm
    columns = ((1.0, 0.0, ux, -y), (0.0, 1.0, uy, x))
    hessian = np.empty((p.shape[0], 3, 3))
    (xx, xy, xu, xt), (_, yy, yu, yt) = columns
    entries = (
        (0, 0, xx - xu * xu),
        (0, 1, xy - xu * yu),
        (1, 1, yy - yu * yu),
        (0, 2, xt - ux * lever),
        (1, 2, yt - uy * lever),
        (2, 2, x * x + y * y - lever * lever),
    )
    for i, j, entry in entries:
        hessian[:, i, j] = hessian[:, j, i] = (k * entry).sum(axis=-1)
    return gradient, hessian


def _line_search(p: Array, v: Array, w: Array, xi: Array, step: Array, epsilon: float) -> Array:
    """Halve each step until the dissipation does not grow."""
    before = _dissipation(p, v, w, xi, epsilon)
    factor = np.ones(xi.shape[0])
    for _ in range(30):
        trial = xi + factor[:, None] * step
        worse = _dissipation(p, v, w, trial, epsilon) > before * (1.0 + 1e-15)
        if not worse.any():
            return trial
        factor[worse] *= 0.5
    return xi + factor[:, None] * step


def joint_torques(
    chain: PlanarChain, angles: ArrayLike, rates: ArrayLike, friction: float
) -> Array:
    """Actuator torque each yaw joint needs against ground friction in quasi-static motion.

    tau_i + sum over the points behind joint i of (p_j - q_i) x f_j = 0, where
    f_j = -mu N_j v_j/|v_j| (own derivation from the torque balance of Sec. IV.A).

    Args:
        chain: the robot, whose weight scales the result.
        angles: yaw joint angles [rad], shape (..., N).
        rates: their time derivatives [rad/s], shape (..., N).
        friction: kinetic friction coefficient mu.

    Returns:
        Torques on the link behind each joint, + = counter-clockwise [N m], shape (..., N).
    """
    angles, rates = np.broadcast_arrays(np.asarray(angles, float), np.asarray(rates, float))
    flat_shape = (-1, chain.n_joints)
    state = chain.state(angles.reshape(flat_shape), rates.reshape(flat_shape))
    xi = solve_balance(state.points, state.velocities, chain.normal_forces)
    torque = torques_of_slip(
        chain, state, slip_velocities(state.points, state.velocities, xi), friction
    )
    return torque.reshape(angles.shape)


def torques_of_slip(chain: PlanarChain, state: ShapeState, slip: Array, mu: float) -> Array:
    """Actuator torques against the friction of slipping points [N m], shape (B, N).

    Args:
        chain: the robot.
        state: its shapes, batch shape (B,).
        slip: velocities of the contact points [m/s], shape (B, P, 2).
        mu: kinetic friction coefficient.
    """
    # Smoothed as in the balance: only then do the forces of sticking points add up to zero.
    epsilon = SMOOTHING[-1] * _mean_speed(state.velocities, chain.normal_forces)[:, None]
    scale = np.sqrt((slip**2).sum(axis=-1) + np.maximum(epsilon, 1e-150) ** 2)
    force = -mu * chain.normal_forces[:, None] * slip / scale[..., None]
    behind = chain.link_of_point[None, :] > np.arange(chain.n_joints)[:, None]  # (N, P)
    moment = state.points[..., 0] * force[..., 1] - state.points[..., 1] * force[..., 0]
    about_origin = moment @ behind.T
    force_behind = np.einsum('np,bpx->bnx', behind, force)
    shift = (
        state.joints[..., 0] * force_behind[..., 1] - state.joints[..., 1] * force_behind[..., 0]
    )
    result: Array = -(about_origin - shift)
    return result
