"""The last word on every joint command."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.limits import JointLimits, limit_command

SEEDED = settings(derandomize=True, deadline=None, max_examples=200)
ROUNDING = 1e-12  # [rad] of sums of angles below 4 rad

step_time = st.sampled_from([0.0, 1e-12, 1e-6, 0.01, 0.1, 30.0, 1e9])
limit_sets = st.builds(
    JointLimits, st.floats(0.1, math.pi), st.floats(0.01, 50.0), st.floats(1e-4, 1.0)
)
anywhere = st.one_of(st.floats(-4.0, 4.0), st.sampled_from([1e300, -1e300, math.inf, -math.inf]))


@SEEDED
@given(
    limit_sets,
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
    st.lists(st.one_of(anywhere, st.just(math.nan)), min_size=3, max_size=3),
    step_time,
)
def test_no_target_makes_a_command_break_a_limit(
    limits: JointLimits, fractions: list[float], targets: list[float], dt: float
) -> None:
    previous = limits.position * np.array(fractions)
    command, _ = limit_command(previous, np.array(targets), dt, limits)
    assert np.isfinite(command).all()
    assert (np.abs(command) <= limits.position).all()
    reach = min(limits.velocity * dt, limits.step)
    assert (np.abs(command - previous) <= reach + ROUNDING).all()


@SEEDED
@given(limit_sets, st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3), step_time, anywhere)
def test_command_goes_towards_the_target_and_reports_when_it_falls_short(
    limits: JointLimits, fractions: list[float], dt: float, target: float
) -> None:
    previous = limits.position * np.array(fractions)
    command, limited = limit_command(previous, np.full(3, target), dt, limits)
    assert (np.sign(command - previous) * np.sign(target - previous) >= 0.0).all()
    assert limited == bool((np.abs(command - target) > ROUNDING).any())
    if limited:
        short = np.abs(command - target) > ROUNDING
        reach = min(limits.velocity * dt, limits.step)
        at_limit = np.abs(np.abs(command) - limits.position) < ROUNDING
        full_step = np.abs(np.abs(command - previous) - reach) < ROUNDING
        assert (at_limit | full_step)[short].all()


def test_target_within_reach_is_commanded_exactly() -> None:
    limits = JointLimits(1.5, 3.0, 0.1)
    target = np.array([0.1, -0.05])
    command, limited = limit_command(np.array([0.09, -0.03]), target, 0.01, limits)
    np.testing.assert_array_equal(command, target)
    assert not limited


def test_the_tighter_of_speed_and_step_limit_holds() -> None:
    limits, start, far = JointLimits(1.5, 3.0, 0.1), np.zeros(1), np.ones(1)
    slow, _ = limit_command(start, far, 0.01, limits)
    late, _ = limit_command(start, far, 10.0, limits)
    assert (slow[0], late[0]) == (pytest.approx(0.03), pytest.approx(0.1))


def test_inputs_are_left_alone() -> None:
    previous, target = np.array([0.2]), np.array([9.0])
    limit_command(previous, target, 0.1, JointLimits(1.0, 1.0, 0.1))
    assert (previous[0], target[0]) == (0.2, 9.0)


@pytest.mark.parametrize('field', ['position', 'velocity', 'step'])
@pytest.mark.parametrize('value', [0.0, -0.1, math.nan, math.inf])
def test_limit_without_meaning_is_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(BadInputError, match=f'^limit {field}: '):
        JointLimits(**{'position': 1.0, 'velocity': 1.0, 'step': 1.0, field: value})
