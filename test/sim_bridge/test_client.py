"""Physics clients, with a window or without."""

from __future__ import annotations

import sys

import pytest

from omega_turn_ros.errors import SimulationError
from omega_turn_sim_bridge.client import open_client
from omega_turn_sim_bridge.engine import pybullet


def test_clients_are_apart() -> None:
    first, second = open_client(False, 1.0), open_client(False, 1.0)
    assert first != second
    for client in (first, second):
        pybullet.disconnect(physicsClientId=client)


@pytest.mark.skipif(sys.platform != 'linux', reason='elsewhere windows need no DISPLAY')
def test_a_window_without_a_display_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv('DISPLAY', raising=False)
    with pytest.raises(SimulationError, match='DISPLAY'):
        open_client(True, 1.0)
