"""Upright pegs, built in a physics client."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from omega_turn_sim_bridge.engine import pybullet
from omega_turn_sim_bridge.terrain_config import TerrainConfig

Array = NDArray[np.float64]

PEG_COLOUR = (0.75, 0.6, 0.35, 1.0)


def build_pegs(client: int, positions: Array, config: TerrainConfig, friction: float) -> list[int]:
    """Stand the pegs in the ground.

    Args:
        client: PyBullet's physics client.
        positions: axes [m], shape (n_pegs, 2).
        config: size and friction.
        friction: coefficient set on the robot, by which PyBullet multiplies each peg's.

    Returns:
        PyBullet's ids of the pegs.
    """
    size = {'radius': config.peg_radius, 'physicsClientId': client}
    # Round bodies on round pegs are the one pair Bullet solves in closed form.
    shape = pybullet.createCollisionShape(
        pybullet.GEOM_CAPSULE, height=2.0 * config.peg_height, **size
    )
    look = pybullet.createVisualShape(
        pybullet.GEOM_CYLINDER, length=config.peg_height, rgbaColor=PEG_COLOUR, **size
    )
    pegs = []
    for x, y in positions.tolist():
        peg = pybullet.createMultiBody(0.0, shape, look, (x, y, 0.0), physicsClientId=client)
        own = config.peg_friction / friction if friction > 0.0 else 0.0
        pybullet.changeDynamics(peg, -1, lateralFriction=own, physicsClientId=client)
        pegs.append(peg)
    return pegs
