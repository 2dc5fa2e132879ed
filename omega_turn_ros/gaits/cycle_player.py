"""One cycle of a gait, step by step: its pace, what its waves yield, which side is up."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.gaits.controller_state import ControllerConfig, ControllerState
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]

SAME_SHAPE = 1e-4  # [rad] between start shapes: no move needed
SAME_SCALE = 0.05  # start postures this close are reached without a rest
GATE_TIME = 0.5  # [s] over which a cycle lets amplitude offsets in and, at its end, out again
ROLLED = 0.2  # cosine of roll from which a robot lies on the other side
ROLLING_TIME = 0.5  # [s] from one side's posture to straight


class CyclePlayer:
    """Plays cycles of one gait on one robot. Holds constants only.

    A robot of yaw and pitch joints on its back is seen from above as its mirror image, so there
    every joint of the gait is reversed; amplitude offsets, which come from efforts, stay what the
    joints feel.

    Args:
        gait: gait with its calibration.
        robot: that plays it.
        config: settings.
    """

    def __init__(self, gait: LibraryGait, robot: Robot, config: ControllerConfig) -> None:
        self.gait = gait
        self._played = gait.gait.on(robot)
        self._rate = 2.0 * math.pi / config.period
        self._acceleration = self._rate / config.phase_ramp_time

    def rest(self, side: float) -> Array:
        """Posture between turns [rad], shape (n_joints,), lying on a side (1 belly, -1 back)."""
        return side * self._played.rest

    def waypoint(self, side: float, posture: Array) -> Array | None:
        """Posture to pass between rest and a posture [rad], (n_joints,); None: straight there."""
        waypoint = self._played.waypoint(side * posture)
        return None if waypoint is None else side * waypoint

    def start(self, side: float, scale: float) -> Array:
        """Posture in which cycles of a scale begin and end [rad], shape (n_joints,)."""
        return self._posture(side, 0.0, scale, (0.0, 0.0))

    def starts_equally(self, scale: float, other: float) -> bool:
        """Whether cycles of two scales begin in the same posture."""
        return bool(np.abs(self.start(1.0, scale) - self.start(1.0, other)).max() < SAME_SHAPE)

    def starts_alike(self, scale: float, other: float) -> bool:
        """Whether cycles of two scales begin near enough to each other to go on without a rest."""
        return abs(scale - other) <= SAME_SCALE or self.starts_equally(scale, other)

    def advanced(
        self, state: ControllerState, share: float, goes_on: bool, dt: float
    ) -> tuple[dict[str, Any], Array, float]:
        """Play on for one step.

        Args:
            state: of the controller.
            share: wanted pace over that of the period.
            goes_on: the next cycle begins where this one ends, at no less than its pace.
            dt: [s], >= 0.

        Returns:
            Changes of the state, the wanted command [rad], shape (n_joints,), and the predicted
            heading change [rad].
        """
        rate = self._phase_rate(state, share * self._rate, goes_on, dt)
        turned = min(state.turned + rate * dt, 2.0 * math.pi)
        # The cycle ends in its own shape: unbending offsets would count as heading never turned.
        closing = (2.0 * math.pi - turned) / (self._rate * GATE_TIME)
        gate = min(state.gate + dt / GATE_TIME, closing, 1.0)
        table = self.gait.calibration
        predicted = table.heading_at(state.scale, turned) - table.heading_at(
            state.scale, state.turned
        )
        # A small cycle, such as a correction, must not be outgrown by what its waves yield.
        let_in = gate * min(abs(state.scale), 1.0)
        offsets = (let_in * state.offsets[0], let_in * state.offsets[1])
        side = self._side_now(state, dt) if share > 0.0 else state.side
        changes = {'turned': turned, 'phase_rate': rate, 'gate': gate, 'side': side}
        target = self._posture(side, turned, state.scale, offsets)
        return changes, target, predicted * state.ground.ratio

    def side(self, state: ControllerState) -> float:
        """Side to play on: 1 the belly, -1 the back; rocking about the edge changes nothing."""
        side = math.copysign(1.0, state.side)
        rolled = self.gait.gait.rolls and side * state.upright < -ROLLED
        return -side if rolled else side

    def _side_now(self, state: ControllerState, dt: float) -> float:
        """Go over to the other side's posture, past straight, once the robot has rolled."""
        side, reach = self.side(state), dt / ROLLING_TIME
        return min(max(side, state.side - reach), state.side + reach)

    def _phase_rate(
        self, state: ControllerState, wanted: float, goes_on: bool, dt: float
    ) -> float:
        change = self._acceleration * dt
        rate = min(max(wanted, state.phase_rate - change), state.phase_rate + change)
        if goes_on:
            return rate
        # The floor carries the phase over the end, where the braking law alone would creep.
        left = 2.0 * math.pi - state.turned
        floor = min(0.05 * self._rate, wanted)
        return min(rate, max(math.sqrt(2.0 * self._acceleration * left), floor))

    def _posture(
        self, side: float, turned: float, scale: float, offsets: tuple[float, float]
    ) -> Array:
        phase = self.gait.calibration.start_phase + turned
        forward, turning = offsets
        posture: Array = side * self._played.at(phase, scale, (side * forward, side * turning))
        return posture
