"""`omega_turn design` as a user types it."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from omega_turn_lab.cli import main
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.resources import read_config

SMALL = {
    'name': 'small',
    'joints': [{'name': f'j{i}', 'axis': 'yaw'} for i in range(4)],
    'module_length': 0.1,
    'module_width': 0.05,
    'head_length': 0.1,
    'module_mass': 0.2,
    'position_limit': 1.3,
    'velocity_limit': 3.0,
    'effort_limit': 2.0,
}


def robot_file(folder: Path, **changes: object) -> str:
    path = folder / 'robot.yaml'
    path.write_text(yaml.safe_dump({**SMALL, **changes}))
    return str(path)


def test_design_prints_and_stores_a_gait_the_library_loads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ['--robot', robot_file(tmp_path), '--theta-max-deg', '60', '--name', 'mine']
    assert main(['design', *arguments, '--out', str(tmp_path)]) == 0
    entry = load_gait(str(tmp_path / 'mine.yaml'))
    printed = capsys.readouterr().out
    assert 'mine: ' in printed and 'stopped by' in printed
    assert entry.robot == 'small' and entry.calibration.n_joints == 4
    assert entry.theta_max <= 1.0472 + 1e-4


@pytest.mark.parametrize(
    ('changes', 'arguments', 'named'),
    [
        ({'module_length': 0.0}, [], 'module_length'),
        ({'joints': SMALL['joints'][:1]}, [], 'joints'),
        ({'position_limit': 0.001}, [], 'theta_max'),
        ({}, ['--theta-max-deg', '90'], 'theta_max'),
        ({}, ['--theta-max-deg', '60', '--k-t', '7'], 'k_t'),
        ({}, ['--theta-max-deg', '60', '--method', 'magic'], 'method'),
    ],
)
def test_a_robot_that_cannot_turn_is_refused_by_name(
    changes: dict[str, object],
    arguments: list[str],
    named: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    robot = robot_file(tmp_path, **changes)
    assert main(['design', '--robot', robot, *arguments, '--out', str(tmp_path)]) == 2
    assert f'error: {named}' in capsys.readouterr().err
    assert list(tmp_path.glob('*.yaml')) == [tmp_path / 'robot.yaml']


def test_the_shipped_library_is_designed_for_the_shipped_robot() -> None:
    for name in ('omega', 'offset', 'geometric', 'omega_fast'):
        assert read_config('gaits', name)['robot'] == 'limbless16'


@pytest.mark.parametrize(
    ('arguments', 'named'),
    [
        (['--theta-max-deg', '0'], 'theta_max'),
        (['--name', '../evil'], '--name'),
        (['--name', 'a/b'], '--name'),
        (['--all', '--k-t', '99'], '--k-t'),
        (['--all', '--method', 'direct'], '--method'),
    ],
)
def test_what_would_do_something_else_than_asked_is_refused_before_any_search(
    arguments: list[str], named: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(['design', *arguments, '--out', str(tmp_path / 'gaits')]) == 2
    assert named in capsys.readouterr().err
    assert not list(tmp_path.rglob('*.yaml'))


@pytest.mark.parametrize('seed', ['-1', '5000000', 'x'])
def test_a_seed_no_search_can_use_is_refused(seed: str) -> None:
    for command in (['design'], ['reproduce', 'flat']):
        with pytest.raises(SystemExit) as ended:
            main([*command, '--seed', seed])
        assert ended.value.code == 2
