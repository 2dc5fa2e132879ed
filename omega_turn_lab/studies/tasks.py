"""What a study computes: independent cases, each a value that any process can run.

A result is a plain JSON mapping, the same whether computed here, on a cluster or read from disk.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np

from omega_turn_lab.studies.areas import area_readings
from omega_turn_ros.design.calibrate import straightest_phase
from omega_turn_ros.design.catalogue import METHODS
from omega_turn_ros.design.direct import design_direct
from omega_turn_ros.design.problem import DesignProblem
from omega_turn_ros.gaits.library import KINDS
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_laws import CoulombFriction, ForceLaw
from omega_turn_ros.robot import Robot
from omega_turn_sim_bridge.terrain_config import TerrainConfig

Result = dict[str, Any]

SAMPLES = 720  # shapes per cycle a designed gait is judged on
AREA_SAMPLES = 100  # shapes per cycle for the swept area, as many as a physics trial keeps
QUASI_STATIC_CODE = (
    'omega_turn_ros.mechanics',
    'omega_turn_ros.design',
    'omega_turn_ros.gaits.two_wave',
    'omega_turn_ros.gaits.wave_gait',
    'omega_turn_ros.gaits.two_wave_gait',
    'omega_turn_ros.gaits.fourier_gait',
    'omega_turn_ros.robot',
    'omega_turn_lab.studies.tasks',
    'omega_turn_lab.studies.areas',
)
PHYSICS_CODE = (*QUASI_STATIC_CODE, 'omega_turn_sim_bridge', 'omega_turn_lab.physics_trial')


class Task(Protocol):
    """One case: hashable and picklable; `repr` tells all it depends on but the code."""

    code: ClassVar[tuple[str, ...]]

    def run(self) -> Result:
        """Compute it; the same result on every call."""


@dataclass(frozen=True, slots=True)
class DesignTask:
    """Design a gait and judge it on the ground it is designed for.

    Attributes:
        robot: the robot.
        k_f: spatial frequency of the forward wave.
        k_t: spatial frequency of the turning wave.
        theta_max_deg: joint angle limit [deg].
        seed: of the search.
        law: of the ground.
        area_limit: no larger area is swept [BL^2]; of the direct method only.
        method: of `omega_turn_ros.design.catalogue.METHODS`.
    """

    code: ClassVar[tuple[str, ...]] = QUASI_STATIC_CODE
    robot: Robot
    k_f: float
    k_t: float
    theta_max_deg: float
    seed: int
    law: ForceLaw = field(default_factory=CoulombFriction)
    area_limit: float = math.inf
    method: str = 'direct'

    def __str__(self) -> str:
        """Name the case."""
        return (
            f'{self.method} design for {self.robot.name}, k_f {self.k_f:g}, k_t {self.k_t:g}, '
            f'limit {self.theta_max_deg:g} deg, seed {self.seed}, {self.law}, '
            f'area up to {self.area_limit:g} BL^2'
        )

    @property
    def cost(self) -> float:
        """Time it takes, about, over that of a direct design."""
        return {'hierarchical': 1.5, 'fourier_1': 1.5, 'fourier_2': 2.2}.get(self.method, 1.0)

    @property
    def problem(self) -> DesignProblem:
        """What the search is given."""
        limit = min(math.radians(self.theta_max_deg), self.robot.position_limit)
        return DesignProblem.of_robot(self.robot, limit, self.k_f, self.k_t, self.law)

    def run(self) -> Result:
        """Return the gait's parameters, its angle per cycle [deg] and its swept areas [BL^2]."""
        problem = self.problem
        if self.method == 'direct':
            design = design_direct(problem, self.seed, area_limit=self.area_limit)
        else:
            design = METHODS[self.method](problem, self.seed)
        gait = design.gait
        start = straightest_phase(gait, self.robot.n_yaw)
        phases = start + np.linspace(0.0, 2.0 * np.pi, AREA_SAMPLES + 1)
        path = gait.angles(phases, self.robot.n_yaw)
        areas = area_readings(problem.chain, problem.width, path, problem.motion.pose_along(path))
        return {
            'kind': next(kind for kind, cls in KINDS.items() if isinstance(gait, cls)),
            'gait': gait.to_mapping(),
            'angle_deg': math.degrees(problem.turn(problem.path(gait, SAMPLES))),
            'areas': areas,
            'clearance': design.clearance,
            'evaluations': design.evaluations,
            'starts': design.starts,
            'tops': list(design.tops),
            'reason': design.reason,
        }


@dataclass(frozen=True, slots=True)
class PhysicsTask:
    """Play one cycle of a gait in PyBullet, open loop.

    Attributes:
        robot: the robot.
        gait: what it plays.
        period: of the cycle [s].
        terrain: the ground.
        friction: of the ground, see `SimulationConfig`.
    """

    code: ClassVar[tuple[str, ...]] = PHYSICS_CODE
    robot: Robot
    gait: WaveGait
    period: float = 10.0
    terrain: TerrainConfig = field(default_factory=TerrainConfig)
    friction: float = 0.5

    def __str__(self) -> str:
        """Name the case."""
        ground = f'{self.terrain}, friction {self.friction:g}'
        return f'PyBullet trial of {self.robot.name} on {ground}, {self.gait}'

    def run(self) -> Result:
        """Return the angle per cycle [deg], swept areas [BL^2] and the motion itself."""
        from omega_turn_lab.physics_trial import play_cycle
        from omega_turn_sim_bridge.simulation_config import SimulationConfig

        config = SimulationConfig(terrain=self.terrain, friction=self.friction)
        trial = play_cycle(self.robot, self.gait, self.period, config, AREA_SAMPLES)
        chain = PlanarChain.of_robot(self.robot)
        return {
            'angle_deg': math.degrees(trial.angle),
            'areas': area_readings(chain, self.robot.module_width, trial.yaw_angles, trial.poses),
            'fraction': trial.fraction.tolist(),
            'poses': trial.poses.round(6).tolist(),
            'yaw_angles': trial.yaw_angles.round(6).tolist(),
        }
