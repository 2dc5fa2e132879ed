"""Choose one function of a gait on the height function of its plane (Sec. III.C)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.design.sub_shape import Plane, SubShape, grid
from omega_turn_ros.gaits.two_wave import TwoWaveGait
from omega_turn_ros.mechanics.shape_grid import GridFunction

Array = NDArray[np.float64]

GRID = 24  # points along each axis of a plane
STEPS = 48  # of a path in a plane
CANDIDATES = 240
REACH = 1.6  # largest amplitude in a plane, over the joint limit

PARAMETERS: dict[Plane, tuple[str, ...]] = {
    'turning': ('a_o', 'phi_o'),
    'forward': ('a_f', 'gamma', 'phi_f'),
    'phase': ('psi',),
}


def propose(
    sub: SubShape, spread: float, rng: np.random.Generator, count: int
) -> list[TwoWaveGait]:
    """Gaits that differ from the given one in one function only, best predicted turn first.

    Candidates, half of them around the gait's own function and half from everywhere, are paths in
    the plane. Each is given the turn that the linear connection predicts: surface term and loops of
    `mechanics.height_function`. A path that enters the infeasible region by bending joints too far
    counts as shrunk, with the whole gait, until it keeps the limit. The mirrored gait turns back,
    so a turn is odd in amplitude; it starts with the third power because small paths enclose areas
    that grow with the second, over heights that grow with the first (own derivation).

    Args:
        sub: plane around the gait.
        spread: of the candidates around the gait's own function: 1 is half a radian in phase.
        rng: source of the candidates.
        count: how many to return.
    """
    reach = REACH * sub.problem.theta_max
    values = _candidates(sub, spread, reach, rng)
    first, second = _paths(sub, values)
    field = sub.field(GRID, reach)
    if sub.plane != 'phase':
        inside = np.abs(second).max(axis=1) <= reach
        values, first, second = values[inside], first[inside], second[inside]
    # The loops are the same for all candidates of a plane: they do not change the order,
    # but the sign of what is shrunk.
    loops = field.loops(np.stack([first[0], second[0]], axis=-1))
    turn = field.integrated_height().surface(first, second) + loops
    limits = sub.feasibility(grid(field.axes))
    bend = GridFunction(field.axes, limits.bend)(first, second).max(axis=1)
    clearance = GridFunction(field.axes, np.minimum(limits.clearance, 1.0))(first, second)
    turn *= np.minimum(1.0, 1.0 / bend) ** 3
    turn[(clearance.min(axis=1) < -sub.problem.width) & (bend <= 1.0)] = -np.inf
    best = np.argsort(-turn, kind='stable')[:count]
    names = PARAMETERS[sub.plane]
    return [
        replace(sub.gait, **dict(zip(names, (float(v) for v in values[i]), strict=True)))
        for i in best
    ]


def _candidates(sub: SubShape, spread: float, reach: float, rng: np.random.Generator) -> Array:
    """Parameters of the candidates [rad] and [-], shape (CANDIDATES, parameters)."""
    half = CANDIDATES // 2
    own = np.array([getattr(sub.gait, name) for name in PARAMETERS[sub.plane]])
    scale = {'turning': (0.2, 0.5), 'forward': (0.2, 0.3, 0.5), 'phase': (0.5,)}[sub.plane]
    near = own + spread * np.array(scale) * rng.normal(size=(half, own.size))
    phase = rng.uniform(-np.pi, np.pi, half)
    amplitude = rng.uniform(-1.0, 1.0, half) * reach
    if sub.plane == 'turning':
        far = np.stack([0.5 * amplitude, phase], axis=-1)
    elif sub.plane == 'forward':
        mean = rng.uniform(-1.2, 1.2, half)
        far = np.stack([amplitude / (1.0 + np.abs(mean)), mean, phase], axis=-1)
    else:
        far = phase[:, None]
    return np.concatenate([near, far])


def _paths(sub: SubShape, values: Array) -> tuple[Array, Array]:
    """Closed paths of candidates in the plane, r_1 and r_2 [rad], each shape (C, STEPS + 1)."""
    first = np.linspace(0.0, 2.0 * np.pi, STEPS + 1)
    columns = values.T[..., None]
    if sub.plane == 'turning':
        second = columns[0] * (1.0 + np.sin(first + columns[1]))
    elif sub.plane == 'forward':
        second = columns[0] * (columns[1] + np.sin(first + columns[2]))
    else:
        second = first + columns[0]
    return np.broadcast_to(first, second.shape), second
