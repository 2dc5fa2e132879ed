"""Heading of bodies that do not lie level."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from omega_turn_sim_bridge.body_frame import tilted_heading

BENDS = np.array([0.4, -0.9, 0.2, 1.1])
WEIGHTS = np.array([0.4, 0.3, 0.2, 0.1])


@pytest.mark.parametrize('heading', [0.3, -2.0, 3.1])
@pytest.mark.parametrize('roll', [0.0, math.pi])
def test_level_bodies_agree_whichever_side_is_up(heading: float, roll: float) -> None:
    seen = heading + BENDS * math.cos(roll)
    turns = np.array([Rotation.from_euler('ZX', (angle, roll)).as_quat() for angle in seen])
    assert tilted_heading(turns, BENDS, WEIGHTS) == pytest.approx(heading)


def test_a_body_on_end_does_not_turn_the_heading() -> None:
    turns = [Rotation.from_euler('Z', 0.5 + bend).as_quat() for bend in BENDS]
    for pitch in np.radians([80.0, 89.0, 91.0, 100.0]):  # where its own yaw jumps by half a turn
        turns[0] = Rotation.from_euler('ZY', (0.5 + BENDS[0], pitch)).as_quat()
        assert tilted_heading(np.array(turns), BENDS, WEIGHTS) == pytest.approx(0.5, abs=1e-9)
