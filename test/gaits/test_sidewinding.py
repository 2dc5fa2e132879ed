"""Sidewinding: two waves a quarter period apart, turned by the ratio of their frequencies."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from rig import Rig

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.controller import GaitController, shortest_period
from omega_turn_ros.gaits.controller_state import Mode
from omega_turn_ros.gaits.library import LibraryGait, gait_to_mapping, load_gait
from omega_turn_ros.gaits.sidewinding import Sidewinding
from omega_turn_ros.gaits.turn_plan import plan_turn
from omega_turn_ros.robot import Robot

GAIT = Sidewinding(1.25, 0.8, 0.2, 1.6)
NO_OFFSETS = (0.0, 0.0)
phases, scales = st.floats(-20.0, 20.0), st.floats(-1.0, 1.0)


@pytest.fixture(scope='module')
def entry() -> LibraryGait:
    return load_gait('sidewinding')


@settings(derandomize=True, deadline=None, max_examples=100)
@given(phases, scales)
def test_odd_joints_take_the_horizontal_and_even_ones_the_vertical_wave(
    robot: Robot, phase: float, scale: float
) -> None:
    posture = GAIT.on(robot).at(phase, scale, NO_OFFSETS)
    k_v = GAIT.k_h * (1.0 + 0.6 * abs(scale))
    side = 1.0 if scale >= 0.0 else -1.0
    for i in range(1, 9):  # joints 2 i - 1 and 2 i, the second half a yaw joint further back
        yaw = side * 0.8 * math.sin(phase + 2.0 * math.pi * GAIT.k_h * i / 8)
        pitch = 0.2 * math.sin(phase - 0.5 * math.pi + 2.0 * math.pi * k_v * (i + 0.5) / 8)
        assert posture[2 * i - 2] == pytest.approx(yaw, abs=1e-12)
        assert posture[2 * i - 1] == pytest.approx(pitch, abs=1e-12)


def test_a_whole_cycle_at_once_is_its_postures_one_by_one(robot: Robot) -> None:
    played = GAIT.on(robot)
    some = np.linspace(-3.0, 9.0, 40)
    for scale in (-0.7, 0.0, 1.0):
        one_by_one = [played.at(phase, scale, NO_OFFSETS) for phase in some]
        np.testing.assert_allclose(played.cycle(some, scale), one_by_one, rtol=0, atol=1e-14)


def test_amplitude_offsets_change_nothing(robot: Robot) -> None:
    played = GAIT.on(robot)
    np.testing.assert_array_equal(
        played.at(0.3, 0.5, NO_OFFSETS), played.at(0.3, 0.5, (0.4, -0.4))
    )
    assert not GAIT.complies


def test_the_negative_scale_is_the_mirror_image(robot: Robot) -> None:
    played = GAIT.on(robot)
    left, right = (played.at(1.0, scale, NO_OFFSETS) for scale in (0.6, -0.6))
    mirror = np.where(np.array(robot.joint_axes) == 'yaw', -1.0, 1.0)
    np.testing.assert_array_equal(left, mirror * right)


def test_waves_are_a_quarter_period_apart() -> None:
    horizontal, vertical = GAIT.wave_phases(2.0)
    assert horizontal - vertical == pytest.approx(0.5 * math.pi)


@pytest.mark.parametrize('field', Sidewinding.__slots__)
@pytest.mark.parametrize('value', [math.nan, math.inf, 'one', True, None])
def test_a_field_that_is_no_finite_number_is_refused_by_name(field: str, value: object) -> None:
    with pytest.raises(BadInputError, match=rf'^gait field {field}'):
        Sidewinding(**{**asdict(GAIT), field: value})


@pytest.mark.parametrize('field', ['k_h', 'a_v', 'turning_ratio'])
def test_a_wave_that_is_none_is_refused_by_name(field: str) -> None:
    with pytest.raises(BadInputError, match=rf'^gait field {field}.*> 0'):
        replace(GAIT, **{field: 0.0})


def test_a_robot_without_pitch_joints_is_refused_by_name(robot: Robot) -> None:
    flat = replace(robot, joint_axes=('yaw',) * robot.n_joints)
    with pytest.raises(BadInputError, match=r'^robot: .*pitch'):
        GAIT.on(flat)


def test_it_survives_its_file(entry: LibraryGait, tmp_path: Path) -> None:
    path = tmp_path / 'sidewinding.yaml'
    path.write_text(yaml.safe_dump(gait_to_mapping(entry)))
    again = load_gait(str(path))
    assert again.gait == entry.gait
    np.testing.assert_array_equal(again.calibration.heading, entry.calibration.heading)


def test_it_is_no_gait_whose_amplitudes_could_yield(entry: LibraryGait) -> None:
    with pytest.raises(BadInputError, match=r"^gait: got 'sidewinding'.*yield"):
        _ = entry.waves


def test_angle_rises_with_the_modulation_without_a_jump(entry: LibraryGait) -> None:
    table = entry.calibration
    assert table.heading[0, -1] == 0.0  # straight sidewinding does not turn
    # Where the robot tips, the angle steps by a degree: monotone up to that.
    assert np.abs(table.heading[:, -1] - table.angles).max() < math.radians(1.0)
    angles = np.array([table.angle_of(s) for s in np.linspace(-1.0, 1.0, 4001)])
    assert (np.diff(angles) >= 0.0).all()
    assert np.diff(angles).max() < math.radians(1.0)


@pytest.mark.parametrize('angle', [0.2, -1.3, 5.0])
def test_open_loop_turn_takes_the_planned_cycles_and_ends_flat(
    make_rig: Callable[..., Rig], entry: LibraryGait, angle: float
) -> None:
    rig = make_rig(gait=entry)
    rig.ask(angle)
    rig.finish()
    assert rig.state.cycles == plan_turn(angle, entry.calibration).cycles
    assert rig.state.remaining == 0.0 and rig.state.shortfall == pytest.approx(0.0, abs=1e-3)
    assert (rig.posture == 0.0).all()


def test_with_feedback_a_turn_ends_on_ground_that_turns_otherwise(
    make_rig: Callable[..., Rig], entry: LibraryGait
) -> None:
    rig = make_rig(0.8, gait=entry, heading_feedback=True)
    before = rig.heading
    rig.ask(0.5 * math.pi)
    rig.finish()
    assert rig.heading - before == pytest.approx(0.5 * math.pi, abs=math.radians(1.5))


def test_shortest_period_keeps_the_speed_limit_without_any_clipping(
    make_rig: Callable[..., Rig], entry: LibraryGait, robot: Robot
) -> None:
    rig = make_rig(gait=entry, period=1.001 * shortest_period(entry, robot.velocity_limit))
    rig.dt = 0.01
    rig.ask(entry.calibration.largest_angle)
    rig.finish()
    speeds = np.abs([output.velocities for output in rig.outputs])
    assert 0.95 * robot.velocity_limit < speeds.max() <= robot.velocity_limit
    assert rig.state.limited == 0


def test_a_stop_freezes_the_lifted_body_and_a_new_turn_follows_a_reset(
    make_rig: Callable[..., Rig], entry: LibraryGait
) -> None:
    rig = make_rig(gait=entry)
    rig.ask(1.0)
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 2.0)
    rig.state = rig.controller.stop(rig.state)
    held = rig.posture.copy()
    rig.step(20)
    assert (rig.posture == held).all() and np.abs(held[1::2]).max() > 0.05
    rig.state = rig.controller.reset(rig.state)
    rig.ask(-0.5)
    rig.finish()
    assert (rig.posture == 0.0).all()


def test_offsets_of_compliance_do_not_reach_it(
    make_controller: Callable[..., GaitController], entry: LibraryGait
) -> None:
    def commands(offsets: tuple[float, float]) -> np.ndarray:
        rig = Rig(make_controller(gait=entry), chain=None)  # type: ignore[arg-type]
        rig.ask(1.0)
        rig.step(150, offsets=offsets)
        return rig.commands()

    np.testing.assert_array_equal(commands(NO_OFFSETS), commands((0.3, 0.3)))
