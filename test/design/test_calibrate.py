"""Calibration of gaits, on the paper's robot and on a small one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from omega_turn_ros.design.calibrate import (
    POINTS_PER_LINK,
    fit_to_limit,
    make_library_gait,
    straightest_phase,
)
from omega_turn_ros.design.starting_gaits import STARTING_GAITS
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import LibraryGait, gait_to_mapping, load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.posture import unbend_heading
from omega_turn_ros.mechanics.trajectory import heading_along
from omega_turn_ros.robot import Robot, load_robot, robot_from_mapping

LIMIT = math.radians(70.0)

# Degrees per cycle of the gaits' first design (see PITFALLS.md), whose parameters are given there
# to two decimals: good for 4 % of the angle.
FIRST_DESIGN = {
    'omega': (90.0, 94.0),
    'omega_75': (75.0, 51.0),
    'omega_60': (60.0, 26.0),
    'offset': (90.0, 55.0),
    'geometric': (90.0, 12.0),
}


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
    return PlanarChain.of_robot(small, POINTS_PER_LINK)


@pytest.fixture(scope='module')
def made(small: Robot) -> LibraryGait:
    return make_library_gait('small_omega', 'a test', STARTING_GAITS['omega'][2], small, LIMIT)


@pytest.fixture(scope='module')
def heading_of(
    small: Robot, small_chain: PlanarChain, made: LibraryGait
) -> Callable[[float, int], np.ndarray]:
    """Integrate the small robot's cycle at a scale, in so many steps."""

    def integrate(scale: float, steps: int) -> np.ndarray:
        phases = made.calibration.start_phase + 2.0 * np.pi * np.arange(steps + 1) / steps
        return heading_along(small_chain, made.gait.angles(phases, small.n_yaw, scale))

    return integrate


@pytest.mark.parametrize('name', sorted(FIRST_DESIGN))
def test_starting_gait_turns_as_far_as_it_was_designed_to(name: str) -> None:
    robot = load_robot('limbless16')
    limit, angle = FIRST_DESIGN[name]
    gait = fit_to_limit(STARTING_GAITS[name][2], robot.n_yaw, math.radians(limit))
    chain = PlanarChain.of_robot(robot, POINTS_PER_LINK)
    path = gait.angles(np.linspace(0.0, 2.0 * np.pi, 361), robot.n_yaw)
    turned = math.degrees(abs(heading_along(chain, path)[-1]))
    assert turned == pytest.approx(angle, rel=0.04)


def test_starting_gaits_have_the_paper_s_frequencies_and_names_of_shipped_ones() -> None:
    for name, (_, limit, gait) in STARTING_GAITS.items():
        shipped = load_gait(name)
        assert gait.k_f == 1.5
        assert shipped.theta_max == pytest.approx(limit)
        assert (shipped.gait.k_f, shipped.gait.k_t) == (gait.k_f, gait.k_t)
    assert {STARTING_GAITS[n][2].k_t for n in ('omega', 'omega_75', 'omega_60')} == {1.0}
    assert STARTING_GAITS['offset'][2].k_t == 0.0
    assert STARTING_GAITS['geometric'][2].k_t == 1.5


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
    gait = STARTING_GAITS['omega'][2]
    start = straightest_phase(gait, 8)
    largest = np.abs(gait.angles(start, 8)).max()
    others = np.abs(gait.sampled(8, 1000)).max(axis=1)
    assert largest <= others.min() + 1e-3  # half a step of the 2880 tried, at 2 rad/rad at most
    assert 0.0 <= start < 2.0 * np.pi


def test_made_gait_turns_counter_clockwise_whichever_way_it_was_given(
    made: LibraryGait, small: Robot
) -> None:
    given = fit_to_limit(STARTING_GAITS['omega'][2], small.n_yaw, LIMIT)
    mirrored = make_library_gait('x', 'x', given.mirrored(), small, LIMIT)
    a_f, a_o = mirrored.gait.a_f, mirrored.gait.a_o
    assert (a_f, a_o) == pytest.approx((made.gait.a_f, made.gait.a_o))
    assert abs(a_f) == pytest.approx(abs(given.a_f))
    assert a_f * a_o == pytest.approx(given.a_f * given.a_o)  # both turned round or neither
    assert made.calibration.largest_angle > math.radians(1.0)


def test_made_gait_uses_its_limit_to_the_full(made: LibraryGait, small: Robot) -> None:
    assert made.theta_max == LIMIT
    assert np.abs(made.gait.sampled(small.n_yaw, 2880)).max() == pytest.approx(LIMIT, abs=1e-12)
    assert made.robot == 'small'
    assert made.calibration.n_joints == 3


def test_made_gait_survives_its_file(made: LibraryGait, tmp_path: Path) -> None:
    path = tmp_path / 'small_omega.yaml'
    path.write_text(yaml.safe_dump(gait_to_mapping(made)))
    again = load_gait(str(path))
    assert again.theta_max == pytest.approx(made.theta_max, abs=1e-9)
    np.testing.assert_allclose(again.calibration.heading, made.calibration.heading, atol=5.1e-7)
    assert again.calibration.start_phase == pytest.approx(made.calibration.start_phase, abs=1e-9)


def test_limit_beyond_the_robot_s_is_refused_by_name(small: Robot) -> None:
    with pytest.raises(BadInputError, match=r'^theta_max: got 1\.4'):
        make_library_gait('x', 'x', STARTING_GAITS['omega'][2], small, 1.4)


@pytest.mark.parametrize('theta_max', [0.2, 1.0, math.pi / 2])
def test_fitting_scales_both_amplitudes_alike_and_nothing_else(theta_max: float) -> None:
    gait = STARTING_GAITS['offset'][2]
    fitted = fit_to_limit(gait, 8, theta_max)
    assert np.abs(fitted.sampled(8, 2880)).max() == pytest.approx(theta_max, abs=1e-12)
    assert fitted.a_f / gait.a_f == pytest.approx(fitted.a_o / gait.a_o)
    assert replace(fitted, a_f=gait.a_f, a_o=gait.a_o) == gait
