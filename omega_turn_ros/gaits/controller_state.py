"""What the turning controller is told, remembers and says: plain frozen data."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.gaits.drive import Drive
from omega_turn_ros.gaits.ground_response import GroundResponse
from omega_turn_ros.gaits.heading import HeadingTracker
from omega_turn_ros.gaits.jam import JamWatch
from omega_turn_ros.gaits.move import Move

Array = NDArray[np.float64]


class Mode(enum.Enum):
    """What the controller is doing."""

    WAITING = 'waiting for joint_states'
    HOLDING = 'holding'
    MOVING = 'moving'
    CYCLING = 'cycling'
    STOPPED = 'stopped'


@dataclass(frozen=True, slots=True)
class ControllerConfig:
    """Settings of the controller.

    Attributes:
        period: duration of one gait cycle [s].
        move_velocity: peak joint speed of moves [rad/s].
        phase_ramp_time: the gait phase reaches its full rate in this time [s].
        heading_feedback: use measured heading to re-plan after each cycle.
        heading_tolerance: with feedback, a turn ends within this of its goal [rad].
        max_corrections: with feedback, a turn may take three times its planned cycles and this
            many more before it is given up.
        offset_limit: largest amplitude offset accepted from compliance [rad].
        offset_rate: largest rate of the amplitude offsets [rad/s].
        catch_up_tolerance: after joint states were lost the robot must be this close to the
            command before the turn goes on [rad].
        catch_up_time: ... or this much time must have passed [s].
    """

    period: float = 10.0
    move_velocity: float = 1.0
    phase_ramp_time: float = 0.5
    heading_feedback: bool = False
    heading_tolerance: float = math.radians(1.0)
    max_corrections: int = 10
    offset_limit: float = 0.5
    offset_rate: float = 1.0
    catch_up_tolerance: float = 0.1
    catch_up_time: float = 3.0


@dataclass(frozen=True, slots=True)
class Inputs:
    """What the controller may know at one step.

    Attributes:
        positions: measured joint positions [rad], shape (n_joints,); None before the first.
        fresh: the positions are recent enough to act on.
        heading: measured heading [rad], any branch; None when there is none or it is stale.
        offsets: wanted offsets of (A_f, A_t) [rad]; (0, 0) when there are none.
        effort: largest |effort| of any joint [N m]; 0 where it is not measured.
        upright: cosine of the body's tilt: 1 lying on its belly, -1 on its back.
    """

    positions: Array | None = None
    fresh: bool = False
    heading: float | None = None
    offsets: tuple[float, float] = (0.0, 0.0)
    effort: float = 0.0
    upright: float = 1.0


@dataclass(frozen=True, slots=True)
class ControllerState:
    """Everything the controller remembers; made by `GaitController.initial_state`.

    Attributes:
        mode: what it is doing.
        command: last command [rad], shape (n_joints,); None before the first joint states.
        goal: wanted turn since it was accepted [rad]; None when there is no turn.
        heading: progress of the turn, measured or predicted.
        move: the move under way.
        to_cycle: the move under way ends in a cycle, not at rest.
        scale: signed amplitude scale of the cycle.
        turned: phase since the start of the cycle [rad].
        phase_rate: [rad/s].
        gate: how much of the amplitude offsets the cycle lets in, 0..1.
        offsets: amplitude offsets in force [rad].
        cycle_start: progress at the start of the cycle [rad].
        ground: how much it turns the robot.
        cycles: cycles completed in this turn.
        budget: cycles after which the turn is given up.
        shortfall: angle the last turn left unturned when it ended [rad].
        settling: time at rest since the last move [s].
        catching_up: time since joint states came back [s]; None in normal running.
        limited: commands changed by a limit so far.
        jam: whether the robot is stuck.
        drive: wanted velocity while there is no turn.
        upright: the input of that name.
        side: factor on all joints: 1 on the belly, -1 on the back, in between on the way.
    """

    mode: Mode = Mode.WAITING
    command: Array | None = None
    goal: float | None = None
    heading: HeadingTracker = field(default_factory=HeadingTracker)
    move: Move | None = None
    to_cycle: bool = False
    scale: float = 0.0
    turned: float = 0.0
    phase_rate: float = 0.0
    gate: float = 0.0
    offsets: tuple[float, float] = (0.0, 0.0)
    cycle_start: float = 0.0
    ground: GroundResponse = field(default_factory=GroundResponse)
    cycles: int = 0
    budget: int = 0
    shortfall: float = 0.0
    settling: float = 0.0
    catching_up: float | None = None
    limited: int = 0
    jam: JamWatch = field(default_factory=JamWatch)
    drive: Drive = field(default_factory=Drive)
    upright: float = 1.0
    side: float = 1.0

    @property
    def remaining(self) -> float:
        """Angle still to turn [rad]; exactly 0.0 when there is no turn."""
        return 0.0 if self.goal is None else self.goal - self.heading.progress


@dataclass(frozen=True, slots=True)
class Output:
    """One command.

    Attributes:
        positions: [rad], shape (n_joints,).
        velocities: [rad/s], shape (n_joints,).
        phase_forward: tau_f [rad].
        phase_turning: tau_t [rad].
        phase_rate: d tau/dt of both waves [rad/s]; 0 when no cycle is being played.
    """

    positions: Array
    velocities: Array
    phase_forward: float
    phase_turning: float
    phase_rate: float
