"""Turns end where they should, pause when they must, and yield to newer ones."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from rig import Rig

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.controller import SETTLE_TIME, GaitController
from omega_turn_ros.gaits.controller_state import Inputs, Mode
from omega_turn_ros.gaits.cycle_player import GATE_TIME
from omega_turn_ros.gaits.library import LibraryGait, load_gait
from omega_turn_ros.gaits.turn_plan import plan_turn
from omega_turn_ros.robot import Robot

MakeRig = Callable[..., Rig]
TOLERANCE = math.radians(1.0)  # the default heading tolerance
ANGLES = [1e-5, 0.02, -0.3, 1.0, 1.7, 3.3, -7.0]  # [rad]

# Interpolated tables are good for 0.05 deg per cycle at these scales, and the straight lines
# between 20 commands per second cut the corners of the path by about as much.
PER_CYCLE = math.radians(0.15)


def still(posture: np.ndarray, **other: object) -> Inputs:
    return Inputs(**{'positions': posture, 'fresh': True, **other})


@pytest.mark.parametrize('angle', ANGLES)
def test_open_loop_turn_takes_the_planned_cycles_and_the_ground_turns_the_body_by_it(
    make_rig: MakeRig, omega: LibraryGait, angle: float
) -> None:
    rig = make_rig()
    rig.ask(angle)
    assert rig.state.remaining == angle
    rig.finish()
    plan = plan_turn(angle, omega.calibration)
    assert rig.state.cycles == plan.cycles
    assert rig.balanced_heading() == pytest.approx(angle, abs=plan.cycles * PER_CYCLE)
    assert rig.state.remaining == 0.0
    assert (rig.posture == 0.0).all()
    assert rig.state.limited == 0


@pytest.fixture
def bent() -> LibraryGait:
    """A gait whose cycles start from a posture that is far from straight."""
    return load_gait('omega_60')


@pytest.fixture
def bending_rig(make_rig: MakeRig, bent: LibraryGait, robot: Robot) -> Rig:
    """A body that turns by 0.3 rad on the way into the cycle, and back on the way out."""
    bend = 0.3
    table = replace(bent.calibration, bend_heading=bend * bent.calibration.scales)
    rig = make_rig(gait=replace(bent, calibration=table))
    start = bent.gait.angles(table.start_phase, robot.n_yaw)
    assert np.abs(start).max() > 0.3
    rig.controller = GaitController(
        robot,
        rig.controller.gait,
        rig.controller.config,
        rig.controller.limits,
        lambda posture: -bend * float(posture @ start) / float(start @ start),
    )
    return rig


@pytest.mark.parametrize('angle', [1.0, -2.5, 4.6])
def test_bending_that_turns_the_body_is_reckoned_with(
    bending_rig: Rig, bent: LibraryGait, angle: float
) -> None:
    bending_rig.ask(angle)
    bending_rig.finish()
    assert bending_rig.state.cycles == plan_turn(angle, bent.calibration).cycles
    assert abs(bending_rig.state.shortfall) < 1e-4


def test_bending_is_reckoned_with_between_cycles_of_different_size(bending_rig: Rig) -> None:
    bending_rig.ask(3.0 * bending_rig.controller.gait.calibration.largest_angle)
    bending_rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 0.3)
    table, state = bending_rig.controller.gait.calibration, bending_rig.state
    rest = table.angle_of(state.scale) - table.heading_at(state.scale, state.turned)
    # rest of this cycle, unbent, and one and a half cycles more
    bending_rig.ask(rest - table.bend_heading_of(state.scale) + 1.5 * table.largest_angle)
    bending_rig.finish()
    assert bending_rig.state.cycles == 3
    assert abs(bending_rig.state.shortfall) < 1e-4


def test_every_shipped_gait_turns_by_the_angle_asked_for(
    make_rig: MakeRig, shipped: LibraryGait
) -> None:
    rig = make_rig(gait=shipped)
    rig.ask(-0.4)
    rig.finish()
    assert rig.balanced_heading() == pytest.approx(-0.4, abs=rig.state.cycles * PER_CYCLE)


@pytest.mark.parametrize('ground', [0.6, 1.0, 1.5])
@pytest.mark.parametrize('angle', [0.1, -1.2, 1.7, 5.0])
def test_feedback_ends_within_tolerance_on_ground_that_turns_otherwise_than_predicted(
    make_rig: MakeRig, ground: float, angle: float
) -> None:
    rig = make_rig(ground, heading_feedback=True)
    start = rig.heading
    rig.ask(angle)
    rig.finish()
    assert rig.heading - start == pytest.approx(angle, abs=TOLERANCE)
    assert abs(rig.state.shortfall) <= TOLERANCE
    assert rig.state.remaining == 0.0
    assert rig.state.heading.jumps == 0


def test_ratio_learned_on_a_large_turn_serves_the_next(make_rig: MakeRig) -> None:
    rig = make_rig(0.6, heading_feedback=True)
    rig.ask(7.0)
    rig.finish()
    assert rig.state.ground.usual == pytest.approx(0.6, abs=0.03)
    rig.ask(1.6)  # two cycles on this ground, one on the predicted
    rig.finish()
    assert rig.state.cycles == 2


def test_small_turn_teaches_nothing_about_large_ones(make_rig: MakeRig) -> None:
    rig = make_rig(0.6, heading_feedback=True)
    rig.ask(0.3)
    rig.finish()
    assert rig.state.ground.ratio < 0.9
    assert rig.state.ground.usual == 1.0


@pytest.mark.parametrize('short', [0.2, -0.2])
def test_overshoot_is_told_from_what_is_left_once_the_body_is_straight(
    make_rig: MakeRig, bent: LibraryGait, short: float
) -> None:
    """A gait that begins bent has, at the end of its cycle, still to unbend."""
    rig = make_rig(gait=bent, heading_feedback=True)
    table = bent.calibration
    assert abs(table.bend_heading_of(1.0)) > abs(short)
    rig.ask(table.largest_angle)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 0.3)
    goal = rig.state.goal
    assert goal is not None
    rig.state = replace(rig.state, goal=goal + short)
    rig.run_until(lambda state: state.cycles == 1)
    assert (rig.state.ground.share < 1.0) is (short < 0.0)


def test_heading_is_judged_once_the_robot_has_settled(make_rig: MakeRig) -> None:
    rig = make_rig(heading_feedback=True)
    rig.ask(0.5)
    rig.finish()
    straight = (rig.commands() == 0.0).all(axis=1)
    at_rest = len(straight) - np.flatnonzero(~straight)[-1] - 1
    assert at_rest * rig.dt >= SETTLE_TIME


def test_without_feedback_the_measured_heading_is_ignored(make_rig: MakeRig) -> None:
    deaf, sound = make_rig(0.3), make_rig(1.0)
    for rig in (deaf, sound):
        rig.ask(1.0)
        rig.finish()
    np.testing.assert_array_equal(deaf.commands(), sound.commands())


@pytest.mark.parametrize('ground', [0.0, -1.0])
def test_turn_on_ground_that_does_not_obey_is_given_up_and_says_by_how_much(
    make_rig: MakeRig, ground: float
) -> None:
    rig = make_rig(ground, heading_feedback=True, max_corrections=2)
    start = rig.heading
    rig.ask(1.0)
    rig.finish()
    assert rig.state.cycles == 3 * 1 + 2
    assert rig.state.shortfall == pytest.approx(1.0 - (rig.heading - start))
    assert rig.state.remaining == 0.0
    assert (rig.posture == 0.0).all()


def test_odometry_that_starts_anew_in_mid_turn_is_left_out(make_rig: MakeRig) -> None:
    rig = make_rig(heading_feedback=True)
    rig.ask(3.0)
    start = rig.heading
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 1.0)
    before = rig.heading - start
    rig.heading = start = 0.0
    rig.finish()
    assert rig.state.heading.jumps == 1
    assert before + rig.heading - start == pytest.approx(3.0, abs=TOLERANCE)


def test_gap_in_odometry_is_bridged_by_prediction(make_rig: MakeRig) -> None:
    rig = make_rig(0.8, heading_feedback=True)
    start = rig.heading
    rig.ask(1.5)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 1.0)
    rig.step(100, heading=None)
    rig.finish()
    assert rig.heading - start == pytest.approx(1.5, abs=TOLERANCE)
    assert rig.state.heading.jumps == 0


def test_nothing_is_commanded_before_the_first_joint_states(
    make_controller: Callable[..., GaitController],
) -> None:
    controller = make_controller()
    state = controller.initial_state()
    for _ in range(3):
        state, output = controller.step(state, Inputs(), 0.05)
        assert output is None
    assert state.mode is Mode.WAITING


def test_turn_asked_for_before_the_first_joint_states_is_done_after_them(
    make_controller: Callable[..., GaitController], make_rig: MakeRig
) -> None:
    rig = make_rig()
    controller = make_controller()
    rig.state = controller.request_turn(controller.initial_state(), 0.8)
    assert rig.state.remaining == 0.8
    rig.outputs.clear()
    rig.finish()
    assert rig.balanced_heading() == pytest.approx(0.8, abs=PER_CYCLE)


def test_first_command_is_the_measured_posture_and_the_turn_leaves_it_without_a_jump(
    make_rig: MakeRig, robot: Robot
) -> None:
    posture = np.random.default_rng(3).uniform(-0.8, 0.8, robot.n_joints)
    rig = make_rig(posture=posture)
    np.testing.assert_array_equal(rig.outputs[0].positions, posture)
    rig.ask(-1.0)
    rig.finish()
    # A minimum-jerk move covers at most 10 (dt/T)^3 of its way in the first step.
    first_step = np.abs(rig.outputs[1].positions - posture).max()
    assert first_step <= 10.0 * (rig.dt / 1.0) ** 3 * np.abs(posture).max()
    assert rig.state.limited == 0
    # Unbending turned the body too; the turn made that good.
    assert rig.balanced_heading() == pytest.approx(-1.0, abs=rig.state.cycles * PER_CYCLE)


def test_turn_uses_yaw_joints_only(make_rig: MakeRig, robot: Robot) -> None:
    rig = make_rig()
    rig.ask(1.0)
    rig.finish()
    pitch = np.delete(rig.commands(), robot.yaw_indices, axis=1)
    assert (pitch == 0.0).all()


@pytest.mark.parametrize('second', [-0.9, 0.4, 5.0])
@pytest.mark.parametrize('when', [0.5, 3.0, 6.0])  # [rad] of the cycle's phase
def test_newest_turn_wins_and_counts_from_the_heading_it_was_asked_at(
    make_rig: MakeRig, when: float, second: float
) -> None:
    rig = make_rig()
    rig.ask(4.0)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > when)
    since = len(rig.outputs) - 1
    rig.ask(second)
    assert rig.state.remaining == second
    if when < 6.0:  # what is left of the cycle under way leads towards 5 rad and past the others
        assert rig.state.mode is (Mode.CYCLING if second == 5.0 else Mode.MOVING)
    rig.finish()
    # Cycle left in the middle included: its unbending is integrated, not tabulated.
    cycles = rig.state.cycles + 1
    assert rig.balanced_heading(since) == pytest.approx(second, abs=cycles * PER_CYCLE)


def test_cycle_under_way_is_judged_whole_when_a_newer_turn_takes_it_over(
    make_rig: MakeRig,
) -> None:
    rig = make_rig(0.6, heading_feedback=True)
    rig.ask(6.0)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 3.0)
    rig.ask(5.0)
    assert rig.state.mode is Mode.CYCLING
    rig.run_until(lambda state: state.cycles == 1)
    assert rig.state.ground.usual == pytest.approx(0.8, abs=1e-3)  # half-way from 1 to 0.6


def test_turn_of_zero_ends_the_turn_at_once_and_goes_to_rest(make_rig: MakeRig) -> None:
    rig = make_rig()
    rig.ask(4.0)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 2.0)
    rig.ask(0.0)
    assert rig.state.remaining == 0.0
    rig.finish()
    assert rig.state.cycles == 0
    assert (rig.posture == 0.0).all()


def test_two_turns_add_up(make_rig: MakeRig) -> None:
    rig = make_rig()
    for angle in (0.7, -1.9):
        rig.ask(angle)
        rig.finish()
    assert rig.balanced_heading() == pytest.approx(0.7 - 1.9, abs=3 * PER_CYCLE)


@pytest.mark.parametrize('angle', [math.nan, math.inf, -math.inf])
def test_turn_that_is_not_finite_is_refused_by_name_and_changes_nothing(
    make_rig: MakeRig, angle: float
) -> None:
    rig = make_rig()
    rig.ask(1.0)
    with pytest.raises(BadInputError, match=r'^turn_angle: '):
        rig.ask(angle)
    assert rig.state.remaining == 1.0


def test_stop_freezes_the_command_until_reset_and_reset_moves_nothing(make_rig: MakeRig) -> None:
    rig = make_rig()
    rig.ask(2.0)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 2.0)
    frozen = rig.posture
    rig.state = rig.controller.stop(rig.state)
    assert rig.state.remaining == 0.0
    rig.step(40)
    with pytest.raises(BadInputError, match='stopped'):
        rig.ask(1.0)
    rig.state = rig.controller.reset(rig.state)
    rig.step(40)
    assert (rig.commands()[-80:] == frozen).all()
    assert rig.state.mode is Mode.HOLDING
    since = len(rig.outputs) - 1
    rig.ask(-0.5)
    rig.finish()
    assert rig.balanced_heading(since) == pytest.approx(-0.5, abs=2 * PER_CYCLE)


def test_reset_without_a_stop_does_not_disturb_the_turn(make_rig: MakeRig) -> None:
    rig = make_rig()
    rig.ask(2.0)
    rig.step(50)
    assert rig.controller.reset(rig.state) is rig.state


def test_stop_before_the_first_joint_states_is_kept(
    make_controller: Callable[..., GaitController], robot: Robot
) -> None:
    controller = make_controller()
    state = controller.stop(controller.initial_state())
    posture = np.full(robot.n_joints, 0.3)
    for _ in range(5):
        state, output = controller.step(state, still(posture), 0.05)
        np.testing.assert_array_equal(output.positions, posture)
    assert state.mode is Mode.STOPPED
    assert controller.reset(state).mode is Mode.HOLDING


@pytest.mark.parametrize('phase', [None, 2.0])  # during the first move, during the cycle
def test_stale_joint_states_pause_the_turn_and_fresh_ones_resume_it(
    make_rig: MakeRig, phase: float | None
) -> None:
    rig = make_rig()
    rig.ask(1.0)
    if phase is None:
        rig.step(4)
    else:
        rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > phase)
    at = rig.posture
    remaining = rig.state.remaining
    paused = rig.step(60, fresh=False)
    assert (rig.commands()[-60:] == at).all()
    assert paused.phase_rate == 0.0
    assert rig.state.remaining == remaining
    rig.finish()
    assert rig.balanced_heading() == pytest.approx(1.0, abs=PER_CYCLE)


def test_after_lost_joint_states_the_turn_waits_for_the_robot_but_not_for_ever(
    make_rig: MakeRig,
) -> None:
    rig = make_rig(catch_up_tolerance=0.1, catch_up_time=2.0)
    rig.ask(1.0)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 2.0)
    rig.step(fresh=False)
    at = rig.posture
    behind = at + 0.3
    waiting = round(2.0 / rig.dt) - 1
    for _ in range(waiting):
        rig.step(positions=behind)
    assert (rig.commands()[-waiting:] == at).all()
    rig.step(4, positions=behind)
    assert np.abs(rig.posture - at).max() > 0.0
    # and a robot that is back goes on without waiting
    rig.step(fresh=False)
    at = rig.posture
    rig.step(3)
    assert np.abs(rig.posture - at).max() > 0.0


def test_posture_that_jumps_while_fresh_does_not_move_the_command(make_rig: MakeRig) -> None:
    steady, shaken = make_rig(), make_rig()
    for rig in (steady, shaken):
        rig.ask(1.0)
    for k in range(300):
        steady.step()
        shaken.step(positions=shaken.posture + 0.4 * (-1) ** k)
    np.testing.assert_array_equal(steady.commands(), shaken.commands())


def test_offsets_enter_gently_stay_bounded_and_leave_at_rest(make_rig: MakeRig) -> None:
    nominal, yielding = make_rig(), make_rig(offset_limit=0.2, offset_rate=0.5)
    nominal.ask(0.5)
    yielding.ask(0.5)
    nominal.finish()
    yielding.finish(offsets=(5.0, -5.0))
    assert yielding.state.offsets == (0.2, -0.2)
    assert (yielding.posture == 0.0).all()
    assert yielding.state.cycles == 1
    difference = np.abs(yielding.commands() - nominal.commands()[: len(yielding.outputs)])
    assert 0.1 < difference.max() <= 0.4 + 1e-12  # two waves of 0.2 rad at most
    # Both rate limit and gate spread it over time: 0.2 rad in 0.4 s and a gate of 0.5 s.
    allowed = 2 * yielding.dt * (0.5 + 0.2 / GATE_TIME)
    assert np.diff(difference, axis=0).max() <= allowed + yielding.dt * 0.4


@pytest.mark.parametrize('angle', [0.02, 0.2])
def test_a_small_cycle_is_not_outgrown_by_its_offsets(make_rig: MakeRig, angle: float) -> None:
    nominal, yielding = make_rig(), make_rig(offset_limit=0.5, offset_rate=10.0)
    for rig, offsets in ((nominal, (0.0, 0.0)), (yielding, (0.5, 0.5))):
        rig.ask(angle)
        rig.finish(offsets=offsets)
    scale = nominal.state.scale
    assert 0.0 < scale < 0.8
    difference = np.abs(yielding.commands() - nominal.commands())
    assert 0.2 * scale < difference.max() <= 2 * 0.5 * scale + 1e-12


def test_offsets_wear_off_at_their_own_rate(make_rig: MakeRig) -> None:
    rig = make_rig(offset_limit=0.2, offset_rate=0.5)
    rig.step(8, offsets=(0.2, -0.2))  # 0.5 rad/s * 0.4 s
    assert rig.state.offsets == pytest.approx((0.2, -0.2))
    rig.step(4, offsets=(0.0, 0.0))
    assert rig.state.offsets == pytest.approx((0.1, -0.1))
    rig.step(4, offsets=(0.0, 0.0))
    assert rig.state.offsets == pytest.approx((0.0, 0.0), abs=1e-12)


def test_phases_given_out_are_those_of_the_posture(
    make_rig: MakeRig, omega: LibraryGait, robot: Robot
) -> None:
    rig = make_rig()
    rig.ask(omega.calibration.largest_angle)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 1.0)
    for _ in range(20):
        before = rig.outputs[-1].phase_turning
        output = rig.step()
        shape = omega.gait.angles(output.phase_turning, robot.n_yaw, rig.state.scale)
        np.testing.assert_allclose(output.positions[robot.yaw_indices], shape, atol=1e-12)
        assert output.phase_forward == pytest.approx(output.phase_turning - omega.gait.psi)
        assert output.phase_rate * rig.dt == pytest.approx(output.phase_turning - before)


def test_step_is_pure(make_rig: MakeRig) -> None:
    rig = make_rig()
    rig.ask(1.0)
    rig.step(60)
    state, inputs = rig.state, rig.inputs()
    command = state.command.copy()
    first = rig.controller.step(state, inputs, 0.05)
    second = rig.controller.step(state, inputs, 0.05)
    np.testing.assert_array_equal(first[1].positions, second[1].positions)
    assert first[0].heading == second[0].heading
    np.testing.assert_array_equal(state.command, command)


def test_commands_speed_up_and_slow_down_smoothly(make_rig: MakeRig) -> None:
    """No backward step where one motion hands over to the next."""
    rig = make_rig()
    rig.dt = 0.01
    rig.ask(2.0)
    rig.finish()
    velocity = np.array([output.velocities for output in rig.outputs])
    # Peak of the minimum-jerk law: 5.77 way/T^2 with T = 1.875 way/v, way > 0.6 rad, v = 1 rad/s;
    # of the cycle: peak rate times 2 pi/T over the ramp of 0.5 s.
    assert np.abs(np.diff(velocity, axis=0)).max() / rig.dt < 3.0


def test_slow_commands_need_no_more_cycles(make_rig: MakeRig) -> None:
    rig = make_rig()
    rig.dt = 0.2
    rig.ask(1.45)
    rig.finish()
    assert rig.state.cycles == 1


@pytest.mark.parametrize('name', ['geometric', 'omega'])
@pytest.mark.parametrize('angle', [1e9, -1e9])
def test_turn_of_centuries_starts_like_any_other_on_any_ground(
    make_rig: MakeRig, name: str, angle: float
) -> None:
    rig = make_rig(0.3, gait=load_gait(name), heading_feedback=True)
    rig.ask(angle)
    rig.step(500)
    assert rig.state.cycles >= 2
    assert 0.0 < abs(angle) - abs(rig.state.remaining) < 10.0
    rig.ask(0.0)
    rig.finish()
    assert rig.state.remaining == 0.0


@pytest.mark.parametrize('angle', [1.7e308, -1e10])
def test_turn_beyond_counting_is_refused_by_name(make_rig: MakeRig, angle: float) -> None:
    rig = make_rig()
    with pytest.raises(BadInputError, match=r'^turn_angle: '):
        rig.ask(angle)
    assert rig.state.goal is None
