"""What a trial among obstacles leaves behind: angles, efforts, limits, energy, motion."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.obstacle_trial import READING, STEP_LIMIT, ObstacleTrial, Result
from omega_turn_ros.compliance.admittance import stored_energy, wave_jacobian
from omega_turn_ros.compliance.controller import ComplianceConfig, ComplianceState
from omega_turn_ros.gaits.controller_state import Output
from omega_turn_sim_bridge.simulation_config import Observation

Array = NDArray[np.float64]

KEPT = 20  # shapes kept per cycle, for pictures


class TrialLog:
    """What a trial leaves behind.

    Args:
        trial: of which it tells.

    The energy balance is that of the law's storage function E = d' M d'/2 + d K d/2: in no step
    of a cycle may E grow by more than the work of the force scale J tau_ext on the offsets.
    Between cycles offsets relax at a given rate, not by the law.

    Attributes:
        count: readings taken in.
        depth: of the deepest contact seen [m], by whoever looks.
    """

    def __init__(self, trial: ObstacleTrial) -> None:
        self._trial = trial
        self._every = round(trial.period / READING / KEPT)
        self._headings: list[float] = []
        self._kept: list[Observation] = []
        self.count = self._cycles = 0
        self.depth = 0.0
        self._uprightness = 1.0
        self._effort = 0.0
        self._offset = np.zeros(2)
        self._broken = 0
        self._command: Array | None = None
        self._phases: tuple[float, float] | None = None
        self._energy = 0.0
        self._work = 0.0
        self._peak_energy = 0.0
        self._excess = 0.0

    def take(
        self,
        seen: Observation,
        output: Output | None,
        state: ComplianceState | None,
        cycles: int,
    ) -> None:
        """Take in one reading, the command that answers it, and how many cycles are done."""
        if not self._headings:
            self._headings = [float(seen.pose[2])]
        if cycles > self._cycles:
            self._headings.append(float(seen.pose[2]))
            self._cycles = cycles
        if self.count % self._every == 0:
            self._kept.append(seen)
        self.count += 1
        self._last = seen
        self._uprightness = min(self._uprightness, math.cos(seen.roll))
        self._effort = max(self._effort, float(np.abs(seen.efforts).max()))
        if state is not None and self._trial.compliance is not None:
            self._balance(state, self._trial.compliance)
        if output is not None:
            self._check_command(output.positions)
            playing = output.phase_rate > 0.0
            self._phases = (output.phase_forward, output.phase_turning) if playing else None

    def _check_command(self, command: Array) -> None:
        robot = self._trial.robot
        reach = min(robot.velocity_limit * READING, STEP_LIMIT) + 1e-9
        self._broken += int((np.abs(command) > robot.position_limit + 1e-9).any())
        if self._command is not None:
            self._broken += int((np.abs(command - self._command) > reach).any())
        self._command = command

    def _balance(self, state: ComplianceState, config: ComplianceConfig) -> None:
        offset, rate = (np.array(x) for x in (state.admittance.offset, state.admittance.rate))
        law = config.law
        self._offset = np.maximum(self._offset, np.abs(offset))
        self._broken += int((np.abs(offset) > law.offset_limit + 1e-9).any())
        self._broken += int((np.abs(rate) > law.rate_limit + 1e-9).any())
        energy = stored_energy(state.admittance, law)
        work = 0.0
        if self._phases is not None:
            gait = self._trial.waves
            jacobian = wave_jacobian(*self._phases, gait.k_f, gait.k_t, self._trial.robot.n_yaw)
            force = np.array(config.torque_scale) * (jacobian @ state.external)
            work = float(force @ rate) * READING
            self._excess = max(self._excess, energy - self._energy - work)
        self._work += work
        self._energy = energy
        self._peak_energy = max(self._peak_energy, energy)

    def result(self) -> Result:
        """Plain JSON, see `ObstacleTrial.run`."""
        # The last cycle ends where the robot rests after it.
        headings = np.degrees([*self._headings[:-1], self._last.pose[2]])
        yaw = self._trial.robot.yaw_indices
        turned = float(headings[-1] - headings[0])
        return {
            'angle_deg': turned / self._trial.cycles,
            'cycle_angles_deg': np.diff(headings).round(6).tolist(),
            'total_deg': turned,
            'largest_effort': self._effort,
            'largest_offsets': self._offset.round(6).tolist(),
            'limits_broken': self._broken,
            'deepest_contact': self.depth,
            'least_upright': self._uprightness,
            'energy': {
                'work': self._work,
                'peak': self._peak_energy,
                'largest_excess': self._excess,
            },
            'time': [round(seen.time, 6) for seen in self._kept],
            'poses': [seen.pose.round(6).tolist() for seen in self._kept],
            'yaw_angles': [_from_above(seen)[yaw].round(6).tolist() for seen in self._kept],
        }


def _from_above(seen: Observation) -> Array:
    """Joint angles as they look from above, whichever side is up [rad], shape (n_joints,)."""
    return math.copysign(1.0, math.cos(seen.roll)) * seen.positions
