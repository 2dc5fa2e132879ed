"""The turning controller as one pure step: (state, inputs, dt) -> (state, command).

A turn is a chain of two kinds of motion. A *move* runs straight through joint space with a
minimum-jerk time law; a *cycle* plays one period of the gait. From rest: move to the gait's start
shape, whole cycles, move back to rest. Every move's speed is bounded by its duration and every
cycle's by its period, so limits hold by construction; `limit_command` enforces them once more.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.controller_state import (
    ControllerConfig,
    ControllerState,
    Inputs,
    Mode,
    Output,
)
from omega_turn_ros.gaits.cycle_player import SAME_SHAPE, CyclePlayer
from omega_turn_ros.gaits.drive import Drive, Pace, pace_of
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.limits import JointLimits, limit_command
from omega_turn_ros.gaits.move import Move, move_between, move_through
from omega_turn_ros.gaits.turn_plan import plan_turn
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]

AT_REST = 1e-3  # [rad] from the rest shape: nothing to unbend
NEAR = 0.1  # [rad] a move this short passes no waypoint
NEGLIGIBLE_TURN = 1e-6  # [rad]
LARGEST_TURN = 1e9  # [rad] two centuries of turning; doubles still resolve its progress
SETTLE_TIME = 0.3  # [s] the robot lags its command before the heading is judged
JUDGED_FROM = 0.005  # [rad] predicted; a smaller cycle says nothing


class GaitController:
    """Plays turns of one gait on one robot. Holds constants only; the state is passed through.

    Args:
        robot: joint names, axes and limits.
        gait: gait with its calibration.
        config: settings.
        limits: of every command.
        unbend_heading: heading change [rad] of going to rest, along a straight line in joint
            space, from a posture of the joints the gait moves [rad], shape (N,).

    Raises:
        BadInputError: the gait does not fit the robot or its limits.
    """

    def __init__(
        self,
        robot: Robot,
        gait: LibraryGait,
        config: ControllerConfig,
        limits: JointLimits,
        unbend_heading: Callable[[Array], float],
    ) -> None:
        self._joints = gait.gait.joints_of(robot)
        n = self._joints.size
        if gait.calibration.n_joints != n:
            moved = f'{n} {gait.gait.moves}'
            count = f'{moved} of {robot.name}, not {gait.calibration.n_joints}'
            own = 'omega_turn design --all --robot ... makes its own'
            raise BadInputError('gait', gait.name, f'one for the {count}: {own}')
        if gait.theta_max > limits.position + 1e-9:
            raise BadInputError('gait', gait.name, f'joint angles within {limits.position} rad')
        self.robot, self.gait, self.config, self.limits = robot, gait, config, limits
        self._unbend_heading = unbend_heading
        self._player = CyclePlayer(gait, robot, config)
        # Without feedback the prediction closes exactly; what is left is rounding.
        self._tolerance = config.heading_tolerance if config.heading_feedback else 1e-3
        shortest = shortest_period(gait, limits.velocity)
        if config.period < shortest:
            raise BadInputError('period', config.period, f'at least {shortest:.3g} s')

    def initial_state(self) -> ControllerState:
        """State before the first joint states arrive."""
        return ControllerState()

    def request_turn(self, state: ControllerState, angle: float) -> ControllerState:
        """Take over a new turn, relative to the present heading; 0 ends the turn.

        Raises:
            BadInputError: the angle is not finite or too large, or the controller is stopped.
        """
        if not abs(angle) <= LARGEST_TURN:  # also catches NaN
            expected = f'a finite angle within +-{LARGEST_TURN:g} rad'
            raise BadInputError('turn_angle', angle, expected)
        if state.mode is Mode.STOPPED:
            raise BadInputError('turn_angle', angle, 'no command while stopped: call reset first')
        goal = None if abs(angle) < NEGLIGIBLE_TURN else angle
        budget = 3 * plan_turn(angle, self.gait.calibration).cycles + self.config.max_corrections
        state = replace(
            state,
            goal=goal,
            heading=state.heading.restarted(),
            ground=state.ground.restarted(),
            cycle_start=state.cycle_start - state.heading.progress,
            cycles=0,
            budget=budget,
            shortfall=0.0,
        )
        if state.mode is Mode.WAITING:
            return state
        if state.mode is Mode.CYCLING and goal is not None and self._helps(state, goal):
            return state
        if state.mode is Mode.MOVING and not state.to_cycle:
            return state  # already on the way to rest, where the new turn is planned
        return self._move_to_rest(state)

    def request_drive(self, state: ControllerState, drive: Drive) -> ControllerState:
        """Take over a velocity, which counts while there is no turn.

        The pace follows within `phase_ramp_time`, the turning rate with the next cycle. Nothing
        wanted holds the posture of the moment.

        Raises:
            BadInputError: the controller is stopped.
        """
        if state.mode is Mode.STOPPED:
            raise BadInputError('cmd_vel', drive, 'no command while stopped: call reset first')
        return replace(state, drive=drive)

    def pace(self, state: ControllerState) -> Pace:
        """Pace of the cycles: full in a turn, else that of the velocity wanted."""
        if state.goal is not None:
            return Pace(1.0, state.scale)
        return pace_of(state.drive, self.gait, self.config.period)

    def stop(self, state: ControllerState) -> ControllerState:
        """Freeze the command where it is and drop the turn; latched until `reset`."""
        return replace(
            state, mode=Mode.STOPPED, goal=None, move=None, phase_rate=0.0, drive=Drive()
        )

    def reset(self, state: ControllerState) -> ControllerState:
        """Leave the stop. Moves nothing: the posture is held until the next turn."""
        if state.mode is not Mode.STOPPED:
            return state
        return replace(state, mode=Mode.WAITING if state.command is None else Mode.HOLDING)

    def step(
        self, state: ControllerState, inputs: Inputs, dt: float
    ) -> tuple[ControllerState, Output | None]:
        """Advance by dt [s] >= 0. Returns no output until joint states have been seen."""
        if state.command is None:
            if inputs.positions is None:
                return state, None
            state = self._start(state, inputs.positions)
        state = self._take_offsets(state, inputs.offsets, dt)
        state, running = self._check_robot(state, inputs, dt)
        # One `replace` for all: copying the state is a good part of what a step costs.
        changes: dict[str, Any] = {}
        previous = target = self._known(state)
        predicted = 0.0
        if running and state.mode is Mode.MOVING and state.move is not None:
            changes['move'], predicted = state.move.advanced(dt)
            target = changes['move'].position
        elif running and state.mode is Mode.CYCLING:
            share, goes_on = self.pace(state).share, self._goes_on(state)
            changes, target, predicted = self._player.advanced(state, share, goes_on, dt)
            if inputs.effort > 0.0:
                changes['jam'] = state.jam.advanced(inputs.effort, self.robot.effort_limit, dt)
        elif state.mode is Mode.CYCLING:
            changes['phase_rate'] = 0.0
        measured = inputs.heading if self.config.heading_feedback else None
        changes['heading'] = state.heading.advanced(predicted, measured)
        command, limited = limit_command(previous, target, dt, self.limits)
        changes |= {'upright': inputs.upright, 'limited': state.limited + limited}
        state = replace(state, **changes, command=command)
        output = self._output(state, previous, dt)
        if running:
            state = self._next_motion(state, dt)
        return state, output

    def _start(self, state: ControllerState, positions: Array) -> ControllerState:
        limit = self.limits.position
        state = replace(state, command=np.clip(positions, -limit, limit))
        if state.mode is Mode.STOPPED:
            return state
        state = replace(state, mode=Mode.HOLDING)
        return state if state.goal is None else self._move_to_rest(state)

    def _take_offsets(
        self, state: ControllerState, wanted: tuple[float, float], dt: float
    ) -> ControllerState:
        if not self.gait.gait.complies:
            return state
        if wanted == state.offsets or any(math.isnan(w) for w in wanted):
            return state
        limit, reach = self.config.offset_limit, self.config.offset_rate * dt
        f, t = (
            old + min(max(min(max(new, -limit), limit) - old, -reach), reach)
            for old, new in zip(state.offsets, wanted)
        )
        return replace(state, offsets=(f, t))

    def _check_robot(
        self, state: ControllerState, inputs: Inputs, dt: float
    ) -> tuple[ControllerState, bool]:
        """Pause while joint states are stale, and until the robot is back at the command."""
        if not inputs.fresh or inputs.positions is None:
            return replace(state, catching_up=0.0), False
        if state.catching_up is None:
            return state, True
        waited = state.catching_up + dt
        error = float(np.abs(inputs.positions - self._known(state)).max())
        if error <= self.config.catch_up_tolerance or waited >= self.config.catch_up_time:
            return replace(state, catching_up=None), True
        return replace(state, catching_up=waited), False

    def _drives(self, state: ControllerState) -> bool:
        return state.goal is None and self.pace(state).share > 0.0

    def _goes_on(self, state: ControllerState) -> bool:
        """Whether the next cycle begins where this one ends, at no less than its pace."""
        if state.goal is not None:
            return False
        pace = self.pace(state)
        alike = self._player.starts_equally(pace.scale, state.scale)
        return pace.share > 0.0 and alike and self._stays(state)

    def _stays(self, state: ControllerState) -> bool:
        """Whether the robot still lies on the side that the cycle is played on."""
        return self._player.side(state) == state.side

    def _next_motion(self, state: ControllerState, dt: float) -> ControllerState:
        """Go from one motion to the next where one has ended."""
        if state.mode is Mode.MOVING and (state.move is None or state.move.done):
            if state.to_cycle:
                return replace(
                    state,
                    mode=Mode.CYCLING,
                    turned=0.0,
                    phase_rate=0.0,
                    gate=0.0,
                    cycle_start=state.heading.progress,
                )
            settled = state.settling + dt
            if state.cycles and self.config.heading_feedback and settled < SETTLE_TIME:
                return replace(state, settling=settled)
            return self._plan_from_rest(replace(state, mode=Mode.HOLDING, move=None))
        if state.mode is Mode.CYCLING and state.turned >= 2.0 * math.pi:
            return self._end_cycle(state)
        if state.mode is Mode.HOLDING and self._drives(state):
            return self._move_to_rest(state)
        return state

    def _plan_from_rest(self, state: ControllerState) -> ControllerState:
        if state.goal is None:
            pace = self.pace(state)
            return self._move_to_start(state, pace.scale, 0.0) if pace.share else state
        close = abs(state.remaining) <= self._tolerance
        if state.cycles and (close or state.cycles >= state.budget):
            return replace(state, goal=None, shortfall=state.remaining)
        scale = plan_turn(state.remaining, self.gait.calibration, state.ground.planned).scale
        return self._move_to_start(state, scale, 0.0)

    def _end_cycle(self, state: ControllerState) -> ControllerState:
        """Judge the cycle, then choose the next one or the way back to rest."""
        bend = self.gait.calibration.bend_heading_of(state.scale)
        if state.goal is None:
            pace = self.pace(state)
            return (
                self._go_on(state, pace.scale, bend) if pace.share else self._move_to_rest(state)
            )
        rest = state.remaining + bend
        state = self._judge_cycle(state, rest)
        if abs(rest) <= self._tolerance or state.cycles >= state.budget:
            return self._move_to_rest(state)
        plan = plan_turn(rest, self.gait.calibration, state.ground.planned)
        return self._go_on(state, plan.scale, bend)

    def _go_on(self, state: ControllerState, scale: float, bend: float) -> ControllerState:
        """Go from one cycle to the next, through rest where the gait must."""
        alike = self._player.starts_alike(scale, state.scale) and self._stays(state)
        if not self.gait.gait.scales_size and not alike:
            return self._move_to_rest(state)  # and plan again from there
        return self._move_to_start(state, scale, bend)

    def _judge_cycle(self, state: ControllerState, rest: float) -> ControllerState:
        """Compare the angle of the cycle with the prediction; `rest` is still to turn [rad]."""
        state = replace(state, cycles=state.cycles + 1)
        predicted = self.gait.calibration.angle_of(state.scale)
        if not self.config.heading_feedback or abs(predicted) < JUDGED_FROM:
            return state
        measured = state.heading.progress - state.cycle_start
        state = replace(state, jam=state.jam.judged(measured, predicted, self.config.period))
        firm = self.gait.gait.scales_size  # others turn little by less than their least scale
        ground = state.ground.judged(measured, predicted, rest, firm)
        return replace(state, ground=ground)

    def _move_to_start(
        self, state: ControllerState, scale: float, bend_now: float
    ) -> ControllerState:
        """Move along one line in shape space to the start shape at `scale`."""
        state = replace(state, side=self._player.side(state))
        target = self._player.start(state.side, scale)
        bend = self.gait.calibration.bend_heading_of(scale) - bend_now
        command = self._known(state)
        if np.abs(target - command).max() < SAME_SHAPE:
            return replace(
                state,
                mode=Mode.CYCLING,
                scale=scale,
                turned=0.0,
                cycle_start=state.heading.progress,
            )
        move = self._plan_move(command, target, self._player.waypoint(state.side, target), bend)
        return replace(
            state, mode=Mode.MOVING, move=move, to_cycle=True, scale=scale, phase_rate=0.0
        )

    def _move_to_rest(self, state: ControllerState) -> ControllerState:
        command = self._known(state)
        heading_change = 0.0
        side = math.copysign(1.0, state.side)
        rest = self._player.rest(side)
        ended = state.mode is Mode.CYCLING and state.turned >= 2.0 * math.pi
        if ended and not self.gait.gait.scales_size:
            heading_change = -self.gait.calibration.bend_heading_of(state.scale)  # at no cost
        elif np.abs((command - rest)[self._joints]).max() > AT_REST:
            heading_change = self._unbend_heading(side * command[self._joints])
        move = self._plan_move(command, rest, self._player.waypoint(side, command), heading_change)
        return replace(
            state, mode=Mode.MOVING, move=move, to_cycle=False, phase_rate=0.0, settling=0.0
        )

    def _plan_move(self, start: Array, end: Array, waypoint: Array | None, bend: float) -> Move:
        velocity = self._move_velocity()
        near = np.abs(end - start).max() < NEAR
        if waypoint is None or near:
            return move_between(start, end, velocity, bend)
        return move_through(start, waypoint, end, velocity, bend)

    def _helps(self, state: ControllerState, goal: float) -> bool:
        """Whether finishing the cycle under way leads towards the new goal, not past it."""
        table = self.gait.calibration
        rest = table.angle_of(state.scale) - table.heading_at(state.scale, state.turned)
        rest = rest * state.ground.ratio - table.bend_heading_of(state.scale)
        return 0.0 <= rest / goal <= 1.0

    def _move_velocity(self) -> float:
        return min(self.config.move_velocity, 0.9 * self.limits.velocity)

    def _known(self, state: ControllerState) -> Array:
        if state.command is None:
            raise BadInputError('command', None, 'joint states before any motion')
        return state.command

    def _output(self, state: ControllerState, previous: Array, dt: float) -> Output:
        command = self._known(state)
        velocity = (command - previous) / dt if dt > 0.0 else np.zeros_like(command)
        cycling = state.mode is Mode.CYCLING
        phase = self.gait.calibration.start_phase + (state.turned if cycling else 0.0)
        tau_f, tau_t = self.gait.gait.wave_phases(phase)
        rate = state.phase_rate if cycling else 0.0
        return Output(command, velocity, tau_f, tau_t, rate)


def shortest_period(gait: LibraryGait, velocity_limit: float) -> float:
    """Shortest cycle whose peak joint speed keeps the limit [s], for a limit in [rad/s]."""
    return 2.0 * math.pi * gait.calibration.peak_rate / velocity_limit
