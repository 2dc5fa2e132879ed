"""Nothing that can happen to the controller makes a command break a limit."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rig import Rig

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.controller import (
    LARGEST_TURN,
    NEGLIGIBLE_TURN,
    GaitController,
    shortest_period,
)
from omega_turn_ros.gaits.controller_state import ControllerState, Inputs, Mode
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.robot import Robot

ROUNDING = 1e-12  # [rad] of sums of angles below 4 rad
PERIOD = 5.0  # [s]
LIMITS = JointLimits(math.pi / 2, 3.0, 0.1)


@dataclass(frozen=True)
class Run:
    """Some steps under the same conditions."""

    count: int
    dt: float
    fresh: bool
    at_command: bool  # the robot stands at its last command, else at `posture`
    posture: float
    heading: float | None
    offsets: tuple[float, float]
    upright: float = 1.0


HEALTHY = Run(1, 0.05, True, True, 0.0, None, (0.0, 0.0))

offset = st.one_of(st.floats(-1.0, 1.0), st.sampled_from([1e300, -math.inf, math.nan]))
turn = st.one_of(
    st.floats(-10.0, 10.0), st.sampled_from([0.0, 1e-7, 1e9, -1e300, math.nan, math.inf])
)
run = st.builds(
    Run,
    count=st.sampled_from([80, 40, 3, 1]),
    dt=st.sampled_from([0.05, 0.05, 0.3, 0.01, 0.0, 1e-9, 2.5 * PERIOD]),
    fresh=st.sampled_from([True, True, True, False]),
    at_command=st.sampled_from([True, True, True, False]),
    posture=st.floats(-3.0, 3.0),
    heading=st.one_of(st.none(), st.floats(-math.pi, math.pi)),
    offsets=st.one_of(st.just((0.0, 0.0)), st.tuples(offset, offset)),
    upright=st.one_of(st.just(1.0), st.floats(-1.0, 1.0), st.just(math.nan)),
)
chapter = st.tuples(
    turn,
    st.lists(run, min_size=1, max_size=5),
    st.sampled_from([(), (), ('reset',), ('stop',), ('stop', 'reset')]),
)


class Watched:
    """Runs events through a controller and checks every command it gives."""

    def __init__(self, controller: GaitController) -> None:
        self.controller = controller
        self.state = controller.initial_state()
        self.must_hold = True  # no turn has been asked for since the start or the last stop

    def stop(self) -> None:
        self.state = self.controller.stop(self.state)
        self.must_hold = True
        assert self.state.remaining == 0.0

    def reset(self) -> None:
        self.state = self.controller.reset(self.state)
        assert self.state.mode is not Mode.STOPPED

    def turn(self, angle: float) -> None:
        before = self.state
        if not abs(angle) <= LARGEST_TURN or before.mode is Mode.STOPPED:
            with pytest.raises(BadInputError, match='turn_angle'):
                self.controller.request_turn(before, angle)
            return
        self.state = self.controller.request_turn(before, angle)
        assert self.state.remaining == (angle if abs(angle) >= NEGLIGIBLE_TURN else 0.0)
        self.must_hold = False

    def run(self, steps: Run) -> None:
        for _ in range(steps.count):
            self.step(steps)

    def step(self, now: Run) -> None:
        before = self.state
        posture = np.full(16, now.posture)
        if now.at_command and before.command is not None:
            posture = before.command
        inputs = Inputs(posture, now.fresh, now.heading, now.offsets, upright=now.upright)
        self.state, output = self.controller.step(before, inputs, now.dt)
        assert output is not None
        positions = output.positions
        assert np.isfinite(positions).all() and np.isfinite(output.velocities).all()
        assert math.isfinite(self.state.remaining)
        assert (np.abs(positions) <= LIMITS.position).all()
        if before.command is None:
            before = replace(before, command=np.clip(posture, -LIMITS.position, LIMITS.position))
        change = positions - before.command
        assert np.abs(change).max() <= min(LIMITS.velocity * now.dt, LIMITS.step) + ROUNDING
        np.testing.assert_allclose(output.velocities * now.dt, change, rtol=0, atol=ROUNDING)
        if self.must_hold or not now.fresh:
            assert (change == 0.0).all()
        if self.state.goal is None:
            assert self.state.remaining == 0.0
        assert 0.0 <= output.phase_rate <= 2.0 * math.pi / PERIOD + ROUNDING

    def settle(self) -> ControllerState:
        """Whatever happened: after a reset and a turn of 0 a healthy robot gets to rest."""
        self.reset()
        self.turn(0.0)
        for _ in range(400):
            if self.state.mode is Mode.HOLDING:
                break
            self.step(HEALTHY)
        return self.state


@pytest.mark.parametrize('feedback', [False, True])
@settings(derandomize=True, deadline=None, max_examples=40)
@given(story=st.lists(chapter, min_size=1, max_size=4))
def test_no_sequence_of_events_breaks_a_limit_or_the_stop(
    make_controller: Callable[..., GaitController],
    feedback: bool,
    story: list[tuple[float, list[Run], tuple[str, ...]]],
) -> None:
    controller = make_controller(limits=LIMITS, period=PERIOD, heading_feedback=feedback)
    watched = Watched(controller)
    for angle, runs, services in story:
        watched.turn(angle)
        for steps in runs:
            watched.run(steps)
        for service in services:
            getattr(watched, service)()
            watched.run(HEALTHY)
    state = watched.settle()
    assert state.mode is Mode.HOLDING
    assert (state.command == 0.0).all()
    assert state.remaining == 0.0


@settings(derandomize=True, deadline=None, max_examples=20)
@given(
    st.floats(-4.0, 4.0),
    st.lists(
        st.tuples(
            st.sampled_from([0.0, 0.01, 0.05, 0.3]),
            st.integers(1, 60),
            st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
        ),
        min_size=5,
        max_size=25,
    ),
)
def test_no_offset_and_no_uneven_clock_breaks_a_limit_during_a_turn(
    make_controller: Callable[..., GaitController],
    angle: float,
    spells: list[tuple[float, int, tuple[float, float]]],
) -> None:
    watched = Watched(make_controller(limits=LIMITS, period=PERIOD))
    watched.step(HEALTHY)
    watched.turn(angle)
    for dt, count, offsets in spells:
        watched.run(Run(count, dt, True, True, 0.0, None, offsets))


@pytest.mark.parametrize('dt', [0.005, 0.02])
def test_shortest_period_keeps_the_speed_limit_without_any_clipping(
    make_rig: Callable[..., Rig], shipped: LibraryGait, robot: Robot, dt: float
) -> None:
    rig = make_rig(gait=shipped, period=1.001 * shortest_period(shipped, robot.velocity_limit))
    rig.dt = dt
    rig.ask(shipped.calibration.largest_angle)
    rig.finish()
    speeds = np.abs([output.velocities for output in rig.outputs])
    assert speeds.max() <= robot.velocity_limit
    assert speeds.max() > 0.95 * robot.velocity_limit  # so the period really is the shortest
    assert rig.state.limited == 0


def test_shortest_period_is_inverse_to_the_speed_limit(omega: LibraryGait) -> None:
    assert shortest_period(omega, 6.0) == pytest.approx(0.5 * shortest_period(omega, 3.0))


def test_period_too_short_for_the_speed_limit_is_refused_naming_it(
    make_controller: Callable[..., GaitController], omega: LibraryGait
) -> None:
    with pytest.raises(BadInputError, match=r'^period: '):
        make_controller(period=0.99 * shortest_period(omega, 3.0))


def test_gait_wider_than_the_position_limit_is_refused_naming_it(
    make_controller: Callable[..., GaitController],
) -> None:
    with pytest.raises(BadInputError, match=r"^gait: got 'omega'"):
        make_controller(limits=JointLimits(1.4, 3.0, 0.1))


def test_gait_calibrated_for_another_number_of_joints_is_refused_naming_it(
    make_controller: Callable[..., GaitController], omega: LibraryGait
) -> None:
    other = replace(omega, calibration=replace(omega.calibration, n_joints=7))
    with pytest.raises(
        BadInputError, match=r"^gait: got 'omega', expected .* 8 yaw joints of limbless16, not 7"
    ):
        make_controller(gait=other)
