"""What a robot file must say, and what it then means."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from omega_turn_ros.errors import BadInputError, ConvergenceError, OmegaTurnError, SimulationError
from omega_turn_ros.resources import config_names, config_root, read_config
from omega_turn_ros.robot import STANDARD_GRAVITY, Robot, load_robot, robot_from_mapping

NUMBERS = (
    'module_length',
    'module_width',
    'head_length',
    'module_mass',
    'position_limit',
    'velocity_limit',
    'effort_limit',
)


@pytest.fixture
def data() -> dict[str, Any]:
    return copy.deepcopy(read_config('robots', 'limbless16'))


@pytest.fixture
def robot() -> Robot:
    return load_robot('limbless16')


def test_shipped_robot_is_the_paper_s(robot: Robot) -> None:
    assert robot.n_joints == 16
    assert robot.n_yaw == 8
    assert robot.joint_names == tuple(f'joint_{i}' for i in range(1, 17))
    assert robot.joint_axes == ('yaw', 'pitch') * 8
    np.testing.assert_array_equal(robot.yaw_indices, np.arange(0, 16, 2))
    assert robot.position_limit == pytest.approx(math.radians(90.0))
    assert (robot.module_length, robot.module_width) == (0.07, 0.05)
    np.testing.assert_allclose(robot.planar_link_lengths, np.full(9, 0.14))


def test_lengths_and_masses_add_up(robot: Robot) -> None:
    assert robot.length == pytest.approx(robot.planar_link_lengths.sum())
    assert robot.length == pytest.approx(robot.body_lengths.sum())
    np.testing.assert_allclose(
        robot.body_masses / robot.body_masses.sum(), robot.body_lengths / robot.length
    )
    assert robot.weight == pytest.approx(robot.body_masses.sum() * STANDARD_GRAVITY)
    assert robot.body_masses[1:] == pytest.approx([robot.module_mass] * robot.n_joints)


def test_a_shorter_robot_is_the_front_of_the_long_one(robot: Robot) -> None:
    short = robot.with_yaw_joints(6)
    assert (short.n_yaw, short.n_joints) == (6, 12)
    assert short.joint_names == robot.joint_names[:12]
    np.testing.assert_allclose(short.planar_link_lengths, robot.planar_link_lengths[:7])
    assert short.module_mass == robot.module_mass and short.name != robot.name
    assert robot.with_yaw_joints(8) is robot
    for count in (1, 9):
        with pytest.raises(BadInputError, match='yaw joints'):
            robot.with_yaw_joints(count)


@pytest.mark.parametrize(
    ('axes', 'lengths'),
    [
        (['yaw', 'yaw'], [0.3, 0.1, 0.1]),
        (['pitch', 'yaw', 'yaw', 'pitch', 'pitch'], [0.4, 0.1, 0.3]),
        (['yaw', 'pitch', 'yaw'], [0.3, 0.2, 0.1]),
    ],
)
def test_planar_links_run_from_yaw_joint_to_yaw_joint(
    data: dict[str, Any], axes: list[str], lengths: list[float]
) -> None:
    data['joints'] = [{'name': f'j{i}', 'axis': axis} for i, axis in enumerate(axes)]
    data['head_length'], data['module_length'] = 0.3, 0.1
    robot = robot_from_mapping(data)
    np.testing.assert_allclose(robot.planar_link_lengths, lengths)
    assert robot.planar_link_lengths.sum() == pytest.approx(robot.length)
    assert robot.planar_link_lengths.size == robot.n_yaw + 1


def test_robot_is_read_from_a_path_too(data: dict[str, Any], robot: Robot, tmp_path: Path) -> None:
    path = tmp_path / 'mine.yaml'
    path.write_text(yaml.safe_dump(data))
    assert load_robot(str(path)) == robot


@pytest.mark.parametrize('field', NUMBERS)
@pytest.mark.parametrize('value', [0, -1.0, math.nan, math.inf, True, '3', None])
def test_number_that_is_not_positive_is_refused_by_name(
    data: dict[str, Any], field: str, value: object
) -> None:
    data[field] = value
    with pytest.raises(BadInputError, match=rf'^{field}: '):
        robot_from_mapping(data)


@pytest.mark.parametrize('field', [*NUMBERS, 'joints'])
def test_missing_field_is_refused_by_name(data: dict[str, Any], field: str) -> None:
    del data[field]
    with pytest.raises(BadInputError, match=rf'^{field}: '):
        robot_from_mapping(data)


def test_misspelt_field_is_refused_by_name(data: dict[str, Any]) -> None:
    data['velocity_limt'] = 2.0
    with pytest.raises(BadInputError, match=r'^robot: .*\(unknown: velocity_limt\)$'):
        robot_from_mapping(data)


def test_a_gait_file_is_no_robot_file() -> None:
    expected = r"^robot: got 'omega', .*unknown: calibration .*, missing: effort_limit .*_limit\)$"
    with pytest.raises(BadInputError, match=expected):
        robot_from_mapping(read_config('gaits', 'omega'))


@pytest.mark.parametrize(
    ('joints', 'named'),
    [
        (None, r'^joints: '),
        ([], r'^joints: '),
        ('joint_1', r'^joints: '),
        ({'name': 'a', 'axis': 'yaw'}, r'^joints: '),
        ([{'name': 'a', 'axis': 'yaw'}], r'^joints: .*at least 2 yaw'),
        ([{'name': 'a', 'axis': 'yaw'}, {'name': 'b', 'axis': 'pitch'}], r'at least 2 yaw'),
        ([{'name': 'a', 'axis': 'yaw'}, {'name': 'b', 'axis': 'roll'}], r'^joints\[1\]\.axis: '),
        ([{'name': 'a', 'axis': 'yaw'}, {'name': 'a', 'axis': 'yaw'}], r'^joints\[1\]\.name: '),
        ([{'name': 'a', 'axis': 'yaw'}, {'name': '', 'axis': 'yaw'}], r'^joints\[1\]\.name: '),
        ([{'name': 'a', 'axis': 'yaw'}, {'name': 7, 'axis': 'yaw'}], r'^joints\[1\]\.name: '),
        ([{'name': 'a', 'axis': 'yaw'}, {'name': 'b'}], r'^joints\[1\]: '),
        ([{'name': 'a', 'axis': 'yaw'}, 'b'], r'^joints\[1\]: '),
    ],
)
def test_joints_that_make_no_chain_are_refused_by_place(
    data: dict[str, Any], joints: object, named: str
) -> None:
    data['joints'] = joints
    with pytest.raises(BadInputError, match=named):
        robot_from_mapping(data)


def test_joint_that_turns_past_half_a_turn_is_refused(data: dict[str, Any]) -> None:
    data['position_limit'] = 3.2
    with pytest.raises(BadInputError, match=r'^position_limit: .*pi'):
        robot_from_mapping(data)


def test_effort_sign_is_plus_or_minus_one_and_plus_when_left_out(data: dict[str, Any]) -> None:
    for sign in (1, -1):
        assert robot_from_mapping({**data, 'effort_sign': sign}).effort_sign == sign
    with pytest.raises(BadInputError, match=r'^effort_sign: '):
        robot_from_mapping({**data, 'effort_sign': 0})
    del data['effort_sign']
    assert robot_from_mapping(data).effort_sign == 1


def test_unknown_robot_is_refused_with_the_names_there_are() -> None:
    with pytest.raises(BadInputError, match=r"^robot: got 'snake', expected .*'limbless16'"):
        load_robot('snake')


def test_shipped_configuration_is_listed_by_name() -> None:
    assert config_root().is_dir()
    names = config_names('gaits')
    assert names == sorted(names)
    assert 'omega' in names
    assert 'limbless16' in config_names('robots')


@pytest.mark.parametrize(
    ('kind', 'builtin'),
    [(ConvergenceError, ArithmeticError), (SimulationError, RuntimeError)],
)
def test_own_errors_are_the_built_in_ones_too(kind: type, builtin: type) -> None:
    assert issubclass(kind, OmegaTurnError)
    assert issubclass(kind, builtin)


def test_refusal_says_field_value_and_expectation() -> None:
    error = BadInputError('period', -1.0, 'a time > 0 [s]')
    assert isinstance(error, ValueError)
    assert isinstance(error, OmegaTurnError)
    assert (error.field, error.value, error.expected) == ('period', -1.0, 'a time > 0 [s]')
    assert str(error) == 'period: got -1.0, expected a time > 0 [s]'
