"""Straight moves with a minimum-jerk time law."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.gaits.move import SHORTEST, move_between, move_through

SEEDED = settings(derandomize=True, deadline=None, max_examples=100)
START, END = np.array([0.2, -0.4, 0.0]), np.array([1.0, 0.5, 0.0])


def test_fastest_joint_peaks_at_the_velocity_asked_for() -> None:
    move = move_between(START, END, 0.8, 0.0)
    steps = 4000
    path = [move.advanced(move.duration * k / steps)[0].position for k in range(steps + 1)]
    speed = np.abs(np.diff(path, axis=0)) * steps / move.duration
    assert speed.max() == pytest.approx(0.8, rel=1e-5)
    assert speed[:, 2].max() == 0.0
    # It starts and ends at rest: the law's speed grows with the square of the time from either.
    assert speed[[0, -1]].max() < 1e-5


def test_move_stays_on_the_line_between_its_ends() -> None:
    move = move_between(START, END, 1.0, 0.0)
    for k in range(11):
        position = move.advanced(0.1 * k * move.duration)[0].position
        fraction = (position - START)[:2] / (END - START)[:2]
        assert fraction[0] == pytest.approx(fraction[1], abs=1e-12)
        assert -1e-12 <= fraction[0] <= 1.0 + 1e-12


@SEEDED
@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=40), st.floats(-2.0, 2.0))
def test_any_time_steps_end_exactly_at_the_end_with_the_whole_heading_change(
    steps: list[float], heading_change: float
) -> None:
    move = move_between(START, END, 1.0, heading_change)
    turned = 0.0
    for dt in [*steps, 1e6]:
        move, change = move.advanced(dt)
        turned += change
    assert move.done
    np.testing.assert_array_equal(move.position, END)
    assert turned == pytest.approx(heading_change, abs=1e-12)


def test_no_time_moves_nothing() -> None:
    move, _ = move_between(START, END, 1.0, 0.3).advanced(0.2)
    later, change = move.advanced(0.0)
    assert later == move
    assert change == 0.0


def test_move_to_the_same_posture_takes_the_shortest_time() -> None:
    move = move_between(START, START, 1.0, 0.0)
    assert move.duration == SHORTEST
    np.testing.assert_array_equal(move.advanced(0.05)[0].position, START)
    assert math.isfinite(move.fraction)


def test_a_move_through_a_waypoint_halts_there_and_keeps_its_speed() -> None:
    start, waypoint, end = np.zeros(3), np.array([1.0, 0.0, -0.5]), np.array([1.0, 0.3, -0.5])
    move = move_through(start, waypoint, end, 0.8, 0.2)
    dt, positions, turned = 0.01, [move.position], 0.0
    while not move.done:
        move, change = move.advanced(dt)
        positions.append(move.position)
        turned += change
    path = np.array(positions)
    speeds = np.abs(np.diff(path, axis=0)) / dt
    assert 0.75 < speeds.max() <= 0.8 + 1e-9
    assert np.abs(path - waypoint).max(axis=1).min() < 1e-3
    np.testing.assert_array_equal(path[-1], end)
    assert turned == pytest.approx(0.2)
