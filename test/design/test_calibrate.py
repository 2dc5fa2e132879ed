"""Calibration of gaits, on the paper's robot and on a small one."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml

from omega_turn_ros.design.calibrate import make_library_gait, straightest_phase
from omega_turn_ros.design.problem import DesignProblem
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import LibraryGait, gait_to_mapping, load_gait
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.posture import unbend_heading
from omega_turn_ros.mechanics.trajectory import heading_along
from omega_turn_ros.robot import Robot, robot_from_mapping

LIMIT = math.radians(70.0)

OMEGA = TwoWaveGait(1.5, 1.0, 0.59, 0.0, -1.02, -0.78, -2.75, -3.07)


@pytest.fixture(scope='module')
def small() -> Robot:
    """Three yaw joints on four modules."""
    return robot_from_mapping(
        {
            'name': 'small',
            'joints': [{'name': f'j{i}', 'axis': 'yaw'} for i in range(3)],
            'module_length': 0.1,
            'module_width': 0.05,
            'head_length': 0.1,
            'module_mass': 0.2,
            'position_limit': 1.3,
            'velocity_limit': 3.0,
            'effort_limit': 2.0,
        }
    )


@pytest.fixture(scope='module')
def small_chain(small: Robot) -> PlanarChain:
    return PlanarChain.of_robot(small)


@pytest.fixture(scope='module')
def fitted(small: Robot) -> WaveGait:
    return DesignProblem.of_robot(small, LIMIT).fitted(OMEGA)


@pytest.fixture(scope='module')
def made(small: Robot, fitted: WaveGait) -> LibraryGait:
    return make_library_gait('small_omega', 'a test', fitted, small)


@pytest.fixture(scope='module')
def heading_of(
    small: Robot, small_chain: PlanarChain, made: LibraryGait
) -> Callable[[float, int], np.ndarray]:
    """Integrate the small robot's cycle at a scale, in so many steps."""

    def integrate(scale: float, steps: int) -> np.ndarray:
        phases = made.calibration.start_phase + 2.0 * np.pi * np.arange(steps + 1) / steps
        return heading_along(small_chain, made.gait.angles(phases, small.n_yaw, scale))

    return integrate


def test_table_holds_the_integrated_heading(
    made: LibraryGait, heading_of: Callable[[float, int], np.ndarray]
) -> None:
    table = made.calibration
    columns = table.heading.shape[1] - 1
    for row in (4, len(table.scales) - 1):
        heading = heading_of(table.scales[row], 30 * columns)
        # 30 instead of 15 steps between columns: the midpoint rule's error shrinks fourfold
        np.testing.assert_allclose(
            table.heading[row], heading[::30], rtol=0, atol=math.radians(0.05)
        )


def test_angle_between_two_rows_is_the_integrated_one(
    made: LibraryGait, heading_of: Callable[[float, int], np.ndarray]
) -> None:
    for scale in (0.3125, 0.9875):
        assert made.calibration.angle_of(scale) == pytest.approx(
            heading_of(scale, 360)[-1], abs=math.radians(0.1)
        )


def test_bending_heading_undoes_unbending(
    made: LibraryGait, small: Robot, small_chain: PlanarChain
) -> None:
    table = made.calibration
    for scale in (0.5, 1.0):
        shape = made.gait.angles(table.start_phase, small.n_yaw, scale)
        assert table.bend_heading_of(scale) == pytest.approx(
            -unbend_heading(small_chain, shape), abs=1e-6
        )


def test_peak_rate_is_the_largest_slope_of_any_joint(made: LibraryGait, small: Robot) -> None:
    path = made.gait.sampled(small.n_yaw, 20_000)
    slope = np.abs(np.diff(path, axis=0)).max() * 20_000 / (2.0 * np.pi)
    assert made.calibration.peak_rate == pytest.approx(slope, rel=1e-3)


def test_cycle_starts_where_the_largest_angle_is_smallest() -> None:
    gait = OMEGA
    start = straightest_phase(gait, 8)
    largest = np.abs(gait.angles(start, 8)).max()
    others = np.abs(gait.sampled(8, 1000)).max(axis=1)
    assert largest <= others.min() + 1e-3  # half a step of the 2880 tried, at 2 rad/rad at most
    assert 0.0 <= start < 2.0 * np.pi


def test_made_gait_turns_counter_clockwise_whichever_way_it_was_given(
    made: LibraryGait, small: Robot, fitted: WaveGait
) -> None:
    mirrored = make_library_gait('x', 'x', fitted.mirrored(), small)
    assert mirrored.gait == made.gait
    assert mirrored.gait in (fitted, fitted.mirrored())
    assert made.calibration.largest_angle > math.radians(1.0)


def test_made_gait_uses_its_limit_to_the_full(made: LibraryGait, small: Robot) -> None:
    assert made.theta_max == pytest.approx(LIMIT, abs=1e-5)
    assert np.abs(made.gait.sampled(small.n_yaw, 9999)).max() == pytest.approx(LIMIT, abs=1e-5)
    assert made.robot == 'small'
    assert made.calibration.n_joints == 3


def test_made_gait_survives_its_file(made: LibraryGait, tmp_path: Path) -> None:
    path = tmp_path / 'small_omega.yaml'
    path.write_text(yaml.safe_dump(gait_to_mapping(made)))
    again = load_gait(str(path))
    assert again.theta_max == pytest.approx(made.theta_max, abs=1e-9)
    np.testing.assert_allclose(again.calibration.heading, made.calibration.heading, atol=5.1e-7)
    assert again.calibration.start_phase == pytest.approx(made.calibration.start_phase, abs=1e-9)


def test_limit_beyond_the_robot_s_is_refused_by_name(small: Robot, fitted: WaveGait) -> None:
    with pytest.raises(BadInputError, match=r'^largest joint angle: got 1\.3'):
        make_library_gait('x', 'x', fitted.scaled(1.1), small)
