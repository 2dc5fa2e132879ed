"""The sign, filter and dead band of external torques."""

from __future__ import annotations

import math

import numpy as np
import pytest

from omega_turn_ros.compliance.external_torque import (
    STILL,
    TorqueConfig,
    external_torque_step,
    needed_torques,
)
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import joint_torques

NONE = np.zeros(3)
UNFILTERED = TorqueConfig(filter_time=0.0, dead_band=0.0)


def test_motor_that_holds_against_a_positive_push_reports_a_positive_external_torque() -> None:
    """effort + external = needed: a push towards + angles is answered by a negative effort."""
    efforts, needed = np.array([-2.0, 1.0, 0.5]), np.array([0.0, 0.0, 0.5])
    _, external = external_torque_step(NONE, efforts, needed, 0.01, UNFILTERED)
    np.testing.assert_allclose(external, [2.0, -1.0, 0.0])


def test_robot_with_inverted_efforts_reports_the_same_external_torque() -> None:
    efforts, needed = np.array([-2.0, 1.0, 0.5]), np.array([0.3, -0.1, 0.5])
    inverted = TorqueConfig(effort_sign=-1, filter_time=0.0, dead_band=0.0)
    np.testing.assert_array_equal(
        external_torque_step(NONE, -efforts, needed, 0.01, inverted)[1],
        external_torque_step(NONE, efforts, needed, 0.01, UNFILTERED)[1],
    )


@pytest.mark.parametrize('steps', [1, 3, 50])
def test_filter_answers_in_its_time_constant_however_time_is_cut(steps: int) -> None:
    config = TorqueConfig(filter_time=0.2, dead_band=0.0)
    filtered = NONE
    for _ in range(steps):
        filtered, external = external_torque_step(
            filtered, np.full(3, -1.0), NONE, 0.3 / steps, config
        )
    np.testing.assert_allclose(filtered, 1.0 - math.exp(-0.3 / 0.2), rtol=1e-12)
    np.testing.assert_array_equal(external, filtered)


def test_no_time_leaves_the_filter_as_it_is() -> None:
    state = np.array([0.4, -0.3, 0.0])
    config = TorqueConfig(filter_time=0.2)
    filtered, _ = external_torque_step(state, np.full(3, 9.0), NONE, 0.0, config)
    np.testing.assert_array_equal(filtered, state)


def test_dead_band_swallows_small_torques_and_shortens_large_ones_without_a_step() -> None:
    config = TorqueConfig(filter_time=0.0, dead_band=0.1)
    torques = np.array([0.05, 0.1, 0.1 + 1e-9, 0.5, -0.05, -0.5])
    _, external = external_torque_step(np.zeros(6), -torques, np.zeros(6), 0.01, config)
    np.testing.assert_allclose(external, [0.0, 0.0, 1e-9, 0.4, 0.0, -0.4], atol=1e-12)


@pytest.fixture(scope='module')
def chain() -> PlanarChain:
    return PlanarChain([0.1] * 4, weight=5.0)


def test_gait_that_needs_its_efforts_on_open_ground_reports_nothing(chain: PlanarChain) -> None:
    angles, rates = np.array([0.2, -0.4, 0.1]), np.array([0.5, 0.2, -0.3])
    needed = needed_torques(chain, angles, rates, 0.5)
    np.testing.assert_array_equal(needed, joint_torques(chain, angles, rates, 0.5))
    assert np.abs(needed).max() > 0.01
    _, external = external_torque_step(NONE, needed, needed, 0.01, UNFILTERED)
    assert (external == 0.0).all()


@pytest.mark.parametrize(('speed', 'friction'), [(0.5 * STILL, 0.5), (1.0, 0.0)])
def test_nothing_is_predicted_for_a_still_body_or_without_friction(
    chain: PlanarChain, speed: float, friction: float
) -> None:
    angles, rates = np.array([0.2, -0.4, 0.1]), np.array([speed, 0.0, -speed])
    assert (needed_torques(chain, angles, rates, friction) == 0.0).all()


@pytest.mark.parametrize(
    ('field', 'value'),
    [
        ('effort_sign', 0),
        ('effort_sign', 2),
        ('friction', -0.1),
        ('friction', math.nan),
        ('filter_time', -0.1),
        ('filter_time', math.inf),
        ('dead_band', -0.1),
        ('dead_band', math.nan),
    ],
)
def test_torque_setting_without_meaning_is_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(BadInputError, match=rf'^{field}: '):
        TorqueConfig(**{field: value})
