"""A pile of convex rocks: dropped, come to rest, then as good as part of the ground."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.robot import STANDARD_GRAVITY
from omega_turn_sim_bridge.engine import pybullet
from omega_turn_sim_bridge.terrain_config import TerrainConfig

Array = NDArray[np.float64]
Corners = tuple[tuple[float, float, float], ...]

CORNERS = 40  # of each rock before the hull is taken
SPREAD = 0.06  # standard deviation of the sizes, relative
FLATNESS = (1.05, 0.95, 0.5)  # axes of the mean rock over its diameter: rocks lie flat
PACKING = 1.15  # distance of neighbours before they fall, over the mean diameter: side by side
TILT = 0.15  # [rad] standard deviation of the slant they are dropped at
FILLINGS = 3  # layers of small stones poured over the rocks
AT_REST = 0.01  # [m/s] of the fastest, below which a layer lies still
LONGEST_FALL = 4.0  # [s] given to a layer
SETTLE_STEP = 1.0 / 120.0  # [s]
GLANCE = 0.25  # [s] between two looks at a falling layer
FALL_FRICTION = 0.3  # of falling rocks, low so that stones find the gaps
ROCK_COLOURS = ((0.55, 0.52, 0.48, 1.0), (0.45, 0.44, 0.42, 1.0), (0.62, 0.58, 0.52, 1.0))


@dataclass(frozen=True, slots=True)
class RockPile:
    """Rocks at rest.

    Attributes:
        corners: of each rock about its centre of mass [m], each shape (CORNERS, 3); the large
            rocks first, then the stones between them.
        positions: of the centres in the world [m].
        orientations: quaternions x, y, z, w.
    """

    corners: tuple[Corners, ...]
    positions: tuple[tuple[float, float, float], ...]
    orientations: tuple[tuple[float, float, float, float], ...]


@lru_cache(maxsize=4)
def settled_pile(size: float, fill: float, extent: float, seed: int) -> RockPile:
    """Drop rocks side by side into a pen around the origin, then stones into the gaps.

    Each layer lies still, or has had its time, before the next falls, and carries it. Stones that
    come to lie higher than the tops of the rocks are taken away before. The physics of the pile
    runs in a client of its own, so the robot's starts clean.

    Args:
        size: mean diameter of the rocks [m].
        fill: mean diameter of the stones over that of the rocks; 0 leaves the gaps open.
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
        laid = _lay(client, size, 0.0, extent, rng)
        level = float(np.median([_top(client, *rock) for rock in laid.items()]))
        for _ in range(FILLINGS if fill > 0.0 else 0):
            stones = _lay(client, fill * size, level, extent, rng)
            for stone, corners in stones.items():
                if _top(client, stone, corners) < level:
                    laid[stone] = corners
                else:
                    pybullet.removeBody(stone, physicsClientId=client)
        poses = [pybullet.getBasePositionAndOrientation(b, physicsClientId=client) for b in laid]
    finally:
        pybullet.disconnect(physicsClientId=client)
    return RockPile(tuple(laid.values()), tuple(p for p, _ in poses), tuple(q for _, q in poses))


def _lay(
    client: int, size: float, height: float, extent: float, rng: np.random.Generator
) -> dict[int, Corners]:
    """Drop one layer from above `height` [m] and fix it where it comes to rest."""
    layer: dict[int, Corners] = {}
    for x, y, z in _drop_places(size, extent, rng):
        rock = _random_rock(size, rng)
        layer[_drop(client, rock, (x, y, height + z), _random_turn(rng))] = rock
    for _ in range(round(LONGEST_FALL / GLANCE)):
        for _ in range(round(GLANCE / SETTLE_STEP)):
            pybullet.stepSimulation(physicsClientId=client)
        rates = [pybullet.getBaseVelocity(body, physicsClientId=client)[0] for body in layer]
        if np.linalg.norm(rates, axis=1).max() < AT_REST:
            break
    for body in layer:
        pybullet.changeDynamics(body, -1, mass=0.0, physicsClientId=client)
    return layer


def _top(client: int, body: int, corners: Corners) -> float:
    """Height of the highest corner [m]."""
    place, turn = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    up = np.array(pybullet.getMatrixFromQuaternion(turn)[6:])
    return float(place[2] + (np.array(corners) @ up).max())


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


def _random_rock(size: float, rng: np.random.Generator) -> Corners:
    """Corners of a convex rock: points on an ellipsoid of random size."""
    points = rng.normal(size=(CORNERS, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    diameter = size * float(np.clip(rng.normal(1.0, SPREAD), 0.7, 1.3))
    points *= 0.5 * diameter * np.array(FLATNESS)
    points -= points.mean(axis=0)
    return tuple((float(x), float(y), float(z)) for x, y, z in points)


def _drop_places(size: float, extent: float, rng: np.random.Generator) -> Array:
    """Centres of the rocks before they fall [m], shape (n, 3): a jittered hexagonal lattice.

    Neighbours start at three heights, so that they fall past each other and not into each other.
    """
    step = PACKING * size
    count = math.ceil(extent / step) + 1
    i, j = np.mgrid[-2 * count : 2 * count + 1, -2 * count : 2 * count + 1].reshape(2, -1)
    x, y = step * (i + 0.5 * j), step * math.sqrt(0.75) * j
    inside = (np.abs(x) < extent - 0.45 * size) & (np.abs(y) < extent - 0.45 * size)
    places = np.stack([x, y, size * (0.5 + 0.9 * ((i - j) % 3))], axis=-1)[inside]
    places[:, :2] += rng.uniform(-0.06, 0.06, (len(places), 2)) * size
    return places


def _random_turn(rng: np.random.Generator) -> tuple[float, float, float, float]:
    """Any way round, a little aslant: quaternion x, y, z, w."""
    roll, pitch = rng.normal(0.0, TILT, 2)
    yaw = rng.uniform(-math.pi, math.pi)
    x, y, z, w = pybullet.getQuaternionFromEuler((float(roll), float(pitch), float(yaw)))
    return x, y, z, w


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


def _drop(client: int, corners: Corners, place: Sequence[float], turn: Sequence[float]) -> int:
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_MESH, vertices=corners, physicsClientId=client
    )
    rock = pybullet.createMultiBody(
        10.0, shape, -1, place, turn, useMaximalCoordinates=1, physicsClientId=client
    )
    pybullet.changeDynamics(
        rock, -1, lateralFriction=FALL_FRICTION, rollingFriction=0.001, physicsClientId=client
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
