"""The quick postures against the template they stand for."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.gaits.postures import Postures
from omega_turn_ros.robot import Robot

ROUNDING = 1e-13  # [rad] of a handful of sines of arguments below 20 rad
offset = st.floats(-1.0, 1.0)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(st.floats(-20.0, 20.0), st.floats(-1.0, 1.0), st.tuples(offset, offset))
def test_a_posture_is_the_template_at_the_yaw_joints_and_straight_elsewhere(
    shipped: LibraryGait,
    robot: Robot,
    phase: float,
    scale: float,
    offsets: tuple[float, float],
) -> None:
    yaw = robot.yaw_indices
    posture = Postures(shipped.gait, yaw, robot.n_joints).at(phase, scale, offsets)
    expected = np.zeros(robot.n_joints)
    expected[yaw] = shipped.gait.angles(phase, robot.n_yaw, scale, offsets)
    np.testing.assert_allclose(posture, expected, rtol=0, atol=ROUNDING)
