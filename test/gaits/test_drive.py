"""Driving by velocity: pace, turning rate, and no limit broken between walking and turning."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from rig import Rig

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.controller import GaitController
from omega_turn_ros.gaits.controller_state import ControllerConfig, Inputs, Mode
from omega_turn_ros.gaits.drive import Drive, pace_of
from omega_turn_ros.gaits.library import LibraryGait, load_gait
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.robot import load_robot

MakeRig = Callable[..., Rig]
PERIOD, DT = 6.0, 0.02
LEGGED = load_gait('legged')


class Walker:
    """A ten-legged robot that takes every posture commanded, and a check of each command."""

    def __init__(self) -> None:
        robot = load_robot('legged10')
        self.limits = JointLimits(robot.position_limit, robot.velocity_limit, 0.2)
        config = ControllerConfig(period=PERIOD)
        self.controller = GaitController(robot, LEGGED, config, self.limits, lambda q: 0.0)
        self.state, self.posture = self.controller.initial_state(), np.zeros(robot.n_joints)
        self.run(0.1)

    def drive(self, linear: float, angular: float) -> None:
        self.state = self.controller.request_drive(self.state, Drive(linear, angular))

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / DT)):
            inputs = Inputs(self.posture, True)
            self.state, output = self.controller.step(self.state, inputs, DT)
            assert output is not None
            reach = min(self.limits.velocity * DT, self.limits.step) + 1e-9
            assert np.abs(output.positions - self.posture).max() <= reach
            assert np.abs(output.positions).max() <= self.limits.position + 1e-9
            self.posture = output.positions


@pytest.mark.parametrize('gait', [load_gait('omega'), LEGGED], ids=lambda g: g.name)
@pytest.mark.parametrize('share', [-0.9, -0.3, 0.5])
def test_a_turning_rate_becomes_the_angle_of_each_cycle(gait: LibraryGait, share: float) -> None:
    angular = share * gait.calibration.largest_angle / PERIOD
    pace = pace_of(Drive(0.0, angular), gait, PERIOD)
    turned = gait.calibration.angle_of(pace.scale) * pace.share / PERIOD
    assert turned == pytest.approx(angular, rel=1e-3)


def test_walking_at_half_speed_takes_half_the_pace_and_turns_at_the_same_rate() -> None:
    speed = 0.5 * LEGGED.advance / PERIOD
    angular = 0.4 * LEGGED.calibration.largest_angle / PERIOD
    pace = pace_of(Drive(speed, angular), LEGGED, PERIOD)
    assert pace.share == pytest.approx(0.5)
    turned = LEGGED.calibration.angle_of(pace.scale) * pace.share / PERIOD
    assert turned == pytest.approx(angular, rel=1e-3)


def test_what_is_too_fast_is_cut() -> None:
    pace = pace_of(Drive(1e6, -1e6), LEGGED, PERIOD)
    assert (pace.share, pace.scale) == (1.0, -1.0)


@pytest.mark.parametrize(
    ('linear', 'angular', 'field'),
    [(-0.1, 0.0, 'linear.x'), (math.nan, 0.0, 'linear.x'), (0.0, math.inf, 'angular.z')],
)
def test_a_velocity_no_gait_can_do_is_refused(linear: float, angular: float, field: str) -> None:
    with pytest.raises(BadInputError, match=field):
        Drive(linear, angular)


def test_walking_goes_on_without_a_pause_between_strides() -> None:
    walker = Walker()
    walker.drive(1.0, 0.0)
    walker.run(2.0)
    rates = []
    for _ in range(round(2.5 * PERIOD / DT)):
        walker.run(DT)
        rates.append(walker.state.phase_rate)
    assert min(rates) == pytest.approx(2.0 * math.pi / PERIOD)
    assert walker.state.goal is None and walker.state.remaining == 0.0


def test_walk_turn_walk_keeps_every_limit_and_comes_back_to_walking() -> None:
    walker = Walker()
    walker.drive(1.0, 0.0)
    walker.run(1.4 * PERIOD)
    angle = 1.5 * LEGGED.calibration.largest_angle
    walker.state = walker.controller.request_turn(walker.state, angle)
    walker.run(1.0)
    assert walker.state.goal == angle
    walker.run(5.0 * PERIOD)
    assert walker.state.goal is None and walker.state.shortfall == pytest.approx(0.0, abs=1e-3)
    assert walker.state.mode is Mode.CYCLING  # walking again
    walker.drive(1.0, -0.05)
    walker.run(2.0 * PERIOD)
    assert walker.state.scale < 0.0


def test_nothing_wanted_holds_the_posture_of_the_moment_and_goes_on_from_there() -> None:
    walker = Walker()
    walker.drive(1.0, 0.0)
    walker.run(1.3 * PERIOD)
    walker.drive(0.0, 0.0)
    walker.run(1.0)
    held = walker.posture
    walker.run(3.0)
    np.testing.assert_array_equal(walker.posture, held)
    assert np.abs(held).max() > 0.1
    walker.drive(1.0, 0.0)
    walker.run(1.0)
    assert np.abs(walker.posture - held).max() > 0.01


def test_a_limbless_robot_turns_at_the_rate_asked_for(make_rig: MakeRig) -> None:
    rig = make_rig()
    period = rig.controller.config.period
    angular = 0.6 * rig.controller.gait.calibration.largest_angle / period
    rig.state = rig.controller.request_drive(rig.state, Drive(0.0, angular))
    before = rig.heading
    rig.run_until(lambda state: state.mode is Mode.CYCLING)
    rig.step(round(4.0 * period / rig.dt))
    turned = (rig.heading - before) / (4.0 * angular * period)
    assert turned == pytest.approx(1.0, abs=0.35)  # ends within a cycle, and cycles brake
    rig.state = rig.controller.stop(rig.state)
    with pytest.raises(BadInputError, match='reset'):
        rig.controller.request_drive(rig.state, Drive(0.0, 0.1))
