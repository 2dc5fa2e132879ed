"""The nodes as processes of their own, to be signalled, killed and restarted."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from ros_graph import PATIENCE


def executable(name: str) -> str:
    """Path of an installed node: beside this Python, or where `ros2 run` looks."""
    places = [str(Path(sys.executable).parent)]
    for prefix in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        places.append(str(Path(prefix) / 'lib' / 'omega_turn_ros'))
    found = shutil.which(name, path=os.pathsep.join(places))
    assert found is not None, f'{name} is in none of {places}'
    return found


class Process:
    """One node in a process of its own.

    Args:
        domain_id: it joins.
        namespace: of the node.
        name: of the executable.
        parameters: of the node.
    """

    def __init__(self, domain_id: int, namespace: str, name: str, **parameters: Any) -> None:
        command = [executable(name), '--ros-args', '-r', f'__ns:={namespace}']
        for key, value in parameters.items():
            command += ['-p', f'{key}:={value}']
        self._stderr = tempfile.TemporaryFile()  # noqa: SIM115 (lives as long as the process)
        self._process = subprocess.Popen(
            command,
            env={**os.environ, 'ROS_DOMAIN_ID': str(domain_id)},
            stdout=subprocess.DEVNULL,
            stderr=self._stderr,
        )

    @property
    def stderr(self) -> str:
        """What it has said so far."""
        self._stderr.seek(0)
        return self._stderr.read().decode()

    @property
    def lives(self) -> bool:
        """Whether it still runs."""
        return self._process.poll() is None

    def end(self, number: signal.Signals, times: int = 1) -> int:
        """Send a signal, so many times at once, and return the exit code."""
        for _ in range(times):
            self._process.send_signal(number)
        return self.wait()

    def wait(self) -> int:
        """Wait for its end and return the exit code."""
        return self._process.wait(timeout=PATIENCE)

    def close(self) -> None:
        """End it, as gently as it lets itself be ended."""
        if self.lives:
            self._process.terminate()
            try:
                self.wait()
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._stderr.close()
