"""Among pegs the three nodes do in lock step what the study's trial does without ROS."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from ros_graph import Graph, User

from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_ros.compliance.controller import ComplianceConfig
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.nodes.admittance_node import AdmittanceNode
from omega_turn_ros.nodes.gait_node import GaitNode
from omega_turn_ros.nodes.messages import heading_of
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.bridge_node import PyBulletBridge
from omega_turn_sim_bridge.terrain_config import load_terrain

SPACING, SEED, PERIOD = 0.4, 3, 6.0
PATIENCE = 300.0  # [s] for what takes 15 s on an idle core
OMEGA = load_gait('omega')


@pytest.mark.slow
@pytest.mark.parametrize('compliant', [False, True], ids=['open loop', 'compliant'])
def test_nodes_in_lock_step_turn_as_far_as_the_trial_without_ros(
    graph: Graph, compliant: bool
) -> None:
    trial = ObstacleTrial(
        load_robot('limbless16'),
        OMEGA.gait,
        replace(load_terrain('pegboard'), spacing_bl=SPACING),
        SEED,
        ComplianceConfig() if compliant else None,
        cycles=1,
        period=PERIOD,
    )
    assert _turned(graph, compliant) == pytest.approx(trial.run()['angle_deg'], abs=2.0)


def _turned(graph: Graph, compliant: bool) -> float:
    """Angle of one cycle by the nodes [deg]."""
    user = User(graph)
    ground = {'terrain': 'pegboard', 'peg_spacing': SPACING, 'seed': SEED}
    graph.add(PyBulletBridge, lock_step=True, start_paused=True, lock_step_timeout=60.0, **ground)
    odom: list[Odometry] = user.hear(Odometry, 'odom')
    if compliant:
        graph.add(AdmittanceNode, lock_step=True)
    graph.add(
        GaitNode, lock_step=True, period=PERIOD, use_compliance=compliant, heading_feedback='none'
    )
    angle = OMEGA.calibration.largest_angle
    user.turn(angle)
    graph.spin_until(lambda: angle in user.remaining, 'an accepted turn')
    user.call('pybullet_bridge/resume')
    graph.spin_until(lambda: user.remaining[-1] == 0.0, 'the end', PATIENCE)
    seen = len(odom)
    graph.spin_until(lambda: len(odom) > seen + 100, 'a robot at rest', PATIENCE)
    headings = np.unwrap([heading_of(message) for message in odom])
    return math.degrees(headings[-1] - headings[0])
