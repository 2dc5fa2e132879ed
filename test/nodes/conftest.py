"""A graph of its own for every node test."""

from __future__ import annotations

import fcntl
import itertools
import os
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest
from ros_graph import Graph
from turner import Turner

from omega_turn_ros.nodes import admittance_node, gait_node
from omega_turn_sim_bridge import bridge_node

# Up to domain 101 DDS uses ports below Linux's ephemeral ones.
DOMAINS = 101
_count = itertools.count()


@pytest.fixture(scope='session')
def domain_id() -> Iterator[int]:
    """A domain that no other test run on this machine uses at the same time."""
    for attempt in range(DOMAINS):
        domain = 1 + (os.getpid() + attempt) % DOMAINS
        with (Path(tempfile.gettempdir()) / f'omega_turn_domain_{domain}.lock').open('w') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield domain
            return
    pytest.fail(f'all {DOMAINS} domains are in use')


@pytest.fixture
def namespace() -> str:
    """Keeps the tests of a run apart, and runs that meet on one domain."""
    return f'/run_{os.getpid()}_{next(_count)}'


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
