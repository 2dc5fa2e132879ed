"""Progress of a turn from predictions and measurements."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.gaits.heading import JUMP, HeadingTracker

SEEDED = settings(derandomize=True, deadline=None, max_examples=150)
ROUNDING = 1e-9  # [rad] of some hundred sums and remainders


def wrapped(angle: float) -> float:
    return math.remainder(angle, math.tau)


def test_prediction_alone_is_summed() -> None:
    tracker = HeadingTracker()
    for _ in range(100):
        tracker = tracker.advanced(0.1, None)
    assert tracker.progress == pytest.approx(10.0)


@pytest.mark.parametrize('direction', [1.0, -1.0])
def test_branch_cut_is_invisible_over_many_turns(direction: float) -> None:
    heading = 3.0
    tracker = HeadingTracker().advanced(0.0, wrapped(heading))
    for k in range(1, 200):
        tracker = tracker.advanced(0.0, wrapped(heading + direction * 0.3 * k))
        assert tracker.progress == pytest.approx(direction * 0.3 * k, abs=ROUNDING)
    assert tracker.jumps == 0


@SEEDED
@given(
    st.floats(-3.0, 3.0),
    st.lists(
        # 40 prediction errors of 0.015 rad stay below a jump
        st.tuples(st.floats(-2.0, 2.0), st.floats(-0.015, 0.015), st.booleans()),
        max_size=40,
    ),
)
def test_gap_is_bridged_by_prediction_and_made_good_by_the_next_measurement(
    first: float, steps: list[tuple[float, float, bool]]
) -> None:
    """Each step: true heading change, error of its prediction, whether it is measured."""
    tracker, true, unseen_error = HeadingTracker().advanced(0.0, wrapped(first)), 0.0, 0.0
    for change, error, seen in steps:
        true += change
        unseen_error = 0.0 if seen else unseen_error + error
        tracker = tracker.advanced(change + error, wrapped(first + true) if seen else None)
        assert tracker.progress == pytest.approx(true + unseen_error, abs=ROUNDING)
    assert tracker.jumps == 0


@pytest.mark.parametrize('jump', [1.1 * JUMP, -2.0, 3.1])
def test_jump_is_left_out_counted_and_forgotten(jump: float) -> None:
    tracker = HeadingTracker().advanced(0.0, 0.4)
    tracker = tracker.advanced(0.1, wrapped(0.5 + jump))
    assert tracker.progress == pytest.approx(0.1)
    assert tracker.jumps == 1
    tracker = tracker.advanced(0.2, wrapped(0.8 + jump))  # 0.3 more, of which 0.2 predicted
    assert tracker.progress == pytest.approx(0.4)
    assert tracker.jumps == 1


def test_difference_just_below_a_jump_counts_as_motion() -> None:
    tracker = HeadingTracker().advanced(0.0, 0.0).advanced(0.0, 0.99 * JUMP)
    assert tracker.progress == pytest.approx(0.99 * JUMP)
    assert tracker.jumps == 0


def test_first_measurement_only_says_where_zero_is() -> None:
    assert HeadingTracker().advanced(0.2, 2.5).progress == 0.2


def test_new_turn_starts_at_zero_and_keeps_measuring() -> None:
    tracker = HeadingTracker().advanced(0.0, 1.0).advanced(0.0, 1.3).restarted()
    assert tracker.progress == 0.0
    assert tracker.advanced(0.0, 1.5).progress == pytest.approx(0.2)
