"""Choose one function of a gait on the height function of its plane (Sec. III.C)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.design.sub_shape import Plane, SubShape, grid
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.mechanics.shape_grid import GridFunction

Array = NDArray[np.float64]

GRID = 20  # points along each axis of a plane
STEPS = 40  # of a path in a plane
CANDIDATES = {'turning': 160, 'forward': 240, 'phase': 60}
REACH = 1.6  # largest amplitude in a plane, over the joint limit
SLOPE = 0.4  # spread of the paths' slopes over that of their parameters

PARAMETERS: dict[Plane, dict[str, float]] = {  # and what a spread of 1 means for them
    'turning': {'a_o': 0.2, 'phi_o': 0.5},
    'forward': {'a_f': 0.2, 'gamma': 0.3, 'phi_f': 0.5},
    'phase': {'psi': 0.5},
}


def propose(
    sub: SubShape, spread: float, rng: np.random.Generator, count: int
) -> list[TwoWaveGait]:
    """Gaits that differ from the given one in one function only, best predicted turn first.

    Candidates, half of them around the gait's own function and half from everywhere, are paths in
    the plane. Each is given the turn that the linear connection predicts: surface term and loops
    of `mechanics.height_function`. A path that enters the infeasible region counts as shrunk, with
    the whole gait, until it does not. The mirrored gait turns back, so a turn is odd in amplitude;
    it starts with the third power because small paths enclose areas that grow with the second,
    over heights that grow with the first (own derivation).

    Args:
        sub: plane around the gait.
        spread: of the candidates around the gait's own function, 1 is half a radian in phase; the
            connection is fitted to slopes spread as wide.
        rng: source of the candidates.
        count: how many to return.
    """
    reach = REACH * sub.problem.theta_max
    values, first, second = _candidates(sub, spread, reach, rng)
    field = sub.field(GRID, reach, SLOPE * spread)
    # The loops are the same for all candidates of a plane, but count where one is shrunk.
    loops = field.loops(np.stack([first[0], second[0]], axis=-1))
    turn = field.integrated_height().surface(first, second) + loops
    allowed = GridFunction(field.axes, sub.allowed_scale(grid(field.axes)), degree=1)
    turn *= allowed(first, second).min(axis=1) ** 3
    best = np.argsort(-turn, kind='stable')[:count]
    names = tuple(PARAMETERS[sub.plane])
    return [replace(sub.gait, **dict(zip(names, values[i].tolist()))) for i in best]


def _candidates(
    sub: SubShape, spread: float, reach: float, rng: np.random.Generator
) -> tuple[Array, Array, Array]:
    """Parameters, shape (C, parameters), and paths r_1 and r_2 [rad], each (C, STEPS + 1)."""
    half = CANDIDATES[sub.plane] // 2
    scales = PARAMETERS[sub.plane]
    own = np.array([getattr(sub.gait, name) for name in scales])
    near = own + spread * np.array(list(scales.values())) * rng.normal(size=(half, own.size))
    phase = rng.uniform(-np.pi, np.pi, half)
    amplitude = rng.uniform(-reach, reach, half)
    mean = rng.uniform(-1.2, 1.2, half)
    far = {
        'turning': (0.5 * amplitude, phase),
        'forward': (amplitude / (1.0 + np.abs(mean)), mean, phase),
        'phase': (phase,),
    }
    values = np.concatenate([near, np.stack(far[sub.plane], axis=-1)])
    columns = values.T[..., None]
    first = np.broadcast_to(np.linspace(0.0, 2.0 * np.pi, STEPS + 1), (len(values), STEPS + 1))
    if sub.plane == 'phase':
        return values, first, first + columns[0]
    if sub.plane == 'turning':
        second = columns[0] * (1.0 + np.sin(first + columns[1]))
    else:
        second = columns[0] * (columns[1] + np.sin(first + columns[2]))
    inside = np.abs(second).max(axis=1) <= reach
    return values[inside], first[inside], second[inside]
