"""Grounds the robot can stand on, built in a physics client."""

from __future__ import annotations

from dataclasses import dataclass

from omega_turn_ros.mechanics.force_laws import GranularResistance
from omega_turn_ros.robot import Robot
from omega_turn_sim_bridge.engine import pybullet
from omega_turn_sim_bridge.terrain_config import TerrainConfig


@dataclass(frozen=True, slots=True)
class Ground:
    """A built ground.

    Attributes:
        bodies: PyBullet's ids; the level ground first.
        carriers: those of them that carry the robot's weight.
        solid: bodies the robot needs to meet what lies there, see `urdf_from_robot`.
        top: height of the highest thing the straight robot can come to lie on [m].
        grains: what resists the links instead of friction under the feet.
    """

    bodies: tuple[int, ...]
    carriers: tuple[int, ...]
    solid: str = ''
    top: float = 0.0
    grains: GranularResistance | None = None


def build_ground(
    client: int, config: TerrainConfig, robot: Robot, friction: float, seed: int
) -> Ground:
    """Build a ground around a robot that lies straight along x, middle at the origin.

    Args:
        client: PyBullet's physics client.
        config: the ground.
        robot: that is going to lie on it.
        friction: coefficient set on the robot.
        seed: of random grounds; level ground has nothing random.

    Raises:
        BadInputError: the robot does not fit between the obstacles.
    """
    level = _level(client)
    if config.kind == 'pegboard':
        from omega_turn_sim_bridge.peg_lattice import peg_positions
        from omega_turn_sim_bridge.pegboard import build_pegs

        pegs = build_pegs(client, peg_positions(config, robot, seed), config, friction)
        return Ground((level, *pegs), (level,), solid='round')
    if config.kind == 'rocks':
        from omega_turn_sim_bridge.rocks import build_rocks, settled_pile

        size, extent = (x * robot.length for x in (config.rock_size_bl, config.extent_bl))
        pile = settled_pile(size, config.rock_fill, extent, seed)
        rocks = build_rocks(client, pile, config, friction)
        top = _top_under(client, robot)
        return Ground((level, *rocks), (level, *rocks), solid='square', top=top)
    if config.kind == 'granular':
        law = GranularResistance.of_ratio(config.resistance_ratio)
        return Ground((level,), (level,), grains=law)
    return Ground((level,), (level,))


def _level(client: int) -> int:
    """Level ground. PyBullet multiplies coefficients, so 1 here leaves the feet's own."""
    shape = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    ground = pybullet.createMultiBody(0.0, shape, physicsClientId=client)
    pybullet.changeDynamics(ground, -1, lateralFriction=1.0, physicsClientId=client)
    return int(ground)


RAY_FROM = 5.0  # [m] above anything that is built
HIT_POSITION = 3  # in the tuple PyBullet returns


def _top_under(client: int, robot: Robot) -> float:
    """Highest point under the straight robot [m], by rays a centimetre apart."""
    steps = round(robot.length / 0.01)
    xs = [(k / steps - 0.5) * robot.length for k in range(steps + 1)]
    ys = [0.5 * robot.module_width * side for side in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    feet = [(x, y, 0.0) for x in xs for y in ys]
    hits = pybullet.rayTestBatch(
        [(x, y, RAY_FROM) for x, y, _ in feet], feet, physicsClientId=client
    )
    return float(max(hit[HIT_POSITION][2] for hit in hits))
