"""Joint states and phases in, amplitude offsets out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from omega_turn_ros.compliance.admittance import AdmittanceConfig, wave_jacobian
from omega_turn_ros.compliance.controller import (
    ComplianceConfig,
    ComplianceController,
    ComplianceState,
)
from omega_turn_ros.compliance.external_torque import TorqueConfig
from omega_turn_ros.errors import ConvergenceError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import joint_torques
from omega_turn_ros.robot import load_robot

DT = 0.01
PHASES = (0.4, 1.1)
STILL = np.zeros(8)
WIDE = AdmittanceConfig(offset_limit=10.0, rate_limit=10.0)
YIELDING = ComplianceConfig(torque_scale=(1.0, 1.0), law=WIDE, torque=TorqueConfig(dead_band=0.1))


@pytest.fixture(scope='module')
def chain() -> PlanarChain:
    return PlanarChain.of_robot(load_robot('limbless16'))


def held(
    controller: ComplianceController, efforts: np.ndarray, seconds: float = 8.0
) -> ComplianceState:
    """A body that does not move while its motors hold against something."""
    state = controller.initial_state()
    for _ in range(round(seconds / DT)):
        state = controller.step(state, STILL, STILL, efforts, PHASES, DT)
    return state


def test_lasting_push_offsets_the_amplitudes_by_projected_torque_over_stiffness(
    chain: PlanarChain,
) -> None:
    config = replace(YIELDING, torque=TorqueConfig(dead_band=0.0))
    push = np.random.default_rng(2).normal(size=8)
    state = held(ComplianceController(chain, config), -push)
    force = wave_jacobian(*PHASES, config.k_f, config.k_t, 8) @ push
    np.testing.assert_allclose(state.external, push, atol=1e-9)
    np.testing.assert_allclose(state.admittance.offset, force / WIDE.stiffness, rtol=1e-3)


@pytest.mark.parametrize('wave', [0, 1])
def test_push_along_a_wave_makes_it_larger_if_it_yields_and_smaller_if_it_pushes(
    chain: PlanarChain, wave: int
) -> None:
    shape = wave_jacobian(*PHASES, 1.5, 1.0, 8)[wave]
    for config, sign in ((YIELDING, 1.0), (ComplianceConfig(), -1.0)):
        controller = ComplianceController(chain, config)
        assert sign * held(controller, -2.0 * shape, 2.0).admittance.offset[wave] > 0.01
        assert sign * held(controller, 2.0 * shape, 2.0).admittance.offset[wave] < -0.01


@pytest.mark.parametrize('scale', [(0.0, 0.0), (0.5, 0.5), (0.5, -1.0)])
def test_torque_scale_scales_the_yielding_of_each_wave(
    chain: PlanarChain, scale: tuple[float, float]
) -> None:
    push = -np.linspace(0.5, 2.0, 8)
    full = held(ComplianceController(chain, YIELDING), push)
    less = held(ComplianceController(chain, replace(YIELDING, torque_scale=scale)), push)
    np.testing.assert_allclose(
        less.admittance.offset, np.multiply(scale, full.admittance.offset), atol=1e-12
    )


def free_gait(chain: PlanarChain, compensated: bool) -> np.ndarray:
    """Largest offsets over one omega cycle with the efforts that open ground asks for."""
    gait = load_gait('omega')
    torque = TorqueConfig(friction=0.5 if compensated else 0.0, dead_band=0.1)
    controller = ComplianceController(chain, replace(YIELDING, torque=torque))
    state, largest = controller.initial_state(), np.zeros(2)
    rate = 2.0 * np.pi / 10.0
    phases = gait.calibration.start_phase + 0.05 * rate * np.arange(200)
    angles = gait.gait.angles(phases, 8)
    rates = (gait.gait.angles(phases + 1e-5, 8) - angles) / 1e-5 * rate
    efforts = joint_torques(chain, angles, rates, 0.5)
    for k in range(200):
        both = tuple(float(p) for p in gait.gait.phases(phases[k]))
        state = controller.step(state, angles[k], rates[k], efforts[k], both, 0.05)
        largest = np.maximum(largest, np.abs(state.admittance.offset))
    return largest


def test_gait_on_open_ground_stays_open_loop(chain: PlanarChain) -> None:
    """Not so without compensation: ground friction alone then shrinks or swells the waves."""
    np.testing.assert_allclose(free_gait(chain, compensated=True), 0.0, atol=1e-12)
    assert free_gait(chain, compensated=False).max() > 0.02


def test_relaxing_forgets_torques_and_returns_to_the_gait(chain: PlanarChain) -> None:
    controller = ComplianceController(chain, ComplianceConfig(relax_rate=0.5))
    state = held(controller, np.full(8, -3.0), 1.0)
    before = np.abs(state.admittance.offset)
    assert before.max() > 0.05
    state = controller.relax(state, 0.02)
    assert (state.external == 0.0).all()
    assert (state.filtered == 0.0).all()
    np.testing.assert_allclose(
        np.abs(state.admittance.offset), np.maximum(before - 0.01, 0.0), atol=1e-12
    )
    for _ in range(50):
        state = controller.relax(state, 0.02)
    assert state.admittance.offset == (0.0, 0.0)


def test_no_time_yields_nothing(chain: PlanarChain) -> None:
    controller = ComplianceController(chain, ComplianceConfig())
    state = controller.initial_state()
    later = controller.step(state, STILL, STILL, np.full(8, 5.0), PHASES, 0.0)
    assert later.admittance == state.admittance
    assert (later.filtered == 0.0).all()


def test_a_reading_without_a_prediction_counts_as_missing(chain: PlanarChain) -> None:
    def unsolved(*_: object) -> np.ndarray:
        raise ConvergenceError('no balance')

    good = ComplianceController(chain, YIELDING)
    state = held(good, np.full(8, -3.0), 1.0)
    later = ComplianceController(chain, YIELDING, unsolved).step(
        state, STILL, STILL, np.full(8, -3.0), PHASES, DT
    )
    assert later.admittance == good.relax(state, DT).admittance
    assert not later.external.any()
