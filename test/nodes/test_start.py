"""How a node's process begins: early signals, and what ROS 2 refuses."""

from __future__ import annotations

import array
import subprocess
import sys
from pathlib import Path

import pytest
from rclpy.context import Context

from omega_turn_ros.errors import BadInputError, RosArgumentsError
from omega_turn_ros.nodes.parameters import ParameterSpec
from omega_turn_ros.nodes.runner import init_ros


@pytest.mark.parametrize('number', ['SIGINT', 'SIGTERM'])
def test_a_signal_before_the_heavy_imports_ends_the_process_cleanly(number: str) -> None:
    code = (
        'import signal, sys, omega_turn_ros.nodes.start, omega_turn_sim_bridge.start\n'
        'assert not {"numpy", "rclpy", "pybullet"} & set(sys.modules)\n'
        'omega_turn_ros.nodes.start.end_at_once()\n'
        f'signal.raise_signal(signal.{number})\n'
        'sys.exit("still here")'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, '')


@pytest.mark.parametrize(
    ('arguments', 'expected'),
    [
        (['--log-level', 'loud'], "Couldn't parse log level: '--log-level loud'"),
        (['--params-file', '/no/such.yaml'], 'Error opening YAML file'),
        (['--params-file', 'BROKEN'], 'Sequences'),
        (['--no-such-argument'], 'no-such-argument'),
    ],
)
def test_what_ros_refuses_is_one_line_without_places_in_its_source(
    tmp_path: Path, arguments: list[str], expected: str
) -> None:
    broken = tmp_path / 'broken.yaml'
    broken.write_text('a: [1, 2\n b: : :\n')
    given = [text.replace('BROKEN', str(broken)) for text in arguments]
    with pytest.raises(RosArgumentsError) as caught:
        init_ros(['--ros-args', *given], Context())
    said = str(caught.value)
    assert expected in said
    assert '\n' not in said and '.c:' not in said


def test_a_domain_that_is_no_number_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('ROS_DOMAIN_ID', 'abc')
    with pytest.raises(RosArgumentsError, match='ROS_DOMAIN_ID is not an integral number'):
        init_ros([], Context())


def test_refused_numbers_are_shown_as_a_list() -> None:
    spec = ParameterSpec('mass', [1.0, 1.0], 'Two numbers.')
    with pytest.raises(BadInputError, match=r'got \[1\.0\], expected 2 numbers'):
        spec.check(array.array('d', [1.0]))
