"""The shipped gait files, and what happens to files that are wrong."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import LibraryGait, gait_names, gait_to_mapping, load_gait
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.robot import load_robot

Mapping = dict[str, Any]
Change = Callable[[Mapping], None]


def setting(*keys: object, to: object) -> Change:
    """Overwrite one entry of a nested mapping."""

    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = to

    return change


def dropping(*keys: object) -> Change:
    """Remove one entry of a nested mapping."""

    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        del data[keys[-1]]

    return change


@pytest.fixture
def write_gait(omega: LibraryGait, tmp_path: Path) -> Callable[[Change], str]:
    """Write the omega gait with one change; return the path."""

    def write(change: Change) -> str:
        data = copy.deepcopy(gait_to_mapping(omega))
        change(data)
        path = tmp_path / 'changed.yaml'
        path.write_text(yaml.safe_dump(data))
        return str(path)

    return write


def test_the_paper_s_three_turns_and_their_amplitudes_are_shipped() -> None:
    assert {'omega', 'omega_75', 'omega_60', 'offset', 'geometric'} <= set(gait_names())


def test_file_name_and_gait_name_agree() -> None:
    for name in gait_names():
        assert load_gait(name).name == name


def test_shipped_gait_reaches_its_joint_limit_and_no_further(shipped: LibraryGait) -> None:
    robot = load_robot(shipped.robot)
    # A grid this fine misses a maximum by less than A (pi/20000)^2 ~ 4e-8 rad; files carry 1e-9.
    largest = np.abs(shipped.gait.sampled(robot.n_yaw, 20_000)).max()
    assert largest == pytest.approx(shipped.theta_max, abs=2e-6)
    assert shipped.theta_max <= robot.position_limit + 1e-9


def test_shipped_gait_is_calibrated_for_its_robot(shipped: LibraryGait) -> None:
    assert shipped.calibration.n_joints == load_robot(shipped.robot).n_yaw


def test_shipped_gait_turns_counter_clockwise_at_every_scale(shipped: LibraryGait) -> None:
    assert (shipped.calibration.heading[1:, -1] > 0.0).all()


def test_shipped_gait_starts_where_the_body_is_straightest(shipped: LibraryGait) -> None:
    n = shipped.calibration.n_joints
    start = np.abs(shipped.gait.angles(shipped.calibration.start_phase, n)).max()
    straightest = np.abs(shipped.gait.sampled(n, 20_000)).max(axis=1).min()
    # Files were made on a grid of 2880 phases: off by half a step at about 1 rad/rad at most.
    assert start == pytest.approx(straightest, abs=math.pi / 2880 * shipped.calibration.peak_rate)


def test_shipped_peak_rate_is_the_largest_joint_speed(shipped: LibraryGait) -> None:
    cycle = shipped.gait.sampled(shipped.calibration.n_joints, 20_000)
    rate = np.abs(np.diff(cycle, axis=0)).max() * 20_000 / (2 * math.pi)
    # It was read off 360 steps: below the true peak by no more than its curvature in one step.
    assert shipped.calibration.peak_rate == pytest.approx(rate, rel=1e-3)


def test_omega_turns_more_than_offset_and_geometric_and_more_with_wider_limits() -> None:
    angle = {name: load_gait(name).calibration.largest_angle for name in gait_names()}
    assert angle['omega'] > angle['offset'] > angle['geometric'] > 0.0
    assert angle['omega'] > angle['omega_75'] > angle['omega_60'] > 0.0


def test_gait_written_and_read_back_is_the_same(shipped: LibraryGait, tmp_path: Path) -> None:
    path = tmp_path / 'again.yaml'
    path.write_text(yaml.safe_dump(gait_to_mapping(shipped)))
    again = load_gait(str(path))
    assert again.gait == shipped.gait
    assert (again.name, again.robot, again.theta_max) == (
        shipped.name,
        shipped.robot,
        shipped.theta_max,
    )
    np.testing.assert_array_equal(again.calibration.heading, shipped.calibration.heading)
    assert gait_to_mapping(again) == gait_to_mapping(shipped)


def test_written_gait_is_rounded_by_no_more_than_it_says(omega: LibraryGait) -> None:
    uneven = TwoWaveGait(*(v + 1e-10 / 3 for v in asdict(omega.gait).values()))
    written = gait_to_mapping(LibraryGait('x', 'x', omega.robot, 1 / 3, uneven, omega.calibration))
    for field, value in asdict(uneven).items():
        assert written['parameters'][field] == pytest.approx(value, abs=5.1e-10)
    assert written['theta_max'] == pytest.approx(1 / 3, abs=5.1e-10)


@pytest.mark.parametrize(
    'field',
    ['name', 'description', 'kind', 'robot', 'theta_max', 'parameters', 'calibration'],
)
def test_gait_file_without_a_field_is_refused_naming_it(
    field: str, write_gait: Callable[[Change], str]
) -> None:
    with pytest.raises(BadInputError, match=rf'^gait: .*\(missing: {field}\)'):
        load_gait(write_gait(dropping(field)))


def test_gait_file_with_an_unknown_field_is_refused_naming_it(
    write_gait: Callable[[Change], str],
) -> None:
    with pytest.raises(BadInputError, match=r'^gait: .*\(unknown: gama\)'):
        load_gait(write_gait(setting('gama', to=1.0)))


@pytest.mark.parametrize(
    'field', ['start_phase', 'scales', 'heading', 'bend_heading', 'peak_rate', 'n_joints']
)
def test_calibration_without_a_field_is_refused_naming_it(
    field: str, write_gait: Callable[[Change], str]
) -> None:
    with pytest.raises(BadInputError, match=f'^calibration.*{field}'):
        load_gait(write_gait(dropping('calibration', field)))


@pytest.mark.parametrize('field', TwoWaveGait.__slots__)
def test_gait_file_with_a_parameter_missing_or_nan_is_refused_naming_it(
    field: str, write_gait: Callable[[Change], str]
) -> None:
    with pytest.raises(BadInputError, match=f'^gait parameters.*{field}'):
        load_gait(write_gait(dropping('parameters', field)))
    with pytest.raises(BadInputError, match=f'^gait field {field}: '):
        load_gait(write_gait(setting('parameters', field, to=math.nan)))


@pytest.mark.parametrize(
    ('change', 'named'),
    [
        (setting('kind', to='three_wave'), 'kind'),
        (setting('theta_max', to=math.nan), 'theta_max'),
        (setting('theta_max', to=-1.0), 'theta_max'),
        (setting('theta_max', to='wide'), 'theta_max'),
        (setting('theta_max', to=None), 'theta_max'),
        (setting('parameters', to=[1.0, 2.0]), 'parameters'),
        (setting('parameters', to=None), 'parameters'),
        (setting('calibration', to=None), 'calibration'),
        (setting('calibration', 'start_phase', to=math.nan), 'start_phase'),
        (setting('calibration', 'peak_rate', to=math.nan), 'peak_rate'),
        (setting('calibration', 'peak_rate', to=0.0), 'peak_rate'),
        (setting('calibration', 'n_joints', to=0), 'n_joints'),
        (setting('calibration', 'scales', 0, to=0.01), 'scales'),
        (setting('calibration', 'scales', 3, to=0.0), 'scales'),
        (setting('calibration', 'scales', 3, to=math.nan), 'scales'),
        (setting('calibration', 'scales', -1, to=2.0), 'scales'),
        (setting('calibration', 'scales', to=[0.0]), 'scales'),
        (setting('calibration', 'heading', 5, 7, to=math.nan), 'heading'),
        (setting('calibration', 'heading', 5, to=[0.0, 1.0]), '^calibration'),
        (setting('calibration', 'heading', to=[[0.0]] * 41), 'heading'),
        (dropping('calibration', 'heading', 5), 'heading'),
        (setting('calibration', 'bend_heading', 2, to=math.inf), 'bend_heading'),
        (dropping('calibration', 'bend_heading', 2), 'bend_heading'),
        (setting('calibration', 'heading', -1, -1, to='left'), '^calibration'),
    ],
)
def test_malformed_gait_file_is_refused_naming_the_field(
    change: Change, named: str, write_gait: Callable[[Change], str]
) -> None:
    with pytest.raises(BadInputError, match=named):
        load_gait(write_gait(change))


@pytest.mark.parametrize('factor', [-1.0, 0.0, 1e-12])
def test_gait_that_turns_clockwise_or_not_at_all_is_refused(
    factor: float, write_gait: Callable[[Change], str]
) -> None:
    def turn_otherwise(data: Mapping) -> None:
        table = data['calibration']['heading']
        data['calibration']['heading'] = [[factor * h for h in row] for row in table]

    with pytest.raises(BadInputError, match=r'^calibration heading: '):
        load_gait(write_gait(turn_otherwise))


def test_unknown_gait_is_refused_with_the_names_there_are() -> None:
    with pytest.raises(BadInputError, match=r"^gait: got 'omga', expected .*'omega'"):
        load_gait('omga')


@pytest.mark.parametrize('text', ['- a\n- b\n', 'name: [1,\n', '', 'just words'])
def test_file_that_is_no_mapping_is_refused_naming_it(text: str, tmp_path: Path) -> None:
    path = tmp_path / 'broken.yaml'
    path.write_text(text)
    with pytest.raises(BadInputError, match=r'broken\.yaml'):
        load_gait(str(path))


def test_file_that_is_no_text_is_refused_naming_it(tmp_path: Path) -> None:
    path = tmp_path / 'picture.yaml'
    path.write_bytes(b'\x89PNG\xff\xfe\x00')
    with pytest.raises(BadInputError, match=r'picture\.yaml'):
        load_gait(str(path))
