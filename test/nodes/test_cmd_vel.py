"""Driving by velocity over topics."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from geometry_msgs.msg import Twist
from turner import BRISK, Turner

MakeTurner = Callable[..., Turner]
RATE = 1.2  # [rad/s], most of what a cycle of one second turns


def twist(linear: float, angular: float) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z = linear, angular
    return message


def test_a_turning_rate_turns_the_robot_until_it_is_withdrawn(make_turner: MakeTurner) -> None:
    turner = make_turner(turns=True)
    publisher = turner.user.publisher('cmd_vel', Twist)
    publisher.publish(twist(0.0, 0.15))
    turner.wait_for_cycle()
    turner.graph.spin_until(lambda: turner.robot.heading > 0.5, 'a turn', 120.0)
    assert turner.user.remaining[-1] == 0.0  # no turn, a rate
    publisher.publish(twist(0.0, 0.0))
    turner.wait_for_commands(100)
    held = turner.wait_for_commands(20)
    np.testing.assert_array_equal(held[0], held[-1])


def test_a_command_that_stops_coming_stops_the_robot(make_turner: MakeTurner) -> None:
    turner = make_turner(cmd_vel_timeout=0.3, **BRISK)
    turner.user.publisher('cmd_vel', Twist).publish(twist(0.0, RATE))
    turner.user.wait_for_fact('gait_node', 'drive [m/s, rad/s]', '(0.0, 0.0)')
    turner.wait_for_commands(100)
    held = turner.wait_for_commands(20)
    np.testing.assert_array_equal(held[0], held[-1])


@pytest.mark.parametrize('bad', [twist(math.nan, 0.1), twist(0.0, math.inf), twist(-0.2, 0.0)])
def test_a_velocity_that_is_none_is_dropped_whole_and_counted(
    make_turner: MakeTurner, bad: Twist
) -> None:
    turner = make_turner()
    turner.user.publisher('cmd_vel', Twist).publish(bad)
    turner.graph.spin_until(lambda: turner.user.refused('gait_node', 'cmd_vel') == 1, 'refusal')
    assert not turner.wait_for_commands(20).any()


def test_a_turn_goes_before_a_velocity(make_turner: MakeTurner) -> None:
    turner = make_turner(turns=True, heading_feedback='odom')
    publisher = turner.user.publisher('cmd_vel', Twist)
    publisher.publish(twist(0.0, -0.15))
    turner.wait_for_cycle()
    publisher.publish(twist(0.0, 0.0))
    before = turner.robot.heading
    turner.start_turn(0.8)
    turner.graph.spin_until(lambda: turner.user.remaining[-1] == 0.0, 'the end', 120.0)
    turner.wait_for_commands(50)
    assert turner.robot.heading - before == pytest.approx(0.8, abs=0.1)
