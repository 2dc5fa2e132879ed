"""What a study is, and what it is told and given."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.studies.rows import Row
from omega_turn_lab.studies.tasks import DesignTask, PhysicsTask, Result, Task
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import KINDS
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]

THETA_MAX_DEG = 90.0  # the paper's joint limit, K_F its forward wave
K_F = 1.5
K_STEP = 0.25


def k_grid(last: float) -> list[float]:
    """Spatial frequencies of the turning wave, 0 to `last` by a quarter."""
    return [K_STEP * i for i in range(round(last / K_STEP) + 1)]


@dataclass(frozen=True, slots=True)
class Plan:
    """What a study is told.

    Attributes:
        robot: the longest robot of the study.
        seed: of every search.
    """

    robot: Robot
    seed: int

    def design(
        self,
        k_t: float,
        *,
        k_f: float = K_F,
        theta_max_deg: float = THETA_MAX_DEG,
        n: int | None = None,
        **ground: object,
    ) -> DesignTask:
        """Design case of a robot with `n` yaw joints, all it has if not given."""
        robot = self.robot if n is None else self.robot.with_yaw_joints(n)
        return DesignTask(robot, k_f, k_t, theta_max_deg, self.seed, **ground)  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What was computed.

    Attributes:
        plan: what the studies were told.
        designed: result of each design case.
        played: result of each gait in PyBullet; empty without PyBullet.
        tried: result of each trial that studies ask for themselves; empty without PyBullet.
    """

    plan: Plan
    designed: dict[DesignTask, Result]
    played: dict[PhysicsTask, Result] = field(default_factory=dict)
    tried: dict[Task, Result] = field(default_factory=dict)

    def gait(self, task: DesignTask) -> WaveGait:
        """Return the designed gait."""
        found = self.designed[task]
        gait = KINDS[found['kind']].from_mapping(found['gait'])
        if not isinstance(gait, WaveGait):
            raise BadInputError('gait', found['kind'], 'a gait of two waves')
        return gait

    def physics(self, task: DesignTask) -> Result | None:
        """Return what its gait did in PyBullet."""
        return self.played.get(PhysicsTask(task.robot, self.gait(task)))

    def angles(self, task: DesignTask) -> tuple[float, float | None]:
        """Angle per cycle [deg] by force balance and in PyBullet."""
        physics = self.physics(task)
        return self.designed[task]['angle_deg'], None if physics is None else physics['angle_deg']


@dataclass(frozen=True, slots=True)
class Study:
    """One table or figure.

    Attributes:
        name: on the command line and of the files.
        title: above the table.
        designs: the gaits it needs.
        rows: its table.
        draw: its figures, into a folder.
        played: whether its gaits are played in PyBullet too.
        trials: further trials of the designed gaits in PyBullet.
        records: of these trials, for the JSON file.
    """

    name: str
    title: str
    designs: Callable[[Plan], Sequence[DesignTask]]
    rows: Callable[[Outcome], list[Row]]
    draw: Callable[[Outcome, Path], None]
    played: bool = True
    trials: Callable[[Outcome], Sequence[Task]] = lambda outcome: ()
    records: Callable[[Outcome], list[dict[str, Any]]] = lambda outcome: []
