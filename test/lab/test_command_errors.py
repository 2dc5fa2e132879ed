"""What `omega_turn` says to arguments it cannot use: one line, exit code 2."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from omega_turn_lab.cli import main
from omega_turn_ros.resources import config_root, read_config


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Return what a command says that must end with exit code 2."""
    try:
        code: object = main(arguments)
    except SystemExit as ending:
        code = ending.code
    assert code == 2
    return capsys.readouterr().err


@pytest.mark.parametrize(
    ('arguments', 'expected'),
    [
        (['--gait', 'nosuch'], "error: gait: got 'nosuch', expected a path"),
        (['--robot', 'nosuch'], "error: robot: got 'nosuch', expected a path"),
        (['--terrain', 'nosuch'], "error: terrain: got 'nosuch', expected a path"),
        (['--spacing', '0.3'], 'error: --spacing: got 0.3, expected a terrain with pegs'),
        (['--terrain', 'pegboard', '--spacing', '0'], 'error: terrain spacing_bl: got 0.0'),
        (['--turn-deg', '1e6'], '--turn-deg: 1e6: expected less than 1e6 deg'),
        (['--turn-deg', 'left'], '--turn-deg: left: expected a number [deg]'),
        (['--out', '/dev/null/out'], "error: out: got '/dev/null/out', expected a folder"),
        (['--out', '/proc/foo'], "error: out: got '/proc/foo', expected a folder"),
    ],
)
def test_demo_names_what_it_cannot_use(
    arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert expected in refused(['demo', *arguments], capsys)


def test_demo_says_how_a_file_differs_from_a_gait_file(
    capsys: pytest.CaptureFixture[str],
) -> None:
    robot = str(config_root() / 'robots' / 'limbless16.yaml')
    said = refused(['demo', '--gait', robot], capsys)
    assert f"error: gait: got '{robot}', expected a gait file (unknown: " in said
    assert ', missing: calibration ' in said


def test_demo_says_how_to_get_a_gait_for_another_number_of_joints(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    data = read_config('robots', 'limbless16')
    path = tmp_path / 'six.yaml'
    path.write_text(yaml.safe_dump({**data, 'name': 'six', 'joints': data['joints'][:12]}))
    said = refused(['demo', '--robot', str(path), '--out', str(tmp_path / 'out')], capfd)
    assert "gait: got 'omega', expected one for the 6 yaw joints of six, not 8: " in said
    assert 'omega_turn design --all --robot' in said


def test_pybullet_is_imported_without_its_build_time_but_not_without_other_words() -> None:
    code = (
        'import omega_turn_sim_bridge.simulation, os; '
        'from omega_turn_sim_bridge.engine import _without_noise\n'
        'with _without_noise(): os.write(2, b"pybullet build time: now\\nreal trouble\\n")'
    )
    done = subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, timeout=60, check=True
    )
    assert (done.stdout, done.stderr) == ('', 'real trouble\n')
