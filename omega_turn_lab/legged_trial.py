"""A few cycles of a robot with legs in PyBullet, open loop, to hold beside the model."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.robot import LeggedRobot

READING = 0.01  # [s] between two commands
STEP_IN = 1.5  # [s] from standing into the walking posture, with all that slips settled


@dataclass(frozen=True, slots=True)
class LeggedTrial:
    """A cycle of walking, then some that turn.

    Attributes:
        robot: the robot.
        gait: what it plays; the cycle before has no turning offset.
        period: of a cycle [s].
        friction: kinetic coefficient.
        static_friction: of a foot at rest; 0 is the kinetic one.
        cycles: that turn. No two slip alike, on ground that sticks least of all.
        samples: readings kept of the first of them; its first shape comes on top.
    """

    code: ClassVar[tuple[str, ...]] = (
        'omega_turn_ros.gaits.legged',
        'omega_turn_ros.robot',
        'omega_turn_sim_bridge',
        'omega_turn_lab.legged_trial',
    )
    robot: LeggedRobot
    gait: LeggedGait
    period: float = 6.0
    friction: float = 0.5
    static_friction: float = 0.0
    cycles: int = 4
    samples: int = 60

    def __post_init__(self) -> None:
        """Refuse no cycle, and more readings than the robot gives."""
        if self.cycles < 1:
            raise BadInputError('cycles', self.cycles, 'at least 1')
        if not 1 <= self.samples <= round(self.period / READING):
            raise BadInputError('samples', self.samples, f'1..{round(self.period / READING)}')

    def __str__(self) -> str:
        """Name the case."""
        return f'PyBullet trial of {self.robot.name}, {self.gait}'

    def run(self) -> dict[str, Any]:
        """Play all cycles.

        Returns:
            `angle_deg`, mean of the turning cycles, and each of them in `cycle_angles_deg`; of the
            first, `advance_bl` along its first heading [body lengths] and the motion: `fraction`
            of the cycle, `poses` x [m], y [m], heading [rad], `angles` of all joints [rad].
        """
        from omega_turn_sim_bridge.simulation import Simulation
        from omega_turn_sim_bridge.simulation_config import SimulationConfig

        config = SimulationConfig(friction=self.friction, static_friction=self.static_friction)
        steps = round(READING / config.time_step)
        readings = round(self.period / READING)
        kept = np.linspace(0, readings, self.samples + 1).round().astype(int)
        phases = 2.0 * np.pi * np.arange(readings + 1) / readings
        into = np.minimum(1.0, np.linspace(0.0, 1.5, round(STEP_IN / READING)))
        entry = into[:, None] * self.gait.angles(0.0, 0.0)
        seen = []
        with Simulation(self.robot, config) as simulation:

            def play(postures: np.ndarray) -> None:
                for posture in postures:
                    simulation.command(posture)
                    simulation.step(steps)

            play(entry)
            play(self.gait.angles(phases[1:], 0.0))
            turning = self.gait.angles(phases)
            for first, last in zip([0, *kept[:-1]], kept):
                play(turning[first + 1 : last + 1])
                seen.append(simulation.observe())
            headings = [seen[0].pose[2], seen[-1].pose[2]]
            for _ in range(self.cycles - 1):
                play(turning[1:])
                headings.append(simulation.observe().pose[2])
        poses = np.array([s.pose for s in seen])
        x, y, _ = poses[-1] - poses[0]
        turned = np.degrees(np.diff(headings))
        toward = poses[0, 2]
        return {
            'angle_deg': float(turned.mean()),
            'cycle_angles_deg': turned.round(6).tolist(),
            'advance_bl': (math.cos(toward) * x + math.sin(toward) * y) / self.robot.length,
            'fraction': (kept / readings).tolist(),
            'poses': poses.round(6).tolist(),
            'angles': np.array([s.positions for s in seen]).round(6).tolist(),
        }
