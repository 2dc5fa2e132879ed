"""One turn of some cycles among obstacles in PyBullet, without ROS: open loop or compliant.

The same pure steps as the nodes take, in the order in which lock step takes them: the robot is
read, compliance answers the reading with the phases of the command before, the gait takes over the
offsets, the robot gets its command.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.studies.tasks import PHYSICS_CODE
from omega_turn_ros.compliance.controller import (
    ComplianceConfig,
    ComplianceController,
    ComplianceState,
)
from omega_turn_ros.compliance.external_torque import STILL
from omega_turn_ros.design.calibrate import make_library_gait
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.calibration import Calibration
from omega_turn_ros.gaits.controller import GaitController
from omega_turn_ros.gaits.controller_state import ControllerConfig, Inputs, Output
from omega_turn_ros.gaits.gait import Gait
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.posture import unbend_heading
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.robot import Robot
from omega_turn_sim_bridge.terrain_config import TerrainConfig

if TYPE_CHECKING:
    from omega_turn_sim_bridge.simulation import Simulation
    from omega_turn_sim_bridge.simulation_config import Observation

Array = NDArray[np.float64]
Result = dict[str, Any]

READING = 0.01  # [s] between two commands
STEP_LIMIT = 0.1  # [rad] between two commands, as the gait node's default
WAIT = 1.0  # [s] at rest before and after the turn
LONGEST = 3.0  # times the time the cycles take, after which the turn must have ended
DEPTH_EVERY = 5  # readings between two looks at contacts


@dataclass(frozen=True, slots=True)
class ObstacleTrial:
    """A turn of whole cycles at full scale on some ground.

    Attributes:
        robot: the robot.
        gait: what it plays.
        terrain: the ground.
        seed: of the ground.
        compliance: None is open loop. Its k_f and k_t are the gait's, whatever is given.
        cycles: how many.
        period: of a cycle [s].
        friction: between feet and level ground.
        pitch_effort: largest torque of the pitch motors [N m]; 0 takes the robot's.
        start_phase: at which cycles begin [rad]; a two-wave gait knows its own.
    """

    code: ClassVar[tuple[str, ...]] = (
        *PHYSICS_CODE,
        'omega_turn_ros.gaits',
        'omega_turn_ros.compliance',
        'omega_turn_lab.obstacle_trial',
        'omega_turn_lab.obstacle_log',
    )
    robot: Robot
    gait: Gait
    terrain: TerrainConfig = field(default_factory=TerrainConfig)
    seed: int = 0
    compliance: ComplianceConfig | None = None
    cycles: int = 2
    period: float = 10.0
    friction: float = 0.5
    pitch_effort: float = 0.0
    start_phase: float | None = None

    def __post_init__(self) -> None:
        """Refuse a turn of no cycle, and what does not go with the gait."""
        if self.cycles < 1:
            raise BadInputError('cycles', self.cycles, 'at least 1')
        if self.compliance is not None and not isinstance(self.gait, WaveGait):
            raise BadInputError('compliance', self.compliance, 'None: this gait has no amplitudes')
        if (self.start_phase is None) is not isinstance(self.gait, WaveGait):
            expected = 'a phase [rad], or None for a two-wave gait'
            raise BadInputError('start_phase', self.start_phase, expected)

    @property
    def waves(self) -> WaveGait:
        """The gait, where it is of two waves.

        Raises:
            BadInputError: it is of another kind.
        """
        if not isinstance(self.gait, WaveGait):
            raise BadInputError('gait', self.gait, 'a gait of two waves')
        return self.gait

    def __str__(self) -> str:
        """Name the case."""
        mode = 'open loop' if self.compliance is None else 'compliant'
        return f'{mode} trial on {self.terrain}, seed {self.seed}, {self.gait}'

    def run(self) -> Result:
        """Play the turn.

        Returns:
            `angle_deg` per cycle (mean), `cycle_angles_deg`, `total_deg`; `largest_effort` [N m];
            `largest_offsets` of (forward, turning) wave [rad]; `limits_broken`, commands and
            offsets outside their limits; `deepest_contact`, how far the body presses into
            obstacles [m]; `least_upright`, least cosine of the body's roll; `energy`, see
            `TrialLog`; and the motion: `time` [s], `poses` x [m], y [m], heading [rad],
            `yaw_angles` [rad] as they look from above.
        """
        from omega_turn_lab.obstacle_log import TrialLog
        from omega_turn_sim_bridge.simulation import Simulation
        from omega_turn_sim_bridge.simulation_config import SimulationConfig

        config = SimulationConfig(
            terrain=self.terrain,
            seed=self.seed,
            friction=self.friction,
            pitch_effort_limit=self.pitch_effort,
        )
        log = TrialLog(self)
        with Simulation(self.robot, config) as simulation:
            for seen, output, state, cycles in _readings(self, simulation):
                log.take(seen, output, state, cycles)
                if log.count % DEPTH_EVERY == 0:
                    log.depth = max(log.depth, simulation.obstacle_depth())
        return log.result()


def _gait_controller(trial: ObstacleTrial) -> GaitController:
    robot = trial.robot
    limits = JointLimits(robot.position_limit, robot.velocity_limit, STEP_LIMIT)
    config = ControllerConfig(period=trial.period)
    if not isinstance(trial.gait, WaveGait):
        return GaitController(robot, _counting_gait(trial), config, limits, lambda _: 0.0)
    gait = make_library_gait('trial', '', trial.gait, robot)
    chain = PlanarChain.of_robot(robot)
    if trial.compliance is not None:
        config = replace(config, offset_limit=trial.compliance.law.offset_limit)
    return GaitController(robot, gait, config, limits, lambda q: unbend_heading(chain, q))


def _counting_gait(trial: ObstacleTrial) -> LibraryGait:
    """Give any gait a table by which one cycle is one unit: open loop only counts them."""
    start = trial.start_phase or 0.0
    played = trial.gait.on(trial.robot)
    phases = start + np.linspace(0.0, 2.0 * np.pi, 721)
    path = np.array([played.at(p, 1.0, (0.0, 0.0)) for p in phases])
    peak = float(np.abs(np.diff(path, axis=0)).max() * 720 / (2.0 * np.pi))
    n = trial.gait.joints_of(trial.robot).size
    unit = np.array([[0.0, 0.0], [0.0, 1.0]])
    table = Calibration(start, np.array([0.0, 1.0]), unit, np.zeros(2), peak, n)
    return LibraryGait('trial', '', trial.robot.name, float(np.abs(path).max()), trial.gait, table)


def _compliance_controller(trial: ObstacleTrial) -> ComplianceController | None:
    if trial.compliance is None:
        return None
    config = replace(trial.compliance, k_f=trial.waves.k_f, k_t=trial.waves.k_t)
    chain = PlanarChain.of_robot(trial.robot)
    motion = QuasiStatic(chain)

    def needed(_: PlanarChain, angles: Array, rates: Array, friction: float) -> Array:
        if friction == 0.0 or np.abs(rates).max() < STILL:
            return np.zeros_like(angles)
        return motion.joint_torques(angles, rates, friction)

    return ComplianceController(chain, config, needed)


def _readings(
    trial: ObstacleTrial, simulation: Simulation
) -> Iterator[tuple[Observation, Output | None, ComplianceState | None, int]]:
    """Play the turn; yield each reading, the command that answers it, and the cycles done."""
    gait, law = _gait_controller(trial), _compliance_controller(trial)
    state = gait.initial_state()
    yielding = None if law is None else law.initial_state()
    steps = round(READING / simulation.config.time_step)
    yaw = trial.robot.yaw_indices
    output: Output | None = None
    wait = round(WAIT / READING)
    longest = round(LONGEST * trial.cycles * trial.period / READING)
    resting = 0
    for k in range(longest):
        seen = simulation.observe()
        if k == wait:
            angle = trial.cycles * gait.gait.calibration.largest_angle
            state = gait.request_turn(state, angle)
        if law is not None and yielding is not None:
            if output is not None and output.phase_rate > 0.0:
                joints = (seen.positions[yaw], seen.velocities[yaw], seen.efforts[yaw])
                phases = (output.phase_forward, output.phase_turning)
                yielding = law.step(yielding, *joints, phases, READING)
            else:
                yielding = law.relax(yielding, READING)
        offsets = (0.0, 0.0) if yielding is None else yielding.admittance.offset
        inputs = Inputs(seen.positions, True, None, offsets, upright=math.cos(seen.roll))
        state, output = gait.step(state, inputs, READING)
        yield seen, output, yielding, state.cycles
        if output is not None:
            simulation.command(output.positions)
        simulation.step(steps)
        resting = resting + 1 if k > wait and state.goal is None else 0
        if resting > wait:
            return
    raise BadInputError('trial', str(trial), f'a turn that ends within {longest * READING:g} s')
