"""Style, types and package data are gates, not advice."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

import omega_turn_ros

ROOT = Path(__file__).parent.parent


@pytest.mark.parametrize(
    'command', [['ruff', 'check', '.'], ['ruff', 'format', '--check', '.'], ['mypy']], ids=' '.join
)
def test_tool_finds_nothing(command: list[str]) -> None:
    pytest.importorskip(command[0])
    done = subprocess.run(
        [sys.executable, '-m', *command], cwd=ROOT, capture_output=True, text=True, timeout=280
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_one_version_everywhere() -> None:
    package = ElementTree.parse(ROOT / 'package.xml').getroot().findtext('version')
    (setup,) = re.findall(r"version='([^']+)'", (ROOT / 'setup.py').read_text())
    assert package == setup == omega_turn_ros.__version__
    assert f'\n{package} (' in (ROOT / 'CHANGELOG.rst').read_text()


def test_every_package_folder_is_installed() -> None:
    setup = (ROOT / 'setup.py').read_text()
    for top in ('omega_turn_ros', 'omega_turn_sim_bridge', 'omega_turn_lab'):
        for init in (ROOT / top).rglob('__init__.py'):
            name = '.'.join(init.parent.relative_to(ROOT).parts)
            assert f"'{name}'" in setup, name
