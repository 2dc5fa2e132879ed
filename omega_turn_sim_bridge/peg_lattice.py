"""Where pegs stand: a hexagonal lattice laid at random around a straight robot."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.robot import Robot
from omega_turn_sim_bridge.terrain_config import TerrainConfig

Array = NDArray[np.float64]

DRAWS = 20_000  # placements tried before the robot is said not to fit


def peg_positions(config: TerrainConfig, robot: Robot, seed: int) -> Array:
    """Lay the lattice at a random offset and orientation that leaves the straight robot free.

    Args:
        config: spacing, size and extent.
        robot: lies straight along x with its middle at the origin.
        seed: of the placement; placements are drawn until one is free.

    Returns:
        Axes of the pegs, x, y in the world [m], shape (n_pegs, 2).

    Raises:
        BadInputError: no placement leaves the robot free.
    """
    spacing = config.spacing_bl * robot.length
    if spacing <= 2.0 * config.peg_radius:
        expected = f'more than a peg diameter, {2.0 * config.peg_radius / robot.length:.3g} BL'
        raise BadInputError('terrain spacing_bl', config.spacing_bl, expected)
    lattice = _lattice(spacing, config.extent_bl * robot.length)
    near = lattice[np.hypot(*lattice.T) < robot.length]
    room = 0.5 * robot.module_width + config.peg_radius + config.clearance
    rng = np.random.default_rng(seed)
    for _ in range(DRAWS):
        shift = rng.uniform(0.0, 1.0, 2) @ _cell(spacing)
        angle = rng.uniform(0.0, math.pi / 3.0)
        if _distance_to_body(_placed(near, shift, angle), robot.length).min() > room:
            return _placed(lattice, shift, angle)
    expected = f'room for a straight robot; none of {DRAWS} placements left it free'
    raise BadInputError('terrain spacing_bl', config.spacing_bl, expected)


def _cell(spacing: float) -> Array:
    """Edges of the lattice's cell [m], shape (2, 2)."""
    return spacing * np.array([[1.0, 0.0], [0.5, math.sqrt(0.75)]])


def _lattice(spacing: float, reach: float) -> Array:
    """Points of the lattice within reach of its origin and one cell more [m], shape (n, 2)."""
    count = math.ceil(reach / (spacing * math.sqrt(0.75))) + 2
    i, j = np.mgrid[-count : count + 1, -count : count + 1].reshape(2, -1)
    points: Array = np.stack([i, j], axis=-1) @ _cell(spacing)
    return points[np.hypot(*points.T) <= reach + spacing]


def _placed(points: Array, shift: Array, angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    placed: Array = (points + shift) @ np.array([[c, s], [-s, c]])
    return placed


def _distance_to_body(points: Array, length: float) -> Array:
    """Distance of points from the axis of the straight robot [m], shape (n,)."""
    beyond = np.maximum(np.abs(points[:, 0]) - 0.5 * length, 0.0)
    return np.hypot(beyond, points[:, 1])
