"""What a ground looks like from above, for pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.robot import Robot
from omega_turn_sim_bridge.terrain_config import TerrainConfig

Array = NDArray[np.float64]

ROUND = 24  # corners of a peg
GRAINS = 40.0  # dots per metre each way: a hint, spheres of 6 mm lie four times as dense
TILE = np.random.default_rng(0).uniform(0.0, 1.0, (64, 64, 2))  # where in its cell each dot lies


@dataclass(frozen=True, slots=True)
class GroundView:
    """A ground from above.

    Attributes:
        title: what a caption calls it, such as ' among pegs 0.3 BL apart'; '' for level ground.
        obstacles: outlines of what stands there [m], each shape (corners, 2).
        carries: whether the robot lies on them, not between them.
        grainy: whether the ground between them is grains.
    """

    title: str = ''
    obstacles: tuple[Array, ...] = ()
    carries: bool = False
    grainy: bool = False

    def grains(self, low: Array, high: Array) -> Array:
        """Scatter dots evenly over a rectangle, the same ones in every view.

        Args:
            low: its lower left corner [m], shape (2,).
            high: its upper right corner [m], shape (2,).

        Returns:
            Places [m], shape (n, 2); none where the ground is not grainy.
        """
        if not self.grainy:
            return np.zeros((0, 2))
        first, last = np.floor(low * GRAINS).astype(int), np.ceil(high * GRAINS).astype(int)
        i, j = np.mgrid[first[0] : last[0], first[1] : last[1]].reshape(2, -1)
        places: Array = (np.stack([i, j], axis=-1) + TILE[i % len(TILE), j % len(TILE)]) / GRAINS
        return places


LEVEL = GroundView()


def view_ground(terrain: TerrainConfig, robot: Robot, seed: int) -> GroundView:
    """Look at a ground that the bridge has built.

    Args:
        terrain: the ground.
        robot: that lies on it.
        seed: of the ground.

    Raises:
        BadInputError: the robot does not fit between the obstacles.
    """
    if terrain.kind == 'pegboard':
        from omega_turn_sim_bridge.peg_lattice import peg_positions

        bow = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
        circle = terrain.peg_radius * np.stack([np.cos(bow), np.sin(bow)], axis=-1)
        pegs = tuple(peg + circle for peg in peg_positions(terrain, robot, seed))
        return GroundView(f' among pegs {terrain.spacing_bl:g} BL apart', pegs)
    if terrain.kind == 'rocks':
        return GroundView(' on rocks', _rock_outlines(terrain, robot, seed), carries=True)
    if terrain.kind == 'granular':
        return GroundView(' on grains', grainy=True)
    return LEVEL


def _rock_outlines(terrain: TerrainConfig, robot: Robot, seed: int) -> tuple[Array, ...]:
    """Convex hulls of the rocks seen from above [m], lowest first."""
    from scipy.spatial import ConvexHull
    from scipy.spatial.transform import Rotation

    from omega_turn_sim_bridge.rocks import settled_pile

    size, extent = (x * robot.length for x in (terrain.rock_size_bl, terrain.extent_bl))
    pile = settled_pile(size, terrain.rock_fill, extent, seed)
    lying = [
        Rotation.from_quat(turn).apply(corners) + place
        for corners, place, turn in zip(pile.corners, pile.positions, pile.orientations)
    ]
    lying.sort(key=lambda corners: float(corners[:, 2].max()))
    return tuple(c[ConvexHull(c[:, :2]).vertices, :2] for c in lying)
