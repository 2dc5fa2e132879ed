"""A node that is ticked on time, and answers besides."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from ros_graph import Graph, User
from std_srvs.srv import Trigger
from turner import Turner

from omega_turn_ros.nodes.gait_node import GaitNode
from omega_turn_ros.nodes.pacing import Paced, answer_now, spin_paced

PERIOD = 0.01  # [s]


class Ticker:
    """Notes when it was ticked; the first tick of `slow` takes 5 periods."""

    tick_period = PERIOD

    def __init__(self, count: int, slow: bool = False) -> None:
        self.times: list[float] = []
        self.ended = threading.Event()
        self._count, self._slow = count, slow

    def tick(self) -> None:
        self.times.append(time.monotonic())
        if self._slow and len(self.times) == 1:
            time.sleep(5.0 * PERIOD)
        if len(self.times) == self._count:
            self.ended.set()


@pytest.fixture
def executor(graph: Graph) -> SingleThreadedExecutor:
    return SingleThreadedExecutor(context=graph.add(_plain).context)


def test_ticks_come_no_sooner_than_their_period_in_the_mean(
    executor: SingleThreadedExecutor,
) -> None:
    ticker = Ticker(30)
    spin_paced(ticker, PERIOD, executor, ticker.ended)
    assert len(ticker.times) == 30
    assert ticker.times[-1] - ticker.times[0] >= 28.5 * PERIOD


def test_missed_ticks_are_not_made_up_for(executor: SingleThreadedExecutor) -> None:
    ticker = Ticker(4, slow=True)
    spin_paced(ticker, PERIOD, executor, ticker.ended)
    first, second, third, _ = ticker.times
    assert second - first >= 5.0 * PERIOD
    assert third - second >= 0.3 * PERIOD


def test_what_else_the_node_does_gets_its_turn(graph: Graph) -> None:
    node = graph.add(_plain)
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    ticker = Ticker(10_000)
    node.create_timer(0.05, ticker.ended.set)
    spin_paced(ticker, PERIOD, executor, ticker.ended)
    assert 2 <= len(ticker.times) < 10_000
    executor.shutdown()


def test_a_call_is_answered_once_and_without_an_executor(graph: Graph) -> None:
    calls = []

    def on_call(request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        calls.append(request)
        response.message = 'heard'
        return response

    server = Node('server', context=graph.add(_plain).context)
    service = server.create_service(Trigger, 'prompt', on_call)
    client = graph.add(_plain, 'other').create_client(Trigger, '/prompt')
    graph.spin_until(client.service_is_ready, 'the service')
    answer_now(service)
    assert not calls
    future = client.call_async(Trigger.Request())

    def answered() -> bool:
        answer_now(service)
        return bool(future.done())

    graph.spin_until(answered, 'an answer')
    assert future.result().message == 'heard'
    assert len(calls) == 1
    server.destroy_node()


@pytest.mark.parametrize(
    ('parameters', 'paced'),
    [({}, True), ({'lock_step': True}, False), ({'use_sim_time': True}, False)],
)
def test_gait_node_is_ticked_where_the_wall_clock_drives_it(
    graph: Graph, parameters: dict[str, bool], paced: bool
) -> None:
    node = graph.add(_paced_node, **parameters)
    assert isinstance(node, Paced)
    assert (node.tick_period == pytest.approx(PERIOD)) is paced
    timers = {round(timer.timer_period_ns * 1e-9, 6) for timer in node.timers}
    assert (PERIOD in timers) is ('use_sim_time' in parameters)


def test_gait_node_that_nobody_ticks_has_a_timer(graph: Graph) -> None:
    turner = Turner(graph, lock_step=False)
    assert turner.node.tick_period is None
    assert len(turner.wait_for_commands(3)) == 3


def test_stop_is_answered_by_the_next_tick(graph: Graph) -> None:
    node = graph.add(_paced_node)
    graph.executor.remove_node(node)  # only its ticks may answer
    user = User(graph)
    client = user.node.create_client(Trigger, 'gait_node/stop')
    graph.spin_until(client.service_is_ready, 'the service')
    future = client.call_async(Trigger.Request())

    def answered() -> bool:
        node.tick()
        return bool(future.done())

    graph.spin_until(answered, 'an answer')
    assert future.result().success


def _paced_node(**options: Any) -> GaitNode:
    return GaitNode(paced=True, **options)


def _plain(**options: Any) -> Node:
    return Node('plain', **options)
