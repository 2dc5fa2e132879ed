"""A graph of its own for every node test."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterator
from functools import partial

import pytest
from ros_graph import Graph
from turner import Turner

from omega_turn_ros.nodes import admittance_node, gait_node
from omega_turn_sim_bridge import bridge_node

# Up to domain 101 DDS uses ports below Linux's ephemeral ones.
DOMAINS = 101
_count = itertools.count()


@pytest.fixture
def domain_id() -> int:
    """A domain no other test of this process uses at the same time."""
    return 1 + (os.getpid() + next(_count)) % DOMAINS


@pytest.fixture
def namespace(domain_id: int) -> str:
    """Keeps two test runs apart that meet on one domain."""
    return f'/run_{os.getpid()}_{domain_id}'


@pytest.fixture
def graph(domain_id: int, namespace: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    """A graph whose nodes report their health often, so that tests need not wait for it."""
    for module in (gait_node, admittance_node, bridge_node):
        monkeypatch.setattr(module, 'PUBLISH_EVERY', 0.05)
    made = Graph(domain_id, namespace)
    yield made
    made.close()


@pytest.fixture
def make_turner(graph: Graph) -> Callable[..., Turner]:
    """Makes a gait node with a fake robot, a user and a watch on its commands."""
    return partial(Turner, graph)
