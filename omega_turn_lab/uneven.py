"""How firmly a body is held straight where the ground is not level."""

from __future__ import annotations

from omega_turn_ros.gaits.gait import Gait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_sim_bridge.terrain_config import TerrainConfig

# [N m] largest torque of pitch motors. A body held straight bridges two rocks and rolls over; at
# this torque three modules hang down, and the body lies on what is under it (own trials).
FOLLOWING = 0.6


def pitch_effort_on(terrain: TerrainConfig, gait: Gait) -> float:
    """Largest torque of the pitch motors [N m]; 0 leaves the robot its own.

    A gait that lifts the body needs all of it, and so does nobody on level ground.
    """
    return FOLLOWING if terrain.kind == 'rocks' and isinstance(gait, WaveGait) else 0.0
