"""What a robot needs where the ground is not level: bodies that give, and patience."""

from __future__ import annotations

import math
from typing import Any

from omega_turn_ros.gaits.gait import Gait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_sim_bridge.terrain_config import TerrainConfig

# [N m] largest torque of pitch motors: the body, which held straight would bridge the rocks and
# roll, gives a little to the weight it carries, and does not sag into every gap (own trials).
FOLLOWING = 2.0


def pitch_effort_on(terrain: TerrainConfig, gait: Gait) -> float:
    """Largest torque of the pitch motors [N m]; 0 leaves the robot its own.

    A gait that lifts the body needs all of it, and so does nobody on level ground.
    """
    return FOLLOWING if terrain.kind == 'rocks' and isinstance(gait, WaveGait) else 0.0


# Among obstacles a cycle turns by more or less as chance will have it, some 20 deg on rocks (own
# trials), so it takes many to come near, and there is no sense in the last degree.
PATIENCE = 30  # extra cycles
NEAR_ENOUGH = math.radians(4.0)


def feedback_on(terrain: TerrainConfig) -> dict[str, Any]:
    """Parameters of the gait node for turns with heading feedback on a ground."""
    if terrain.kind == 'rocks':
        return {'max_corrections': PATIENCE, 'heading_tolerance': NEAR_ENOUGH}
    return {'max_corrections': PATIENCE} if terrain.kind == 'pegboard' else {}
