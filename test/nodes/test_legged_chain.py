"""Ten legs over real topics on real physics: the gait node and the bridge in lock step."""

from __future__ import annotations

import math

import numpy as np
import pytest
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from ros_graph import Graph, User
from turner import CommandWatch

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.nodes.gait_node import GaitNode
from omega_turn_ros.nodes.messages import heading_of
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.bridge_node import PyBulletBridge

ROBOT = load_robot('legged10')
RATE = {'rate': 50.0, 'lock_step': True, 'robot': 'legged10'}
PERIOD = 4.0  # [s] of a cycle, to be done sooner
PHYSICS_PATIENCE = 280.0  # [s] for a run that takes 20 s on an idle core


@pytest.mark.slow
@pytest.mark.parametrize('angle_deg', [90.0, -90.0])
def test_a_turn_by_ninety_degrees_ends_within_three_and_keeps_all_limits(
    graph: Graph, angle_deg: float
) -> None:
    user = User(graph)
    graph.add(PyBulletBridge, **RATE, lock_step_timeout=60.0, start_paused=True)
    odom: list[Odometry] = user.hear(Odometry, 'odom')
    limits = JointLimits(ROBOT.position_limit, ROBOT.velocity_limit, 0.1)
    watch = CommandWatch(user.node, limits, np.zeros(ROBOT.n_joints), ROBOT)
    graph.add(GaitNode, gait='legged', heading_feedback='odom', period=PERIOD, **RATE)
    angle = math.radians(angle_deg)
    user.turn(angle)
    graph.spin_until(lambda: angle in user.remaining, 'an accepted turn')
    user.call('pybullet_bridge/resume')
    graph.spin_until(lambda: user.remaining[-1] == 0.0, 'the end', PHYSICS_PATIENCE)
    headings = np.unwrap([heading_of(message) for message in odom])
    assert math.degrees(headings[-1] - headings[0]) == pytest.approx(angle_deg, abs=3.0)
    lifts = watch.positions[:, np.array(ROBOT.joint_axes) == 'lift']
    assert (np.ptp(lifts, axis=0) > math.radians(15.0)).all()  # every leg did step


@pytest.mark.slow
def test_walking_turning_and_walking_on_keep_all_limits(graph: Graph) -> None:
    user = User(graph)
    graph.add(PyBulletBridge, **RATE, lock_step_timeout=60.0)
    odom: list[Odometry] = user.hear(Odometry, 'odom')
    limits = JointLimits(ROBOT.position_limit, ROBOT.velocity_limit, 0.1)
    CommandWatch(user.node, limits, np.zeros(ROBOT.n_joints), ROBOT)
    graph.add(GaitNode, gait='legged', heading_feedback='odom', period=PERIOD, **RATE)

    def walked() -> float:
        first, last = (message.pose.pose.position for message in (odom[0], odom[-1]))
        return math.hypot(last.x - first.x, last.y - first.y)

    velocity = Twist()
    velocity.linear.x = 1.0  # as fast as it can
    user.publisher('cmd_vel', Twist).publish(velocity)
    graph.spin_until(lambda: odom and walked() > 0.3, 'a walk', PHYSICS_PATIENCE)
    before = heading_of(odom[-1])
    angle = math.radians(20.0)
    user.turn(angle)
    graph.spin_until(lambda: angle in user.remaining, 'an accepted turn')
    graph.spin_until(lambda: user.remaining[-1] == 0.0, 'the end', PHYSICS_PATIENCE)
    turned = math.remainder(heading_of(odom[-1]) - before, math.tau)
    assert turned == pytest.approx(angle, abs=math.radians(6.0))  # a stride sways by some
    there = walked()
    graph.spin_until(lambda: walked() > there + 0.2, 'walking on', PHYSICS_PATIENCE)


def test_gait_of_another_robot_is_refused(graph: Graph) -> None:
    with pytest.raises(BadInputError, match='gait'):
        graph.add(GaitNode, gait='omega', robot='legged10')
    with pytest.raises(BadInputError, match='leg'):
        graph.add(GaitNode, gait='legged', robot='limbless16')
