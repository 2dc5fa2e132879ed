"""Nodes as processes: how they end, and what the others do when one dies under way."""

from __future__ import annotations

import ast
import signal
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from processes import Process
from ros_graph import Graph, User
from sensor_msgs.msg import JointState
from turner import BRISK, QUICK, ROBOT, CommandWatch, Turner

from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.nodes.gait_node import GaitNode
from omega_turn_sim_bridge.bridge_node import PyBulletBridge

NODES = ('gait_node', 'admittance_node', 'pybullet_bridge')
StartProcess = Callable[..., Process]


@pytest.fixture
def start_process(domain_id: int, namespace: str) -> Iterator[StartProcess]:
    """Starts nodes in processes that end with the test."""
    started: list[Process] = []

    def start(name: str, **parameters: Any) -> Process:
        started.append(Process(domain_id, namespace, name, **parameters))
        return started[-1]

    yield start
    for process in started:
        process.close()


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('name', NODES)
def test_a_signal_ends_a_node_cleanly(
    graph: Graph, start_process: StartProcess, name: str, number: signal.Signals
) -> None:
    user = User(graph)
    process = start_process(name)
    graph.spin_until(lambda: name in user.health, 'diagnostics')
    # Twice, as a terminal and launch do, each for its own part.
    assert process.end(number, times=2) == 0
    assert 'Traceback' not in process.stderr
    assert 'rror' not in process.stderr
    graph.spin_until(lambda: name not in graph.names(), 'its leave of the graph')


@pytest.mark.parametrize(
    ('name', 'ready'),
    [
        ('gait_node', 'limbless16, gait omega, heading feedback odom'),
        ('admittance_node', 'limbless16, gait omega'),
        ('pybullet_bridge', 'limbless16, terrain flat'),
    ],
)
def test_a_node_says_what_it_works_with_and_which_parameters_it_does_not_know(
    graph: Graph, start_process: StartProcess, name: str, ready: str
) -> None:
    user = User(graph)
    parameters = {'heading_feedback': 'odom'} if name == 'gait_node' else {}
    process = start_process(name, heading_feedbak='odom', use_sim_time=False, **parameters)
    graph.spin_until(lambda: name in user.health, 'diagnostics')
    lines = process.stderr.splitlines()
    assert sum(line.endswith(f'{name} ready: {ready}') for line in lines) == 1
    (warning,) = (line for line in lines if '[WARN]' in line)
    assert warning.endswith(f'{name} does not have are ignored: heading_feedbak')


@pytest.mark.parametrize(
    ('name', 'parameters', 'expected'),
    [
        ('gait_node', {'period': 0.1}, 'error: parameter period: got 0.1, expected a number in'),
        ('gait_node', {'gait': 'moonwalk'}, "got 'moonwalk', expected"),
        ('admittance_node', {'mass': '[1.0, -1.0]'}, 'error: parameter mass: got [1.0, -1.0]'),
        ('admittance_node', {'robot': 7}, 'error: parameter robot: got 7, expected text'),
        ('pybullet_bridge', {'friction': 'wet'}, "got 'wet', expected a number in [0, 5]"),
        ('pybullet_bridge', {'rate': 300.0}, 'expected a multiple of rate = 300 Hz'),
    ],
)
def test_a_wrong_setting_ends_a_node_at_once_and_says_why(
    start_process: StartProcess, name: str, parameters: dict[str, Any], expected: str
) -> None:
    process = start_process(name, **parameters)
    assert process.wait() == 2
    assert expected in process.stderr
    assert 'Traceback' not in process.stderr


def test_a_turn_goes_on_when_the_admittance_node_is_killed(
    graph: Graph, start_process: StartProcess
) -> None:
    settings = {**BRISK, 'period': 2.5, 'use_compliance': True, 'amplitude_timeout': 0.2}
    turner = Turner(graph, **settings)
    turner.robot.efforts[:] = -3.0  # something leans on every joint
    admittance = start_process('admittance_node')

    def offsets() -> np.ndarray:
        told = turner.user.fact('gait_node', 'amplitude offsets [rad]')
        return np.array(ast.literal_eval(told))

    graph.spin_until(lambda: 'admittance_node' in turner.user.health, 'the admittance node')
    turner.start_turn(1.0)
    graph.spin_until(lambda: np.abs(offsets()).max() > 0.01, 'a compliant gait')
    admittance.end(signal.SIGKILL)
    graph.spin_until(lambda: not offsets().any(), 'a gait of its own')
    assert turner.user.remaining[-1] != 0.0
    turner.wait_for_end()


def test_the_bridge_holds_the_posture_when_the_gait_node_is_killed(
    graph: Graph, start_process: StartProcess
) -> None:
    user = User(graph)
    states = user.hear(JointState, 'joint_states')
    commands = user.hear(JointState, 'joint_commands')
    graph.add(PyBulletBridge, command_timeout=0.5, publish_clock=False)
    gait = start_process('gait_node', use_compliance=False, **QUICK)

    def posture() -> np.ndarray:
        return np.array(states[-1].position)

    user.turn(1.5)
    graph.spin_until(lambda: states and np.abs(posture()).max() > 0.8, 'a cycle')
    gait.end(signal.SIGKILL)
    user.wait_for_problem('pybullet_bridge', 'no commands: posture held')
    held, told = posture(), np.array(commands[-1].position)
    assert held == pytest.approx(told, abs=0.1)  # it went where it was told last
    seen = len(states)
    graph.spin_until(lambda: len(states) > seen + 50, 'readings')
    later = np.array([s.position for s in states[seen:]])
    assert np.abs(later - held).max() < 0.05


def test_a_turn_survives_a_bridge_that_is_restarted(
    graph: Graph, start_process: StartProcess
) -> None:
    bridge = {'real_time_factor': 2.0}
    user = User(graph)
    limits = JointLimits(ROBOT.position_limit, ROBOT.velocity_limit, 0.1)
    watch = CommandWatch(user.node, limits, np.zeros(ROBOT.n_joints))
    first = start_process('pybullet_bridge', **bridge)
    graph.add(GaitNode, use_sim_time=True, use_compliance=False, **QUICK)
    graph.spin_until(lambda: watch.messages, 'commands')
    user.turn(0.8)
    graph.spin_until(lambda: np.abs(watch.newest).max() > 0.8, 'a cycle')
    assert first.end(signal.SIGTERM) == 0
    user.wait_for_problem('gait_node', 'joint_states stale')
    assert user.remaining[-1] != 0.0
    second = start_process('pybullet_bridge', **bridge)
    graph.spin_until(lambda: user.remaining[-1] == 0.0, 'the end of the turn')
    graph.spin_until(lambda: np.abs(watch.newest).max() < 1e-3, 'a straight body')
    assert second.end(signal.SIGTERM) == 0
    graph.spin_until(lambda: 'pybullet_bridge' not in graph.names(), 'its leave of the graph')
