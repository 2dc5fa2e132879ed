"""Start nodes as processes of their own, and read what they cost."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType

import psutil

import omega_turn_lab.ros_environment  # noqa: F401  (first: it may restart the interpreter)

BIN = Path(sys.executable).parent


class Processes:
    """Processes on one DDS domain, ended together."""

    def __init__(self, domain_id: int) -> None:
        self._env = {**os.environ, 'ROS_DOMAIN_ID': str(domain_id)}
        self._all: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Processes:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for process in self._all:
            process.terminate()
        for process in self._all:
            process.wait(timeout=10)

    def node(self, executable: str, **parameters: object) -> psutil.Process:
        """Start one of our nodes."""
        arguments = [str(BIN / executable), '--ros-args']
        for name, value in parameters.items():
            arguments += ['-p', f'{name}:={str(value).lower()}']
        return self._start(arguments)

    def script(self, *arguments: str) -> psutil.Process:
        """Start a Python script with this interpreter."""
        return self._start([sys.executable, *arguments])

    def _start(self, arguments: list[str]) -> psutil.Process:
        process = subprocess.Popen(arguments, env=self._env, stdout=subprocess.DEVNULL)
        self._all.append(process)
        return psutil.Process(process.pid)


def cpu_seconds(process: psutil.Process) -> float:
    """CPU time a process has used [s]."""
    times = process.cpu_times()
    return times.user + times.system


def megabytes(process: psutil.Process) -> float:
    """Resident memory [MB]."""
    return process.memory_info().rss / 1e6


def wait_for(condition, timeout: float, what: str, spin=lambda: time.sleep(0.05)) -> None:
    """Wait for a condition or end the benchmark."""
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            sys.exit(f'waited {timeout:g} s in vain for {what}')
        spin()
