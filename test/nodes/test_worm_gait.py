"""The gait node plays a gait that was made of a recording."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml
from turner import ROBOT, Turner

from omega_turn_ros.gaits.library import gait_to_mapping
from omega_turn_ros.gaits.two_wave import two_wave_angles
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.to_gait import worm_gait


def test_a_worms_gait_turns_the_robot_by_the_angle_asked_for(
    make_turner: Callable[..., Turner], tmp_path: Path
) -> None:
    tau = -2.0 * np.pi * np.arange(90) / 60.0  # from head to tail
    forward, turning = 0.2 * (0.2 + np.sin(tau + 1.5)), 0.3 * (1.0 + np.sin(tau + 0.3))
    trial = Kymograph(
        'made', two_wave_angles(forward, tau + 1.0, turning, tau, 1.5, 1.0, 24), 32.0
    )
    made = worm_gait([trial], ROBOT, 'made')
    assert made.entry.gait.k_f < 0.0 and made.entry.gait.k_t < 0.0
    path = tmp_path / 'made.yaml'
    path.write_text(yaml.safe_dump(gait_to_mapping(made.entry)))
    turner = make_turner(turns=True, heading_feedback='odom', gait=str(path))
    angle = 0.9 * made.entry.calibration.largest_angle
    turner.start_turn(angle)
    turner.wait_for_end()
    assert turner.robot.heading == pytest.approx(angle, abs=0.0175)
    assert np.abs(turner.watch.positions).max() > 0.3
