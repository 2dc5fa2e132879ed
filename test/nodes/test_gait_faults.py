"""Robots that share a graph, and whole sequences of commands and faults."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ros_graph import Graph
from sensor_msgs.msg import JointState
from turner import ROBOT, Turner, silence

MakeTurner = Callable[..., Turner]


def test_two_robots_on_one_graph_do_not_disturb_each_other(make_turner: MakeTurner) -> None:
    first = make_turner('first')
    second = make_turner('second', turns=True, heading_feedback='odom')
    idle = make_turner('idle')
    first.start_turn(0.9)
    second.start_turn(-0.5)
    second.wait_for_cycle()
    first.user.call('gait_node/stop')
    second.wait_for_end()
    assert second.robot.heading == pytest.approx(-0.5, abs=math.radians(1.5))
    assert np.abs(first.watch.newest).max() > 0.1
    assert len(idle.watch.messages) > 100
    assert not idle.watch.positions.any()
    assert idle.user.remaining == [0.0]


Action = tuple[str, Any]
ANGLES = st.one_of(
    st.floats(-4.0, 4.0), st.sampled_from([0.0, 1e-7, 1e6, 1e300, math.nan, math.inf])
)
OFFSETS = st.tuples(*[st.one_of(st.floats(-0.6, 0.6), st.just(math.nan))] * 2)
POSTURES = st.integers(0, ROBOT.n_joints - 1).flatmap(
    lambda joint: st.tuples(st.just(joint), st.floats(-2.0, 2.0))
)
ACTIONS: st.SearchStrategy[Action] = st.one_of(
    st.tuples(st.just('turn'), ANGLES),
    st.tuples(st.just('stop'), st.none()),
    st.tuples(st.just('reset'), st.none()),
    st.tuples(st.just('shift clock'), st.sampled_from([-100.0, -0.005, 0.04, 100.0])),
    st.tuples(st.just('bend robot'), POSTURES),
    st.tuples(st.just('turn robot'), st.floats(-7.0, 7.0)),
    st.tuples(st.just('yield'), OFFSETS),
    st.tuples(st.just('break joint_states'), st.sampled_from(['nan', 'short', 'silence'])),
    st.tuples(st.just('break odom'), st.sampled_from(['nan', 'silence'])),
    st.tuples(st.just('period'), st.sampled_from([4.5, 6.0, 0.1])),
    st.tuples(st.just('gait'), st.sampled_from(['omega', 'offset', 'geometric'])),
)
SEQUENCES = st.lists(st.tuples(ACTIONS, st.integers(1, 100)), min_size=3, max_size=8)


def with_nan(message: Any) -> Any:
    """Put NaN where it hurts."""
    if isinstance(message, JointState):
        message.position[5] = math.nan
    else:
        message.pose.pose.orientation.w = math.nan
    return message


def cut(message: JointState) -> JointState:
    message.position = message.position[:-1]
    return message


SPOILS: dict[str, Callable[[Any], Any]] = {'nan': with_nan, 'short': cut, 'silence': silence}


def act(turner: Turner, action: Action) -> None:
    """Do one thing to a turner."""
    robot, user = turner.robot, turner.user
    kind, value = action
    if kind == 'turn':
        user.turn(value)
    elif kind in ('stop', 'reset'):
        user.call(f'gait_node/{kind}')
    elif kind == 'shift clock':
        robot.time = max(robot.time + round(value * 1e9), 0)
    elif kind == 'bend robot':
        joint, angle = value
        robot.posture = robot.posture.copy()
        robot.posture[joint] = angle
    elif kind == 'turn robot':
        robot.heading += value
    elif kind == 'yield':
        robot.offsets = value
    elif kind.startswith('break'):
        robot.spoil[kind.split()[1]] = SPOILS[value]
    else:
        user.set_parameter('gait_node', kind, value)


@settings(max_examples=8, deadline=None)
@given(sequence=SEQUENCES)
def test_no_sequence_of_commands_and_faults_breaks_a_limit(
    domain_id: int, sequence: list[tuple[Action, int]]
) -> None:
    graph = Graph(domain_id, f'/faults_{os.getpid()}')
    try:
        turner = Turner(
            graph,
            clock=True,
            heading_feedback='odom',
            max_corrections=0,
            use_compliance=True,
        )
        turner.robot.offsets = (0.0, 0.0)
        turner.start_turn(1.0)
        for action, commands in sequence:
            act(turner, action)  # the watch fails the test at the first broken limit
            turner.wait_for_commands(commands)
            turner.robot.spoil.clear()
        # Whatever has happened, the node still does its work.
        turner.robot.offsets = (0.0, 0.0)
        turner.user.call('gait_node/reset')
        turner.user.turn(0.0)
        turner.wait_for_end()
        turner.start_turn(0.3)
        graph.spin_until(lambda: np.abs(turner.watch.newest).max() > 0.2, 'a new turn')
    finally:
        graph.close()
