"""The tables that say how far a gait turns."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.gaits.calibration import Calibration
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.posture import unbend_heading
from omega_turn_ros.mechanics.trajectory import heading_along

SEEDED = settings(derandomize=True, deadline=None, max_examples=100)


def test_table_starts_at_zero_and_its_last_column_is_the_angle(shipped: LibraryGait) -> None:
    table = shipped.calibration
    assert (table.heading[0] == 0.0).all()
    assert (table.heading[:, 0] == 0.0).all()
    assert table.bend_heading[0] == 0.0
    np.testing.assert_array_equal(table.angles, table.heading[:, -1])
    assert table.largest_angle == table.heading[-1, -1]


def test_angle_grows_with_every_scale(shipped: LibraryGait) -> None:
    assert (np.diff(shipped.calibration.heading[:, -1]) > 0.0).all()
    assert shipped.calibration.scales[-1] == 1.0


def test_calibration_without_monotone_angles_is_made_monotone(omega: LibraryGait) -> None:
    table = omega.calibration.heading.copy()
    table[20, -1] = 0.5 * table[19, -1]
    bumpy = replace(omega.calibration, heading=table)
    assert (np.diff(bumpy.angles) >= 0.0).all()
    assert bumpy.angles[20] == table[19, -1]


@pytest.mark.parametrize('scale', [0.0375, 0.5125, 0.9875])  # midway between two table rows
def test_interpolated_angle_is_the_integrated_one(
    shipped: LibraryGait, chain: PlanarChain, scale: float
) -> None:
    table = shipped.calibration
    phases = table.start_phase + np.linspace(0.0, 2.0 * np.pi, 361)
    heading = heading_along(chain, shipped.gait.angles(phases, table.n_joints, scale))
    assert table.angle_of(scale) == pytest.approx(heading[-1], abs=math.radians(1.0))
    # and on the way there, a quarter of a table column off the grid
    step = 108
    assert table.heading_at(scale, 2.0 * np.pi * step / 360) == pytest.approx(
        heading[step], abs=math.radians(1.0)
    )


def test_bending_costs_what_unbending_returns(shipped: LibraryGait, chain: PlanarChain) -> None:
    table = shipped.calibration
    for scale in (1.0, -0.6):
        shape = shipped.gait.angles(table.start_phase, table.n_joints, scale)
        # 4 contact points per link and 6 decimals against 8 points and full precision
        assert table.bend_heading_of(scale) == pytest.approx(
            -unbend_heading(chain, shape), abs=math.radians(0.02)
        )


@SEEDED
@given(scale=st.floats(-1.0, 1.0), turned=st.floats(0.0, 2.0 * math.pi))
def test_mirrored_scale_mirrors_every_heading(
    omega: LibraryGait, scale: float, turned: float
) -> None:
    table = omega.calibration
    assert table.angle_of(-scale) == -table.angle_of(scale)
    assert table.heading_at(-scale, turned) == -table.heading_at(scale, turned)
    assert table.bend_heading_of(-scale) == -table.bend_heading_of(scale)


def lipschitz(table: Calibration) -> tuple[float, float]:
    """Steepest slope of the heading table along scale and along phase."""
    columns = table.heading.shape[1] - 1
    along_scale = np.abs(np.diff(table.heading, axis=0)).max() / np.diff(table.scales).min()
    along_phase = np.abs(np.diff(table.heading, axis=1)).max() * columns / (2.0 * math.pi)
    return float(along_scale), float(along_phase)


@SEEDED
@given(
    st.one_of(st.floats(0.0, 1.0), st.integers(0, 40).map(lambda k: k / 40)),
    st.one_of(st.floats(0.0, 6.283), st.integers(0, 24).map(lambda k: k * math.pi / 12)),
    st.floats(-1e-4, 1e-4),
    st.floats(-1e-4, 1e-4),
)
def test_heading_is_continuous_in_scale_and_phase_at_table_rows_too(
    omega: LibraryGait, scale: float, turned: float, d_scale: float, d_turned: float
) -> None:
    table = omega.calibration
    near = min(max(scale + d_scale, 0.0), 1.0), min(max(turned + d_turned, 0.0), 2.0 * math.pi)
    change = table.heading_at(*near) - table.heading_at(scale, turned)
    per_scale, per_phase = lipschitz(table)
    assert abs(change) <= per_scale * abs(d_scale) + per_phase * abs(d_turned) + 1e-12


@SEEDED
@given(st.floats(-1.0, 1.0))
def test_heading_after_a_whole_cycle_is_the_angle(omega: LibraryGait, scale: float) -> None:
    table = omega.calibration
    assert table.heading_at(scale, 2.0 * math.pi) == pytest.approx(
        table.angle_of(scale), abs=1e-12
    )
    assert table.heading_at(scale, 0.0) == 0.0


@SEEDED
@given(st.floats(-1.0, 1.0))
def test_scale_of_inverts_angle_of(omega: LibraryGait, fraction: float) -> None:
    table = omega.calibration
    angle = fraction * table.largest_angle
    scale = table.scale_of(angle)
    assert abs(scale) <= 1.0
    assert table.angle_of(scale) == pytest.approx(angle, abs=1e-12)


def test_scale_of_more_than_the_largest_angle_is_one(omega: LibraryGait) -> None:
    table = omega.calibration
    assert table.scale_of(5.0) == 1.0
    assert table.scale_of(-5.0) == -1.0
