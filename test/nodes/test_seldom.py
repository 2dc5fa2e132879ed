"""Services the executor looks for now and then: they answer late, never not at all."""

from __future__ import annotations

import numpy as np
import pytest
from rclpy.node import Node
from ros_graph import Graph
from std_srvs.srv import Trigger
from turner import STEP, Turner

from omega_turn_ros.nodes import gait_node
from omega_turn_ros.nodes.seldom import ROUNDS_OPEN, SeldomGroup


def plain_node(**options: object) -> Node:
    return Node('plain', **options)


def test_only_what_is_prompt_is_looked_for_in_every_round(graph: Graph) -> None:
    node = graph.add(plain_node)
    stop = node.create_service(Trigger, 'stop', lambda request, response: response)
    group = SeldomGroup(node, (stop,), 10)
    others = [entity for entity in (*node.services, *node.waitables) if entity is not stop]
    assert len(others) > 7
    looks = []
    for _ in range(40):
        group.tick()
        assert stop.callback_group.can_execute(stop)
        (look,) = {entity.callback_group.can_execute(entity) for entity in others}
        looks.append(look)
    assert np.convolve(looks, np.ones(10), 'valid').tolist() == [float(ROUNDS_OPEN)] * 31


@pytest.mark.parametrize('every', [0, 1, ROUNDS_OPEN])
def test_at_slow_rates_everything_is_looked_for_in_every_round(graph: Graph, every: int) -> None:
    node = graph.add(plain_node)
    group = SeldomGroup(node, (), every)
    service = next(iter(node.services))
    for _ in range(5):
        assert group.can_execute(service)
        group.tick()


def test_a_seldom_callback_never_runs_beside_another_of_the_node(graph: Graph) -> None:
    node = graph.add(plain_node)
    timer = node.create_timer(1.0, lambda: None)
    group = SeldomGroup(node, (), 10)
    service = next(iter(node.services))
    assert timer.callback_group.beginning_execution(timer)
    assert not group.can_execute(service)
    assert not group.beginning_execution(service)
    timer.callback_group.ending_execution(timer)
    assert group.beginning_execution(service)
    assert not timer.callback_group.can_execute(timer)
    group.ending_execution(service)


def test_parameters_can_be_set_while_simulated_time_stands_still(graph: Graph) -> None:
    turner = Turner(graph, clock=True)
    in_between = round(gait_node.SELDOM / STEP) + ROUNDS_OPEN + 3
    turner.wait_for_commands(in_between)
    turner.robot.obey = lambda target, stamp: None  # type: ignore[method-assign]
    turner.robot._advance = lambda: None  # type: ignore[method-assign]
    assert turner.user.set_parameter('gait_node', 'period', 5.0).successful
    assert turner.user.get_parameters('gait_node', ['period']) == [5.0]
