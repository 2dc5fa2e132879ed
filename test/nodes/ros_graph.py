"""A small ROS graph and whoever uses it: what every node test stands on.

All nodes of a test share one executor that the test spins by hand, so nothing runs between two
lines of a test, and an error inside a callback is the test's error.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import SetParametersResult
from rclpy.client import Client
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

AnyNode = TypeVar('AnyNode', bound=Node)

PATIENCE = 30.0  # [s] a test waits for something before it fails
DEEP = QoSProfile(depth=10_000)  # a listener that misses nothing
LATCHED = QoSProfile(depth=10_000, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Graph:
    """Nodes in one context and one executor.

    Args:
        domain_id: of the context.
        namespace: of every node.
    """

    def __init__(self, domain_id: int, namespace: str) -> None:
        self.domain_id, self.namespace = domain_id, namespace
        self.context = Context()
        rclpy.init(args=[], context=self.context, domain_id=domain_id)
        self.executor = SingleThreadedExecutor(context=self.context)
        self._nodes: list[Node] = []

    def add(self, make: Callable[..., AnyNode], below: str = '', **parameters: Any) -> AnyNode:
        """Make a node with these parameters in the namespace `below` the graph's own."""
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        namespace = f'{self.namespace}/{below}' if below else self.namespace
        node = make(context=self.context, namespace=namespace, parameter_overrides=overrides)
        self._nodes.append(node)
        self.executor.add_node(node)
        return node

    def remove(self, node: Node) -> None:
        """Take a node off the graph, as if its process had ended."""
        self.executor.remove_node(node)
        self._nodes.remove(node)
        node.destroy_node()

    def spin_until(
        self, done: Callable[[], object], what: str, patience: float = PATIENCE
    ) -> None:
        """Run callbacks until `done`; fail the test when that takes longer than patience [s]."""
        deadline = time.monotonic() + patience
        while not done():
            assert time.monotonic() < deadline, f'waited {patience:g} s in vain for {what}'
            self.executor.spin_once(timeout_sec=0.05)

    def names(self) -> list[str]:
        """Return the names of all nodes on the domain, those of other processes included."""
        return list(self._nodes[0].get_node_names())

    def close(self) -> None:
        """Destroy everything."""
        self.executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        self.context.shutdown()


class User:
    """Whoever uses the robot: sends on every topic, hears the answers.

    Attributes:
        health: newest diagnostics per node name.
        remaining: all that was said on `turn_remaining` [rad].

    Args:
        graph: the graph to live on.
        below: namespace of the robot.
    """

    def __init__(self, graph: Graph, below: str = '') -> None:
        self._graph = graph
        self.node = graph.add(_user_node, below)
        self._publishers: dict[str, Publisher] = {}
        self._clients: dict[str, Client] = {}
        self._parameter_clients: dict[str, AsyncParameterClient] = {}
        self.health: dict[str, DiagnosticStatus] = {}
        self.remaining: list[float] = []
        self.node.create_subscription(DiagnosticArray, 'diagnostics', self._on_health, DEEP)
        self.node.create_subscription(
            Float64, 'turn_remaining', lambda said: self.remaining.append(said.data), LATCHED
        )

    def hear(self, message_type: type, topic: str, qos: QoSProfile = DEEP) -> list[Any]:
        """Return a list that grows by every message of the topic from now on."""
        heard: list[Any] = []
        self.node.create_subscription(message_type, topic, heard.append, qos)
        return heard

    def publisher(self, topic: str, message_type: type) -> Publisher:
        """Return the publisher of a topic once somebody listens to it."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(message_type, topic, DEEP)
        publisher = self._publishers[topic]
        self._graph.spin_until(publisher.get_subscription_count, f'a listener to {topic}')
        return publisher

    def send(self, topic: str, message: Any) -> None:
        """Publish one message once somebody listens."""
        self.publisher(topic, type(message)).publish(message)

    def turn(self, angle: float) -> None:
        """Publish a turn angle [rad]."""
        self.send('turn_angle', Float64(data=float(angle)))

    def call(self, service: str, succeeds: bool = True) -> Trigger.Response:
        """Call a Trigger service and check that it succeeded, or did not."""
        if service not in self._clients:
            self._clients[service] = self.node.create_client(Trigger, service)
        client = self._clients[service]
        self._graph.spin_until(client.service_is_ready, f'service {service}')
        response = self._answer(client.call_async(Trigger.Request()), service)
        assert response.success is succeeds
        return response

    def set_parameter(self, node: str, name: str, value: Any) -> SetParametersResult:
        """Change a parameter as `ros2 param set` does."""
        client = self._parameter_client(node)
        answer = client.set_parameters([Parameter(name, value=value)])
        (result,) = self._answer(answer, node).results
        return result

    def get_parameters(self, node: str, names: list[str]) -> list[Any]:
        """Read parameters as `ros2 param get` does."""
        answer = self._answer(self._parameter_client(node).get_parameters(names), node)
        return [parameter_value_to_python(value) for value in answer.values]

    def fact(self, node: str, key: str) -> str:
        """Return what the next diagnostics of a node say about `key`, '' for nothing."""
        self.health.pop(node, None)
        self._graph.spin_until(lambda: node in self.health, f'diagnostics of {node}')
        return next((e.value for e in self.health[node].values if e.key == key), '')

    def refused(self, node: str, topic: str) -> int:
        """Return how many messages of a topic a node has dropped, by its next diagnostics."""
        return int(self.fact(node, f'refused {topic}') or 0)

    def wait_for_fact(self, node: str, key: str, wanted: str) -> None:
        """Wait until the diagnostics of a node say `wanted` about `key`."""
        self._graph.spin_until(lambda: self.fact(node, key) == wanted, f'{node}: {key} = {wanted}')

    def wait_for_problem(self, node: str, text: str) -> None:
        """Wait until the diagnostics of a node complain with these words."""
        self._graph.spin_until(
            lambda: node in self.health and text in self.health[node].message, f'{node}: {text}'
        )
        assert self.health[node].level == DiagnosticStatus.WARN

    def _parameter_client(self, node: str) -> AsyncParameterClient:
        if node not in self._parameter_clients:
            self._parameter_clients[node] = AsyncParameterClient(self.node, node)
        client = self._parameter_clients[node]
        self._graph.spin_until(client.services_are_ready, f'parameters of {node}')
        return client

    def _answer(self, future: Any, what: str) -> Any:
        self._graph.spin_until(future.done, f'an answer from {what}')
        return future.result()

    def _on_health(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.health[status.name.rsplit('/', 1)[-1]] = status


def _user_node(**options: Any) -> Node:
    return Node('user', **options)
