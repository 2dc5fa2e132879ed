"""The robot's URDF, read as XML."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from omega_turn_ros.robot import Robot, load_robot
from omega_turn_sim_bridge.robot import FOOT_RADIUS, STANCE, ride_height, urdf_from_robot


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='module')
def tree(robot: Robot) -> ET.Element:
    return ET.fromstring(urdf_from_robot(robot))


def origin(element: ET.Element) -> np.ndarray:
    return np.array([float(v) for v in element.find('origin').get('xyz').split()])


def feet_along_body(tree: ET.Element, robot: Robot) -> np.ndarray:
    """Foot positions along the straight robot, joint 1 at x = 0, shape (feet, 3)."""
    offsets = {'head': np.zeros(3)}
    for joint in tree.iter('joint'):
        parent, child = joint.find('parent').get('link'), joint.find('child').get('link')
        offsets[child] = offsets[parent] + origin(joint)
    return np.array(
        [
            offsets[link.get('name')] + origin(collision)
            for link in tree.iter('link')
            for collision in link.iter('collision')
        ]
    )


def test_joints_have_the_robot_s_names_axes_and_limits(tree: ET.Element, robot: Robot) -> None:
    joints = list(tree.iter('joint'))
    assert [j.get('name') for j in joints] == list(robot.joint_names)
    axes = {'yaw': '0 0 1', 'pitch': '0 1 0'}
    assert [j.find('axis').get('xyz') for j in joints] == [axes[a] for a in robot.joint_axes]
    for joint in joints:
        limit = {key: float(value) for key, value in joint.find('limit').items()}
        assert limit == {
            'lower': -robot.position_limit,
            'upper': robot.position_limit,
            'velocity': robot.velocity_limit,
            'effort': robot.effort_limit,
        }


def test_bodies_form_one_chain_from_head_to_tail(tree: ET.Element, robot: Robot) -> None:
    pairs = [
        (j.find('parent').get('link'), j.find('child').get('link')) for j in tree.iter('joint')
    ]
    names = ['head', *(f'module_{i}' for i in range(1, robot.n_joints + 1))]
    assert pairs == list(pairwise(names))
    assert [link.get('name') for link in tree.iter('link')] == names


def test_masses_are_the_robot_s(tree: ET.Element, robot: Robot) -> None:
    masses = [float(link.find('inertial/mass').get('value')) for link in tree.iter('link')]
    np.testing.assert_allclose(masses, robot.body_masses)


def test_two_feet_per_module_length_load_the_ground_like_a_line(
    tree: ET.Element, robot: Robot
) -> None:
    x = np.sort(feet_along_body(tree, robot)[:, 0])
    middles = robot.head_length - robot.module_length * (np.arange(x.size // 2) + 0.5)
    gauss = robot.module_length / (2.0 * np.sqrt(3.0))
    np.testing.assert_allclose(x, np.sort(np.concatenate([middles - gauss, middles + gauss])))


def test_feet_stand_on_both_sides_so_that_no_turn_is_favoured(
    tree: ET.Element, robot: Robot
) -> None:
    feet = feet_along_body(tree, robot)
    y = feet[np.argsort(feet[:, 0]), 1]
    np.testing.assert_allclose(np.abs(y), STANCE)
    assert y.sum() == pytest.approx(0.0, abs=1e-12)
    per_module = y.reshape(-1, 2)
    assert (per_module.sum(axis=1) == 0.0).all()  # one foot left, one right
    behind_head = per_module[: robot.n_joints, 0]
    assert (behind_head[1:] == -behind_head[:-1]).all()  # neighbours the other way round


def test_only_feet_can_touch_and_they_stand_below_the_body(tree: ET.Element, robot: Robot) -> None:
    for collision in tree.iter('collision'):
        assert float(collision.find('geometry/sphere').get('radius')) == FOOT_RADIUS
        sole = origin(collision)[2] - FOOT_RADIUS
        assert sole == pytest.approx(-ride_height(robot))
        assert sole < -0.5 * robot.module_width


def test_head_of_two_modules_gets_the_feet_of_two_modules(robot: Robot) -> None:
    for modules, feet in ((1, 2), (2, 4), (3, 6)):
        longer = replace(robot, head_length=modules * robot.module_length)
        head = next(ET.fromstring(urdf_from_robot(longer)).iter('link'))
        assert len(head.findall('collision')) == feet
