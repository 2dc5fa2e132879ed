"""What a turn comes to by theory where the ground bears the body in patches only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from omega_turn_lab.studies.tasks import QUASI_STATIC_CODE, Result
from omega_turn_ros.design.calibrate import straightest_phase
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.patchy_ground import PatchyGround, headings_on_patches
from omega_turn_ros.robot import Robot

GROUNDS = 100
STEPS = 240  # shapes per cycle


@dataclass(frozen=True, slots=True)
class PatchesTask:
    """Two cycles of a gait, by force balance, on many level grounds that bear in patches.

    Attributes:
        robot: the robot.
        gait: what it plays.
        bearing: share of the ground that bears.
        spacing_bl: of the patches [BL].
        seed: of the grounds.
        cycles: how many.
    """

    code: ClassVar[tuple[str, ...]] = (*QUASI_STATIC_CODE, 'omega_turn_lab.studies.patches')
    robot: Robot
    gait: WaveGait
    bearing: float
    spacing_bl: float
    seed: int
    cycles: int = 2

    def __str__(self) -> str:
        """Name the case."""
        ground = f'patches {self.spacing_bl:g} BL apart that bear {self.bearing:g}'
        return f'turns of {self.robot.name} on {ground}, seed {self.seed}, {self.gait}'

    def run(self) -> Result:
        """Return `angles_deg`, per cycle, on each ground."""
        start = straightest_phase(self.gait, self.robot.n_yaw)
        phases = start + np.linspace(0.0, 2.0 * np.pi * self.cycles, self.cycles * STEPS + 1)
        path = self.gait.angles(phases, self.robot.n_yaw)
        spacing = self.spacing_bl * self.robot.length
        ground = PatchyGround(self.bearing, spacing, GROUNDS, self.seed)
        headings = headings_on_patches(PlanarChain.of_robot(self.robot), path, ground)
        return {'angles_deg': np.degrees(headings[-1] / self.cycles).tolist()}
