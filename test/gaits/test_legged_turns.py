"""The turning controller on ten legs: walk, turn, walk, on ground as the model has it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from omega_turn_ros.design.rest import heading_to_rest
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.controller import GaitController
from omega_turn_ros.gaits.controller_state import ControllerConfig, Inputs, Mode
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.mechanics.legged import LeggedMotion
from omega_turn_ros.robot import LeggedRobot, load_robot

DT = 0.02
PERIOD = 6.0


@pytest.fixture(scope='module')
def robot() -> LeggedRobot:
    robot = load_robot('legged10')
    assert isinstance(robot, LeggedRobot)
    return robot


class Ground:
    """A robot that goes where it is told, and the controller that tells it.

    Attributes:
        commands: all so far [rad], shape (n, 24).
        heading: of the robot [rad].
    """

    def __init__(self, robot: LeggedRobot, slips: float = 1.0, feedback: bool = True) -> None:
        gait = load_gait('legged')
        self.limits = JointLimits(robot.position_limit, robot.velocity_limit, 0.1)
        config = ControllerConfig(period=PERIOD, heading_feedback=feedback)
        rest = heading_to_rest(robot, gait.gait)
        self.controller = GaitController(robot, gait, config, self.limits, rest)
        self.motion = LeggedMotion(robot, 'static')
        self.state = self.controller.initial_state()
        self.posture, self.heading, self.slips = np.zeros(robot.n_joints), 0.0, slips
        self.commands = [self.posture]
        self.step()

    def step(self) -> None:
        inputs = Inputs(self.posture, True, self.heading, (0.0, 0.0))
        self.state, output = self.controller.step(self.state, inputs, DT)
        assert output is not None
        path = np.stack([self.posture, output.positions])
        self.heading += self.slips * self.motion.turn(path)
        self.posture = output.positions
        self.commands.append(self.posture)

    def turn(self, angle: float) -> float:
        """Ask for a turn and wait for its end; return how far the robot turned [rad]."""
        before = self.heading
        self.state = self.controller.request_turn(self.state, angle)
        for _ in range(round(300.0 / DT)):
            self.step()
            if self.state.goal is None and self.state.mode is Mode.HOLDING:
                return self.heading - before
        raise AssertionError('the turn does not end')


@pytest.mark.parametrize(('angle_deg', 'slips'), [(45.0, 1.0), (-30.0, 0.8)])
def test_turn_ends_where_it_should_on_other_ground_too(
    robot: LeggedRobot, angle_deg: float, slips: float
) -> None:
    turned = Ground(robot, slips).turn(math.radians(angle_deg))
    assert math.degrees(turned) == pytest.approx(angle_deg, abs=3.0)


def test_prediction_alone_comes_close(robot: LeggedRobot) -> None:
    """The calibration is the mean of both sides, which differ by some 5 %."""
    turned = Ground(robot, feedback=False).turn(math.radians(40.0))
    assert math.degrees(turned) == pytest.approx(40.0, rel=0.07)


def test_no_command_breaks_a_limit_and_legs_keep_stepping(robot: LeggedRobot) -> None:
    ground = Ground(robot)
    ground.turn(math.radians(20.0))
    commands = np.array(ground.commands)
    steps = np.abs(np.diff(commands, axis=0))
    assert np.abs(commands).max() <= robot.position_limit
    assert steps.max() <= min(ground.limits.step, ground.limits.velocity * DT)
    assert ground.state.limited == 0  # nothing had to be cut
    swing = commands[:, np.array(robot.joint_axes) == 'swing']
    assert (np.ptp(swing, axis=0) > math.radians(55.0)).all()


def test_cycles_of_any_scale_begin_and_end_in_the_posture_of_rest(robot: LeggedRobot) -> None:
    played = load_gait('legged').gait.on(robot)
    for scale in (-1.0, 0.0, 0.3, 1.0):
        np.testing.assert_allclose(played.at(0.0, scale, (0.0, 0.0)), played.rest, atol=1e-12)
        np.testing.assert_allclose(
            played.at(2.0 * math.pi, scale, (0.0, 0.0)), played.rest, atol=1e-9
        )


def test_legs_and_gaits_that_do_not_belong_together_are_refused(robot: LeggedRobot) -> None:
    with pytest.raises(BadInputError, match='leg pairs'):
        load_gait('legged').gait.on(load_robot('limbless16'))
    omega = load_gait('omega')
    with pytest.raises(BadInputError, match='gait'):
        GaitController(
            robot,
            omega,
            ControllerConfig(),
            JointLimits(2.0, 3.0, 0.1),
            lambda posture: 0.0,
        )


def test_calibration_rises_with_a_3_and_begins_at_0(robot: LeggedRobot) -> None:
    table = load_gait('legged').calibration
    assert table.start_phase == 0.0 and table.n_joints == robot.n_joints
    assert table.angles[0] == 0.0 and (np.diff(table.angles) > 0.0).all()
    np.testing.assert_array_equal(table.bend_heading, 0.0)
    assert math.degrees(table.largest_angle) == pytest.approx(11.7, abs=0.3)
