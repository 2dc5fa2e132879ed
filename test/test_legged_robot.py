"""A robot file with legs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import yaml

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.resources import config_root
from omega_turn_ros.robot import LeggedRobot, load_robot, robot_from_mapping


@pytest.fixture
def data() -> dict[str, Any]:
    return yaml.safe_load((config_root() / 'robots' / 'legged10.yaml').read_text())


def test_shipped_robot_has_five_leg_pairs_and_four_yaw_joints_between() -> None:
    robot = load_robot('legged10')
    assert isinstance(robot, LeggedRobot)
    assert (robot.n_pairs, robot.n_yaw, robot.n_joints) == (5, 4, 24)
    np.testing.assert_array_equal(robot.yaw_indices, [4, 9, 14, 19])
    np.testing.assert_allclose(robot.planar_link_lengths, 0.18)
    assert robot.length == pytest.approx(0.9)
    assert robot.weight == pytest.approx((5 * 0.35 + 10 * 0.05) * 9.81)


def test_robot_without_legs_is_none() -> None:
    assert not isinstance(load_robot('limbless16'), LeggedRobot)


def test_any_number_of_pairs_will_do_in_that_order(data: dict[str, Any]) -> None:
    data['joints'] = data['joints'][:14]
    assert robot_from_mapping(data).n_yaw == 2
    data['joints'] = data['joints'][:13]
    with pytest.raises(BadInputError, match='joints'):
        robot_from_mapping(data)


def test_leg_joints_belong_to_robots_with_legs(data: dict[str, Any]) -> None:
    del data['legs']
    with pytest.raises(BadInputError, match=r'joints\[0\]\.axis'):
        robot_from_mapping(data)


@pytest.mark.parametrize('change', [{'reach': 0.0}, {'height': 'low'}, {'toes': 3.0}])
def test_bad_legs_are_refused(data: dict[str, Any], change: dict[str, object]) -> None:
    data['legs'] = {**data['legs'], **change}
    with pytest.raises(BadInputError, match='legs'):
        robot_from_mapping(data)
