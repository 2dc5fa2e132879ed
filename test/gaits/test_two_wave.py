"""The two-wave template against the paper's formulas, written out joint by joint."""

from __future__ import annotations

import math
from dataclasses import asdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave import (
    geometric_turn,
    offset_turn,
    serpenoid,
    two_wave_angles,
)
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait

SEEDED = settings(derandomize=True, deadline=None, max_examples=100)
ROUNDING = 1e-12  # [rad] of a handful of sines of arguments below 60 rad
OMEGA = TwoWaveGait(1.5, 1.0, 0.59, 0.1, -1.02, -0.78, -2.75, -3.07)

amplitude = st.floats(-2.0, 2.0)
phase = st.floats(-10.0, 10.0)
frequency = st.floats(0.0, 3.0)
joints = st.integers(2, 12)


@SEEDED
@given(amplitude, amplitude, phase, phase, frequency, frequency, joints)
def test_template_is_eq_template_joint_by_joint(
    a_f: float, a_t: float, tau: float, psi: float, k_f: float, k_t: float, n: int
) -> None:
    expected = [
        a_f * math.sin(tau + 2 * math.pi * k_f * i / n)
        + a_t * math.sin(tau + 2 * math.pi * k_t * i / n + psi)
        for i in range(1, n + 1)
    ]
    angles = two_wave_angles(a_f, tau, a_t, tau + psi, k_f, k_t, n)
    np.testing.assert_allclose(angles, expected, rtol=0, atol=ROUNDING)


@SEEDED
@given(amplitude, amplitude, phase, phase, frequency, joints)
def test_template_without_turning_frequency_is_the_offset_turn(
    a_f: float, a_t: float, tau: float, psi: float, k_f: float, n: int
) -> None:
    kappa = a_t * math.sin(tau + psi)
    template = two_wave_angles(a_f, tau, a_t, tau + psi, k_f, 0.0, n)
    expected = [a_f * math.sin(tau + 2 * math.pi * k_f * i / n) + kappa for i in range(1, n + 1)]
    np.testing.assert_allclose(template, expected, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(
        template, offset_turn(a_f, tau, kappa, k_f, n), rtol=0, atol=ROUNDING
    )


@SEEDED
@given(amplitude, amplitude, phase, phase, frequency, joints)
def test_template_with_equal_frequencies_is_the_geometric_turn(
    a_f: float, a_t: float, tau: float, psi: float, k_f: float, n: int
) -> None:
    r_1 = a_f * math.cos(tau) + a_t * math.cos(tau + psi)
    r_2 = a_f * math.sin(tau) + a_t * math.sin(tau + psi)
    position = [2 * math.pi * k_f * i / n for i in range(1, n + 1)]
    template = two_wave_angles(a_f, tau, a_t, tau + psi, k_f, k_f, n)
    expected = [r_1 * math.sin(x) + r_2 * math.cos(x) for x in position]
    np.testing.assert_allclose(template, expected, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(template, geometric_turn(r_1, r_2, k_f, n), rtol=0, atol=ROUNDING)


@SEEDED
@given(amplitude, phase, frequency, joints)
def test_serpenoid_is_the_forward_wave_alone(a: float, tau: float, k: float, n: int) -> None:
    expected = [a * math.sin(tau + 2 * math.pi * k * i / n) for i in range(1, n + 1)]
    np.testing.assert_allclose(serpenoid(a, tau, k, n), expected, rtol=0, atol=ROUNDING)


@SEEDED
@given(amplitude, phase, st.floats(-1.0, 1.0), frequency, joints)
def test_constant_offset_bends_every_joint_alike_at_every_phase(
    a: float, tau: float, kappa: float, k: float, n: int
) -> None:
    bent = offset_turn(a, tau, kappa, k, n) - serpenoid(a, tau, k, n)
    np.testing.assert_allclose(bent, np.full(n, kappa), rtol=0, atol=ROUNDING)


def test_amplitudes_and_phases_broadcast_like_numpy() -> None:
    rng = np.random.default_rng(1)
    a_f, tau_f = rng.normal(size=(3, 1)), rng.normal(size=4)
    a_t, tau_t = rng.normal(size=(2, 1, 1)), 0.3
    angles = two_wave_angles(a_f, tau_f, a_t, tau_t, 1.5, 1.0, 5)
    assert angles.shape == (2, 3, 4, 5)
    for i, j, k in np.ndindex(2, 3, 4):
        alone = two_wave_angles(a_f[j, 0], tau_f[k], a_t[i, 0, 0], tau_t, 1.5, 1.0, 5)
        np.testing.assert_array_equal(angles[i, j, k], alone)


@pytest.mark.parametrize('shape', [(), (3,), (2, 3)])
def test_gait_angles_have_the_shape_of_the_phase_and_a_joint_axis(shape: tuple[int, ...]) -> None:
    phases = np.zeros(shape)
    assert OMEGA.angles(phases, 8).shape == (*shape, 8)
    assert OMEGA.angles(phases, 8, scale=np.ones(shape)).shape == (*shape, 8)
    assert OMEGA.angles(0.0, 8, scale=np.ones(shape)).shape == (*shape, 8)


@SEEDED
@given(phase)
def test_gait_amplitudes_and_phases_are_f_1_f_2_and_f_3(tau: float) -> None:
    tau_f, tau_t = OMEGA.phases(tau)
    a_f, a_t = OMEGA.amplitudes(tau)
    assert tau_t == tau
    assert tau_f == pytest.approx(tau - OMEGA.psi, abs=ROUNDING)
    assert a_f == pytest.approx(
        OMEGA.a_f * (OMEGA.gamma + math.sin(tau - OMEGA.psi + OMEGA.phi_f)), abs=ROUNDING
    )
    assert a_t == pytest.approx(OMEGA.a_o * (1 + math.sin(tau + OMEGA.phi_o)), abs=ROUNDING)
    np.testing.assert_array_equal(
        OMEGA.angles(tau, 8), two_wave_angles(a_f, tau_f, a_t, tau_t, OMEGA.k_f, OMEGA.k_t, 8)
    )


@SEEDED
@given(phase)
def test_mirrored_gait_negates_every_angle(tau: float) -> None:
    angles = OMEGA.angles(tau, 8)
    np.testing.assert_array_equal(OMEGA.mirrored().angles(tau, 8), -angles)
    np.testing.assert_array_equal(OMEGA.angles(tau, 8, scale=-1.0), -angles)
    assert OMEGA.mirrored().mirrored() == OMEGA


@SEEDED
@given(phase, st.floats(-1.0, 1.0), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_offsets_add_to_the_scaled_amplitudes(
    tau: float, scale: float, d_f: float, d_t: float
) -> None:
    yielded = OMEGA.angles(tau, 8, scale, (d_f, d_t)) - OMEGA.angles(tau, 8, scale)
    wave = two_wave_angles(d_f, tau - OMEGA.psi, d_t, tau, OMEGA.k_f, OMEGA.k_t, 8)
    np.testing.assert_allclose(yielded, wave, rtol=0, atol=ROUNDING)


def test_gait_repeats_after_two_pi() -> None:
    phases = np.linspace(-3.0, 3.0, 50)
    np.testing.assert_allclose(
        OMEGA.angles(phases + 2 * np.pi, 8), OMEGA.angles(phases, 8), rtol=0, atol=ROUNDING
    )


def test_sampled_cycle_starts_at_phase_0_and_leaves_its_end_out() -> None:
    cycle = OMEGA.sampled(8, 6)
    np.testing.assert_array_equal(cycle, OMEGA.angles(np.arange(6) * 2 * np.pi / 6, 8))


@pytest.mark.parametrize('field', TwoWaveGait.__slots__)
@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf, True, '0.5', None])
def test_gait_parameter_that_is_no_finite_number_is_refused_by_name(
    field: str, value: object
) -> None:
    with pytest.raises(BadInputError, match=f'^gait field {field}: '):
        TwoWaveGait(**{**asdict(OMEGA), field: value})
