"""Grounds the robot can stand on. Each builds its bodies in a physics client."""

from __future__ import annotations

from collections.abc import Callable

from omega_turn_ros.errors import BadInputError
from omega_turn_sim_bridge.engine import pybullet


def _flat(client: int, seed: int) -> list[int]:
    """Level ground. PyBullet multiplies coefficients, so 1 here leaves the feet's own."""
    shape = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    ground = pybullet.createMultiBody(0.0, shape, physicsClientId=client)
    pybullet.changeDynamics(ground, -1, lateralFriction=1.0, physicsClientId=client)
    return [ground]


TERRAINS: dict[str, Callable[[int, int], list[int]]] = {'flat': _flat}


def build_terrain(client: int, name: str, seed: int) -> list[int]:
    """Build a ground.

    Args:
        client: PyBullet's physics client.
        name: one of `TERRAINS`.
        seed: of random terrains; level ground has nothing random.

    Returns:
        PyBullet's ids of the bodies that make the ground.

    Raises:
        BadInputError: there is no such terrain.
    """
    if name not in TERRAINS:
        raise BadInputError('terrain', name, f'one of {sorted(TERRAINS)}')
    return TERRAINS[name](client, seed)
