"""Any angle becomes whole cycles of one amplitude."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import LibraryGait, gait_names, load_gait
from omega_turn_ros.gaits.turn_plan import plan_turn

SEEDED = settings(derandomize=True, deadline=None, max_examples=150)
SLACK = 2e-9  # a turn may exceed whole largest cycles by 1e-9 of one without another cycle

TABLES = {name: load_gait(name).calibration for name in gait_names()}

any_gait = st.sampled_from(sorted(TABLES))
angle = st.one_of(
    st.floats(-50.0, 50.0, allow_subnormal=False),
    st.floats(-1e-5, 1e-5, allow_subnormal=False),
    st.sampled_from([1e-5, -1e-5, 1e-12]),
)
ratio = st.floats(0.3, 3.0)


@SEEDED
@given(any_gait, angle, ratio)
def test_planned_turn_is_the_one_asked_for(name: str, wanted: float, ground: float) -> None:
    table = TABLES[name]
    plan = plan_turn(wanted, table, ground)
    cycle = ground * table.angle_of(plan.scale)
    assert plan.angle == pytest.approx(wanted, abs=SLACK * max(1.0, abs(wanted)))
    assert plan.angle == pytest.approx(plan.cycles * cycle, rel=1e-12)
    assert abs(plan.scale) <= 1.0


@SEEDED
@given(any_gait, angle, ratio)
def test_no_plan_has_a_cycle_too_many_or_too_few(name: str, wanted: float, ground: float) -> None:
    largest = ground * TABLES[name].largest_angle
    cycles = plan_turn(wanted, TABLES[name], ground).cycles
    assert cycles * largest >= abs(wanted) * (1.0 - SLACK)
    if wanted == 0.0:
        assert cycles == 0
    else:
        assert cycles == 1 or (cycles - 1) * largest < abs(wanted)


@SEEDED
@given(any_gait, angle)
def test_opposite_turn_is_the_mirrored_plan(name: str, wanted: float) -> None:
    plan, opposite = plan_turn(wanted, TABLES[name]), plan_turn(-wanted, TABLES[name])
    assert (opposite.cycles, opposite.scale, opposite.angle) == (
        plan.cycles,
        -plan.scale,
        -plan.angle,
    )
    assert plan.scale * wanted >= 0.0


@SEEDED
@given(any_gait, angle, ratio)
def test_ground_that_turns_less_asks_for_a_turn_that_much_larger(
    name: str, wanted: float, ground: float
) -> None:
    there = plan_turn(wanted, TABLES[name], ground)
    model = plan_turn(wanted / ground, TABLES[name])
    assert (there.cycles, there.scale) == (model.cycles, model.scale)
    assert there.angle == pytest.approx(ground * model.angle, rel=1e-12)


@pytest.mark.parametrize('count', [1, 2, 3, 7, 30])
def test_whole_largest_cycles_stay_whole(omega: LibraryGait, count: int) -> None:
    plan = plan_turn(count * omega.calibration.largest_angle, omega.calibration)
    assert plan.cycles == count
    assert plan.scale == pytest.approx(1.0, abs=1e-9)


def test_no_turn_needs_no_cycle(omega: LibraryGait) -> None:
    plan = plan_turn(0.0, omega.calibration)
    assert (plan.cycles, plan.scale, plan.angle) == (0, 0.0, 0.0)


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_angle_that_is_not_finite_is_refused_by_name(omega: LibraryGait, bad: float) -> None:
    with pytest.raises(BadInputError, match=r'^angle: '):
        plan_turn(bad, omega.calibration)


@pytest.mark.parametrize('largest', [1.7e308, -1.7e308])
@pytest.mark.parametrize('name', sorted(TABLES))
def test_angle_beyond_any_count_of_cycles_is_refused_by_name(name: str, largest: float) -> None:
    with pytest.raises(BadInputError, match=r'^angle: '):
        plan_turn(largest, TABLES[name], 0.3)


@pytest.mark.parametrize('bad', [0.0, -1.0, math.nan, math.inf])
def test_ground_ratio_without_meaning_is_refused_by_name(omega: LibraryGait, bad: float) -> None:
    with pytest.raises(BadInputError, match=r'^ground_ratio: '):
        plan_turn(1.0, omega.calibration, bad)
