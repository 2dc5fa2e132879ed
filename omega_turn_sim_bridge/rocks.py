"""A pile of convex rocks: dropped, come to rest, then as good as part of the ground."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pybullet
from numpy.typing import NDArray

from omega_turn_ros.robot import STANDARD_GRAVITY
from omega_turn_sim_bridge.terrain_config import TerrainConfig

Array = NDArray[np.float64]

CORNERS = 24  # of each rock before the hull is taken
SPREAD = 0.2  # standard deviation of the sizes, relative
FLATNESS = (1.0, 0.85, 0.65)  # axes of the mean rock, relative to each other
LAYERS = 3  # of loose grids dropped; little more than one once they lie
SETTLE_TIME = 4.0  # [s] given to the pile
SETTLE_STEP = 1.0 / 120.0  # [s]
ROCK_COLOURS = ((0.55, 0.52, 0.48, 1.0), (0.45, 0.44, 0.42, 1.0), (0.62, 0.58, 0.52, 1.0))


@dataclass(frozen=True, slots=True)
class RockPile:
    """Rocks at rest.

    Attributes:
        corners: of each rock about its centre of mass [m], each shape (CORNERS, 3).
        positions: of the centres in the world [m].
        orientations: quaternions x, y, z, w.
    """

    corners: tuple[tuple[tuple[float, float, float], ...], ...]
    positions: tuple[tuple[float, float, float], ...]
    orientations: tuple[tuple[float, float, float, float], ...]


@lru_cache(maxsize=4)
def settled_pile(size: float, extent: float, seed: int) -> RockPile:
    """Drop rocks layer by layer into a pen around the origin and let them come to rest.

    The physics of the pile runs in a client of its own, so the robot's starts clean.

    Args:
        size: mean diameter [m].
        extent: half the side of the pen [m].
        seed: of sizes, shapes and places.
    """
    rng = np.random.default_rng(seed)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0, 0, -STANDARD_GRAVITY, physicsClientId=client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=SETTLE_STEP, deterministicOverlappingPairs=1, physicsClientId=client
        )
        _build_pen(client, extent)
        corners, bodies = [], []
        for place in _drop_places(size, extent, rng):
            rock = _random_rock(size, rng)
            corners.append(rock)
            turn = rng.normal(size=4)
            bodies.append(_drop(client, rock, place, turn / np.linalg.norm(turn)))
        for _ in range(round(SETTLE_TIME / SETTLE_STEP)):
            pybullet.stepSimulation(physicsClientId=client)
        poses = [pybullet.getBasePositionAndOrientation(b, physicsClientId=client) for b in bodies]
    finally:
        pybullet.disconnect(physicsClientId=client)
    return RockPile(tuple(corners), tuple(p for p, _ in poses), tuple(q for _, q in poses))


def build_rocks(client: int, pile: RockPile, config: TerrainConfig, friction: float) -> list[int]:
    """Lay the pile into a physics client, immovable: a rock outweighs the robot many times.

    Args:
        client: PyBullet's physics client.
        pile: rocks at rest.
        config: friction.
        friction: coefficient set on the robot, by which PyBullet multiplies each rock's.

    Returns:
        PyBullet's ids of the rocks.
    """
    rocks = []
    for i, (corners, place, turn) in enumerate(
        zip(pile.corners, pile.positions, pile.orientations)
    ):
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_MESH, vertices=corners, physicsClientId=client
        )
        look = _visual_hull(client, corners, ROCK_COLOURS[i % len(ROCK_COLOURS)])
        rock = pybullet.createMultiBody(0.0, shape, look, place, turn, physicsClientId=client)
        own = config.rock_friction / friction if friction > 0.0 else 0.0
        pybullet.changeDynamics(rock, -1, lateralFriction=own, physicsClientId=client)
        rocks.append(rock)
    return rocks


def _random_rock(size: float, rng: np.random.Generator) -> tuple[tuple[float, float, float], ...]:
    """Corners of a convex rock: points on an ellipsoid of random size."""
    points = rng.normal(size=(CORNERS, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    axes = np.array(FLATNESS) / np.mean(FLATNESS)
    diameter = size * float(np.clip(rng.normal(1.0, SPREAD), 0.6, 1.4))
    points *= 0.5 * diameter * axes
    points -= points.mean(axis=0)
    return tuple((float(x), float(y), float(z)) for x, y, z in points)


def _drop_places(size: float, extent: float, rng: np.random.Generator) -> Array:
    """Centres of the rocks before they fall [m], shape (n, 3): jittered grids, one per layer."""
    per_side = max(1, math.floor(2.0 * extent / (1.15 * size)))
    grid = (np.arange(per_side) + 0.5) / per_side * 2.0 * extent - extent
    x, y = (a.ravel() for a in np.meshgrid(grid, grid))
    places = []
    for layer in range(LAYERS):
        jitter = rng.uniform(-0.1, 0.1, (2, x.size)) * size
        z = np.full(x.size, (0.8 + 1.3 * layer) * size)
        places.append(np.stack([x + jitter[0], y + jitter[1], z], axis=-1))
    return np.concatenate(places)


def _build_pen(client: int, extent: float) -> None:
    ground = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    pybullet.createMultiBody(0.0, ground, physicsClientId=client)
    for x, y in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        wall = pybullet.createCollisionShape(
            pybullet.GEOM_PLANE, planeNormal=(-x, -y, 0.0), physicsClientId=client
        )
        pybullet.createMultiBody(
            0.0, wall, -1, (x * extent, y * extent, 0), physicsClientId=client
        )


def _drop(client: int, corners: Sequence[Sequence[float]], place: Array, turn: Array) -> int:
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_MESH, vertices=corners, physicsClientId=client
    )
    rock = pybullet.createMultiBody(
        10.0, shape, -1, place.tolist(), turn.tolist(), physicsClientId=client
    )
    pybullet.changeDynamics(
        rock, -1, lateralFriction=0.8, rollingFriction=0.02, physicsClientId=client
    )
    return int(rock)


def _visual_hull(
    client: int, corners: Sequence[Sequence[float]], colour: tuple[float, float, float, float]
) -> int:
    """Shape for the camera: without faces PyBullet draws nothing."""
    from scipy.spatial import ConvexHull

    points = np.asarray(corners)
    hull = ConvexHull(points)
    faces = []
    for simplex, plane in zip(hull.simplices, hull.equations):
        a, b, c = points[simplex]
        outward = np.cross(b - a, c - a) @ plane[:3] > 0.0
        faces += simplex.tolist() if outward else simplex[::-1].tolist()
    return int(
        pybullet.createVisualShape(
            pybullet.GEOM_MESH,
            vertices=corners,
            indices=faces,
            rgbaColor=colour,
            physicsClientId=client,
        )
    )
