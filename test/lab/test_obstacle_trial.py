"""Turns among obstacles without ROS: real physics, short."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace

import numpy as np
import pytest

from omega_turn_lab.obstacle_trial import ObstacleTrial, Result
from omega_turn_ros.compliance.admittance import AdmittanceConfig
from omega_turn_ros.compliance.controller import ComplianceConfig
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.terrain_config import TerrainConfig

CLOSE = TerrainConfig('pegboard', spacing_bl=0.2, extent_bl=0.8)
YIELDING = ComplianceConfig(law=AdmittanceConfig(offset_limit=0.4))
PUSHING = replace(YIELDING, torque_scale=(-0.5, -0.5))
OPEN = ObstacleTrial(
    load_robot('limbless16'), load_gait('omega').gait, CLOSE, seed=1, cycles=1, period=6.0
)


@pytest.fixture(scope='module', params=[None, YIELDING, PUSHING], ids=['open', 'yield', 'push'])
def jammed(request: pytest.FixtureRequest) -> tuple[ObstacleTrial, Result]:
    """A turn where pegs leave hardly any room."""
    trial = replace(OPEN, compliance=request.param)
    return trial, trial.run()


@pytest.mark.slow
def test_no_limit_is_broken_in_a_jam_whatever_the_law(
    jammed: tuple[ObstacleTrial, Result],
) -> None:
    trial, result = jammed
    assert result['largest_effort'] > 0.9 * trial.robot.effort_limit  # it does jam
    assert result['limits_broken'] == 0
    if trial.compliance is not None:
        assert 0.1 < max(result['largest_offsets']) <= trial.compliance.law.offset_limit


@pytest.mark.slow
def test_stored_energy_never_grows_by_more_than_the_work_brought_in(
    jammed: tuple[ObstacleTrial, Result],
) -> None:
    trial, result = jammed
    assert result['energy']['largest_excess'] < 1e-9
    assert (result['energy']['peak'] > 1e-3) == (trial.compliance is not None)


@pytest.mark.slow
def test_body_does_not_pass_through_pegs(jammed: tuple[ObstacleTrial, Result]) -> None:
    trial, result = jammed
    assert 0.0005 < result['deepest_contact'] < 0.5 * trial.terrain.peg_radius


@pytest.mark.slow
def test_result_is_plain_json_with_an_angle_for_each_cycle(
    jammed: tuple[ObstacleTrial, Result],
) -> None:
    trial, result = jammed
    assert json.loads(json.dumps(result)) == result
    assert len(result['cycle_angles_deg']) == trial.cycles
    assert sum(result['cycle_angles_deg']) == pytest.approx(result['total_deg'], abs=1e-5)
    frames = len(result['time'])
    assert np.shape(result['poses']) == (frames, 3)
    assert np.shape(result['yaw_angles']) == (frames, trial.robot.n_yaw)


@pytest.mark.slow
def test_open_ground_leaves_a_compliant_turn_as_it_is() -> None:
    free = replace(OPEN, terrain=TerrainConfig())
    open_loop = free.run()
    compliant = replace(free, compliance=YIELDING).run()
    assert compliant['angle_deg'] == pytest.approx(open_loop['angle_deg'], rel=0.03)
    assert open_loop['angle_deg'] > 80.0


@pytest.mark.slow
def test_a_trial_repeats_to_the_last_bit_after_a_trip_through_pickle() -> None:
    trial = replace(OPEN, compliance=YIELDING, period=5.0)
    assert pickle.loads(pickle.dumps(trial)) == trial
    assert pickle.loads(pickle.dumps(trial)).run() == trial.run()


def test_a_turn_of_no_cycle_is_refused() -> None:
    with pytest.raises(BadInputError, match=r'^cycles: got 0'):
        replace(OPEN, cycles=0)


def test_trials_that_differ_in_the_law_have_different_names_in_the_store() -> None:
    names = {repr(replace(OPEN, compliance=c)) for c in (None, YIELDING, PUSHING)}
    assert len(names) == 3


SIDEWINDING = load_gait('sidewinding')
FREQUENCY_TURN = ObstacleTrial(
    OPEN.robot,
    SIDEWINDING.gait,
    cycles=1,
    start_phase=SIDEWINDING.calibration.start_phase,
)


@pytest.mark.slow
def test_a_frequency_turn_takes_its_calibrated_angle_open_loop() -> None:
    assert pickle.loads(pickle.dumps(FREQUENCY_TURN)) == FREQUENCY_TURN
    result = FREQUENCY_TURN.run()
    expected = np.degrees(SIDEWINDING.calibration.largest_angle)
    assert result['angle_deg'] == pytest.approx(expected, rel=0.1)
    assert result['limits_broken'] == 0 and len(result['cycle_angles_deg']) == 1


@pytest.mark.parametrize(
    ('change', 'named'),
    [({'compliance': YIELDING}, 'compliance'), ({'start_phase': None}, 'start_phase')],
)
def test_what_does_not_go_with_a_gait_is_refused(change: dict[str, object], named: str) -> None:
    with pytest.raises(BadInputError, match=rf'^{named}: '):
        replace(FREQUENCY_TURN, **change)
    with pytest.raises(BadInputError, match=r'^start_phase: '):
        replace(OPEN, start_phase=0.0)
