"""The admittance law against its differential equation and its energy."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.compliance.admittance import (
    AdmittanceConfig,
    AdmittanceState,
    admittance_step,
    relax_step,
    stored_energy,
    wave_jacobian,
)
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave import two_wave_angles

SEEDED = settings(derandomize=True, deadline=None, max_examples=200)
FREE = {'offset_limit': 1e6, 'rate_limit': 1e6}  # bounds out of the way

PAPER = (1.0, 8.0, 8.0)
LIGHT = (0.1, 3.0, 3.0)
RINGING = (1.0, 1.0, 9.0)  # damped less than critically


def law(constants: tuple[float, float, float], **bounds: float) -> AdmittanceConfig:
    """The same constants for both waves."""
    m, b, k = constants
    return AdmittanceConfig((m, m), (b, b), (k, k), **bounds)


def step_response(constants: tuple[float, float, float], time: float) -> float:
    """Offset from rest under a force of 1, from the roots of m s^2 + b s + k."""
    m, b, k = constants
    root = np.sqrt(complex(b * b - 4.0 * m * k))
    fast, slow = (-b - root) / (2.0 * m), (-b + root) / (2.0 * m)
    decay = (fast * np.exp(slow * time) - slow * np.exp(fast * time)) / (fast - slow)
    return float((1.0 - decay.real) / k)


def after(
    config: AdmittanceConfig, force: tuple[float, float], time: float, dt: float
) -> AdmittanceState:
    state = AdmittanceState()
    for _ in range(round(time / dt)):
        state = admittance_step(state, force, dt, config)
    return state


@pytest.mark.parametrize('constants', [PAPER, LIGHT, RINGING])
def test_response_goes_to_the_analytic_one_with_the_time_step(
    constants: tuple[float, float, float],
) -> None:
    config, time = law(constants, **FREE), 0.8
    exact = step_response(constants, time)
    errors = [
        abs(after(config, (1.0, 0.0), time, dt).offset[0] - exact) for dt in (0.02, 0.005, 0.00125)
    ]
    assert errors[2] < 0.01 / constants[2]
    for coarse, fine in pairwise(errors):  # first order: a quarter of the step and error
        assert fine == pytest.approx(coarse / 4, rel=0.15)


@pytest.mark.parametrize('dt', [0.01, 0.5, 20.0])
def test_offset_settles_at_force_over_stiffness(dt: float) -> None:
    config = AdmittanceConfig((1.0, 0.1), (8.0, 3.0), (8.0, 3.0), 10.0, 10.0)
    state = after(config, (0.9, -1.5), max(20.0, 40 * dt), dt)
    assert state.offset == pytest.approx((0.9 / 8.0, -1.5 / 3.0), rel=1e-6)
    assert state.rate == pytest.approx((0.0, 0.0), abs=1e-6)


def test_waves_yield_independently() -> None:
    config = law(PAPER)
    assert after(config, (1.0, 0.0), 1.0, 0.01).offset[1] == 0.0
    both, alone = after(config, (1.0, -2.0), 1.0, 0.01), after(config, (1.0, 0.0), 1.0, 0.01)
    assert both.offset[0] == alone.offset[0]


def test_opposite_force_yields_the_opposite_way() -> None:
    one = after(law(LIGHT), (0.7, -5.0), 0.5, 0.01)
    other = after(law(LIGHT), (-0.7, 5.0), 0.5, 0.01)
    np.testing.assert_array_equal(other.offset, np.negative(one.offset))


@pytest.mark.parametrize('constants', [PAPER, LIGHT])
@pytest.mark.parametrize('dt', [1e-3, 0.01, 0.1, 1.0, 100.0])
def test_released_offset_dies_out_without_swinging_over_at_any_time_step(
    constants: tuple[float, float, float], dt: float
) -> None:
    """Both sets of constants are overdamped, so the offset only ever falls."""
    config = law(constants)
    state = AdmittanceState((0.3, -0.2), (0.0, 0.0))
    previous = state.offset[0]
    for _ in range(200):
        state = admittance_step(state, (0.0, 0.0), dt, config)
        assert -1e-15 <= state.offset[0] <= previous + 1e-15
        previous = state.offset[0]
    if dt >= 0.1:
        assert abs(state.offset[1]) < 1e-6


def test_bounds_hold_and_are_left_the_moment_the_force_turns() -> None:
    config = law(PAPER, offset_limit=0.35, rate_limit=1.0)
    state = after(config, (1e3, -1e3), 5.0, 0.01)
    assert state.offset == pytest.approx((0.35, -0.35), abs=1e-12)
    assert state.rate == (0.0, 0.0)  # nothing wound up against the bound
    state = admittance_step(state, (-0.1, 0.1), 0.01, config)
    assert state.offset[0] < 0.35
    assert state.offset[1] > -0.35


@SEEDED
@given(
    constants=st.sampled_from([PAPER, LIGHT, RINGING, (1.0, 0.0, 8.0)]),
    forces=st.lists(st.floats(-1e4, 1e4), min_size=1, max_size=30),
    dt=st.sampled_from([1e-6, 0.01, 0.1, 1.0, 1e3]),
)
def test_no_force_and_no_time_step_breaks_a_bound(
    constants: tuple[float, float, float], forces: list[float], dt: float
) -> None:
    config, state = law(constants), AdmittanceState()
    for force in forces:
        before = state
        state = admittance_step(state, (force, -force), dt, config)
        for old, new, rate in zip(before.offset, state.offset, state.rate):
            assert abs(new) <= config.offset_limit
            assert abs(rate) <= config.rate_limit * (1.0 + 1e-9)
            assert new - old == pytest.approx(rate * dt, abs=1e-12)


@SEEDED
@given(
    constants=st.sampled_from([PAPER, LIGHT, RINGING, (1.0, 0.0, 8.0)]),
    start=st.tuples(st.floats(-0.35, 0.35), st.floats(-1.0, 1.0)),
    forces=st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=30),
    dt=st.sampled_from([1e-4, 0.01, 0.1, 1.0, 30.0]),
)
def test_stored_energy_never_grows_by_more_than_the_work_of_the_force(
    constants: tuple[float, float, float],
    start: tuple[float, float],
    forces: list[float],
    dt: float,
) -> None:
    """Passive whatever the bounds cut off: the law cannot feed a push."""
    config = law(constants)
    state = AdmittanceState((start[0], 0.0), (start[1], 0.0))
    for force in forces:
        before, state = state, admittance_step(state, (force, 0.0), dt, config)
        gained = stored_energy(state, config) - stored_energy(before, config)
        work = force * (state.offset[0] - before.offset[0])
        assert gained <= work + 1e-12


def test_stored_energy_is_kinetic_plus_elastic() -> None:
    config = AdmittanceConfig((1.0, 2.0), (0.0, 0.0), (8.0, 3.0))
    state = AdmittanceState((0.1, -0.2), (0.5, 0.3))
    expected = 0.5 * (1.0 * 0.25 + 2.0 * 0.09 + 8.0 * 0.01 + 3.0 * 0.04)
    assert stored_energy(state, config) == pytest.approx(expected)


@pytest.mark.parametrize('dt', [0.0, -1.0])
def test_no_time_changes_nothing(dt: float) -> None:
    state = AdmittanceState((0.1, -0.1), (0.3, 0.2))
    assert admittance_step(state, (5.0, 5.0), dt, AdmittanceConfig()) is state
    assert relax_step(state, dt, 1.0) is state


@SEEDED
@given(
    st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)),
    st.lists(st.floats(1e-3, 0.3), min_size=1, max_size=10),
    st.floats(0.1, 2.0),
)
def test_relaxing_offset_returns_at_a_bounded_rate_and_reaches_exactly_zero(
    offset: tuple[float, float], times: list[float], rate: float
) -> None:
    state = AdmittanceState(offset, (0.7, -0.7))
    for dt in times:
        before, state = state, relax_step(state, dt, rate)
        for old, new, speed in zip(before.offset, state.offset, state.rate):
            assert abs(new) <= abs(old)
            assert old * new >= 0.0
            assert abs(new - old) <= rate * dt + 1e-15
            assert new - old == pytest.approx(speed * dt, abs=1e-12)
    state = relax_step(state, 0.5 / rate, rate)
    assert state.offset == (0.0, 0.0)
    assert relax_step(state, 0.01, rate) == AdmittanceState()


def test_jacobian_is_the_derivative_of_the_angles_by_the_amplitudes() -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        tau_f, tau_t, a_f, a_t = rng.normal(size=4)
        k_f, k_t = rng.uniform(0.0, 2.0, 2)
        jacobian = wave_jacobian(tau_f, tau_t, k_f, k_t, 8)
        base = two_wave_angles(a_f, tau_f, a_t, tau_t, k_f, k_t, 8)
        # linear in the amplitudes: any step gives the derivative
        np.testing.assert_allclose(
            jacobian[0],
            two_wave_angles(a_f + 1, tau_f, a_t, tau_t, k_f, k_t, 8) - base,
            atol=1e-12,
        )
        np.testing.assert_allclose(
            jacobian[1],
            two_wave_angles(a_f, tau_f, a_t + 1, tau_t, k_f, k_t, 8) - base,
            atol=1e-12,
        )


def test_defaults_are_the_paper_s_constants() -> None:
    config = AdmittanceConfig()
    assert (config.mass, config.damping, config.stiffness) == ((1, 1), (8, 8), (8, 8))


@pytest.mark.parametrize(
    ('field', 'value'),
    [
        ('mass', (1.0, 0.0)),
        ('mass', (-1.0, 1.0)),
        ('mass', (1.0, math.nan)),
        ('mass', (1.0,)),
        ('damping', (8.0, -1.0)),
        ('damping', (math.inf, 1.0)),
        ('stiffness', (0.0, 8.0)),
        ('stiffness', (8.0, 8.0, 8.0)),
        ('offset_limit', 0.0),
        ('offset_limit', math.nan),
        ('rate_limit', -1.0),
        ('rate_limit', math.inf),
    ],
)
def test_constants_that_make_the_law_unstable_or_deaf_are_refused_by_name(
    field: str, value: object
) -> None:
    with pytest.raises(BadInputError, match=rf'^{field}: '):
        AdmittanceConfig(**{field: value})


def test_law_without_damping_is_allowed() -> None:
    assert AdmittanceConfig(damping=(0.0, 0.0)).damping == (0.0, 0.0)
