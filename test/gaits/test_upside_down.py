"""A robot that has rolled over plays on, mirrored."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from rig import Rig

from omega_turn_ros.gaits.controller_state import ControllerConfig, ControllerState, Mode
from omega_turn_ros.gaits.cycle_player import CyclePlayer
from omega_turn_ros.gaits.drive import Drive
from omega_turn_ros.gaits.library import LibraryGait, load_gait
from omega_turn_ros.robot import load_robot

MakeRig = Callable[..., Rig]
OFFSETS = (0.2, -0.1)


def played(rig: Rig, angle: float, **inputs: object) -> np.ndarray:
    """Commands of a turn, shape (T, n_joints)."""
    since = len(rig.outputs)
    rig.ask(angle)
    rig.finish(**inputs)
    return rig.commands(since)


def test_on_its_back_a_robot_turns_with_every_joint_reversed(
    make_rig: MakeRig, shipped: LibraryGait
) -> None:
    on_belly = played(make_rig(gait=shipped), 0.7)
    on_back = played(make_rig(gait=shipped), 0.7, upright=-1.0)
    np.testing.assert_allclose(on_back, -on_belly, atol=1e-12)


@pytest.mark.parametrize('angle', [0.7, -2.0])
def test_heading_is_predicted_as_seen_from_above_either_way_up(
    make_rig: MakeRig, angle: float
) -> None:
    rig = make_rig()
    played(rig, angle, upright=-1.0)
    assert rig.heading - 3.0 == pytest.approx(angle, abs=1e-3)
    assert abs(rig.state.shortfall) < 1e-3


def test_what_joints_yield_is_not_reversed(make_rig: MakeRig) -> None:
    """Offsets come from efforts, which are the joints' own."""
    stiff = played(make_rig(), 0.5)
    yielded = played(make_rig(), 0.5, offsets=OFFSETS) - stiff
    on_back = played(make_rig(), 0.5, offsets=OFFSETS, upright=-1.0) + stiff
    assert np.abs(yielded).max() > 0.1
    np.testing.assert_allclose(on_back, yielded, atol=1e-12)


def test_robot_that_rolls_during_a_cycle_goes_over_to_the_other_side(make_rig: MakeRig) -> None:
    rig, other = make_rig(), make_rig()
    for each in (rig, other):
        each.ask(1.5)
        each.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 0.5)
    at = len(rig.outputs)
    rig.step(60, upright=-0.9)
    other.step(60)
    apart = np.abs(rig.commands(at) + other.commands(at)).max(axis=1)
    assert apart[0] > 0.1
    assert apart[-1] < 1e-12
    speeds = np.abs([output.velocities for output in rig.outputs])
    assert speeds.max() <= rig.controller.limits.velocity


def test_robot_that_rocks_on_its_side_is_left_alone(make_rig: MakeRig) -> None:
    rig = make_rig()
    rig.ask(5.0)
    for _ in range(12):  # across the ends of cycles, too
        for tilt in (0.1, -0.1, -0.15, 0.15):
            rig.step(10, upright=tilt)
            assert rig.state.side == 1.0
    assert rig.state.cycles >= 2


def test_sidewinding_on_the_back_is_the_mirror_image(make_rig: MakeRig) -> None:
    gait = load_gait('sidewinding')
    on_belly, on_back = (
        played(make_rig(gait=gait, period=6.0), 0.7, upright=up) for up in (1.0, -1.0)
    )
    np.testing.assert_allclose(on_back, -on_belly, atol=1e-12)


def test_a_posture_that_is_held_stays_when_the_robot_is_turned_over(make_rig: MakeRig) -> None:
    rig = make_rig()
    rig.state = rig.controller.request_drive(rig.state, Drive(angular=0.15))
    rig.run_until(lambda state: state.mode is Mode.CYCLING and state.turned > 1.5)
    rig.state = rig.controller.request_drive(rig.state, Drive())
    rig.step(40)
    held = rig.posture
    assert np.abs(held).max() > 0.3
    rig.step(40, upright=-1.0)
    np.testing.assert_array_equal(rig.posture, held)


def test_legs_are_not_reversed() -> None:
    player = CyclePlayer(load_gait('legged'), load_robot('legged10'), ControllerConfig())
    assert player.side(ControllerState(upright=-1.0)) == 1.0
