"""`omega_turn worm` as a user types it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from PIL.PngImagePlugin import PngImageFile

from omega_turn_lab.cli import main
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.two_wave import two_wave_angles

FPS = 32.0
SMALL = {
    'name': 'small',
    'joints': [{'name': f'j{i}', 'axis': 'yaw'} for i in range(5)],
    'module_length': 0.1,
    'module_width': 0.05,
    'head_length': 0.1,
    'module_mass': 0.2,
    'position_limit': 1.3,
    'velocity_limit': 3.0,
    'effort_limit': 2.0,
}


def kymograph(frames: int = 160, positions: int = 24, seed: int = 0) -> np.ndarray:
    """Two waves with changing amplitudes, k_t = 1 and k_f = 1.5, tail to head, and noise."""
    tau = 2.0 * np.pi * 0.6 * np.arange(frames) / FPS
    forward, turning = 0.3 * (0.2 + np.sin(tau + 1.5)), 0.4 * (1.0 + np.sin(tau + 0.3))
    angles = two_wave_angles(forward, tau + 1.0, turning, tau, 1.5, 1.0, positions)
    noise = np.random.default_rng(seed).normal(0.0, 0.01, angles.shape)
    return (angles + noise) * 24.0 / positions


def run(folder: Path, *arguments: object) -> dict[str, Any]:
    """Run the command; return its JSON file."""
    words = [str(word) for word in arguments]
    assert main(['worm', *words, '--fps', '32', '--out', str(folder / 'out')]) == 0
    record: dict[str, Any] = json.loads((folder / 'out' / 'worm.json').read_text())
    return record


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / 'made.npy'
    np.save(path, kymograph())
    return path


def row_of(record: dict[str, Any], case: str, quantity: str) -> dict[str, Any]:
    (row,) = (r for r in record['rows'] if (r['case'], r['quantity']) == (case, quantity))
    return row


def test_waves_are_printed_stored_and_drawn(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = run(tmp_path, file)
    said = capsys.readouterr().out
    assert 'made.npy: frames 0 to 159, 24 body positions' in said
    assert 'turning wave' in said and 'forward wave' in said
    for case, k in (('turning wave', 1.0), ('forward wave', 1.5)):
        row = row_of(record, case, 'k')
        assert row['measured'] == pytest.approx(k, abs=0.02)
        assert row['paper'] == k
        assert 0.0 < row['std'] < 0.1
    explained = row_of(record, '4 components', 'variance_explained')
    assert explained['measured'] > 0.99 and explained['paper'] == 0.8
    (trial,) = record['waves']['trials']
    assert trial['turning']['amplitude_rms'] == pytest.approx(0.4 * math.sqrt(1.5), rel=0.02)
    assert len(trial['forward']['phase']) == len(trial['scores']) == 160
    assert trial['residual_rms'] == pytest.approx(0.01, rel=0.2)
    assert len(record['components']) == 4 and len(record['components'][0]['shape']) == 24
    assert sum(record['variance']) == pytest.approx(1.0)
    assert record['gaits'] == []
    with PngImageFile(tmp_path / 'out' / 'worm.png') as picture:
        assert picture.width >= 2000
        pixels = np.asarray(picture.convert('RGB')).reshape(-1, 3).astype(int)
    for colour in ((0xD5, 0x5E, 0x00), (0x00, 0x72, 0xB2)):
        assert np.count_nonzero(np.abs(pixels - colour).max(axis=1) < 8) > 500


def test_the_same_worm_told_otherwise_gives_the_same_numbers(file: Path, tmp_path: Path) -> None:
    plain = run(tmp_path, file)['rows']
    table = np.load(file)
    time = np.arange(len(table)) / FPS
    other = tmp_path / 'other.csv'
    np.savetxt(other, np.column_stack([time, table[:, ::-1] * 24.0 / 0.9]), delimiter=';')
    flags = ['--kind', 'curvature', '--worm-length', 0.9, '--skip-columns', 1, '--tail-first']
    again = run(tmp_path, other, *flags)['rows']
    for one, two in zip(plain, again):
        assert two['measured'] == pytest.approx(one['measured'], abs=1e-5)
    np.save(tmp_path / 'side.npy', np.degrees(table).T)
    again = run(tmp_path, tmp_path / 'side.npy', '--transposed', '--degrees')['rows']
    assert [row['measured'] for row in again] == pytest.approx([r['measured'] for r in plain])


def test_several_trials_are_cut_filled_and_pooled(tmp_path: Path) -> None:
    tables = [kymograph(120, 24, 1), kymograph(100, 48, 2)]
    tables[0][60:63] = np.nan
    tables[1][:20] = np.nan
    for k, table in enumerate(tables):
        np.save(tmp_path / f'{k}.npy', table)
    files = [tmp_path / '0.npy', tmp_path / '1.npy']
    cuts = ['--from', 0, '--from', 20, '--to', 110, '--to', 100]
    record = run(tmp_path, *files, *cuts)
    first, second = record['recordings']
    assert first['frames'] == [0, 110] and first['filled_frames'] == [60, 61, 62]
    assert second['frames'] == [20, 100] and second['filled_frames'] == []
    assert first['positions'] == second['positions'] == 24
    assert row_of(record, 'forward wave', 'k')['measured'] == pytest.approx(1.5, abs=0.03)
    for trial in record['waves']['trials']:
        assert trial['own_k_t'] == pytest.approx(1.0, abs=0.05)


def test_only_the_turns_are_analysed_if_asked(file: Path, tmp_path: Path) -> None:
    record = run(tmp_path, file, '--find-turns', '--bend-deg', 220)
    turns = record['recordings'][0]['turns']
    assert turns and record['analysed'] == 'turns'
    frames = [trial['frames'] for trial in record['waves']['trials']]
    assert frames == [turn['frames'] for turn in turns]


def test_a_gait_of_the_worm_turns_a_robot(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = tmp_path / 'small.yaml'
    robot.write_text(yaml.safe_dump(SMALL))
    record = run(tmp_path, file, '--to-gait', '--robot', robot, '--gait-name', 'mine')
    (gait,) = record['gaits']
    entry = load_gait(str(tmp_path / 'out' / gait['file']))
    angle = gait['angle_deg']
    assert math.degrees(entry.calibration.largest_angle) == pytest.approx(
        angle['quasi_static'], abs=1e-3
    )
    assert entry.name == 'mine' and entry.robot == 'small' and entry.theta_max <= 1.3
    # a few degrees, counter-clockwise in both; small turns differ most between them
    assert 0.0 < angle['pybullet'] < angle['quasi_static'] + 5.0
    assert f'mine: {angle["quasi_static"]:.1f} deg per cycle' in capsys.readouterr().out
    assert gait['likeness'] > 0.95 and gait['clearance_m'] >= 0.0
    assert gait['cycle']['frames'][1] - gait['cycle']['frames'][0] == pytest.approx(54, abs=8)


@pytest.mark.parametrize(
    ('arguments', 'said'),
    [
        (['--from', '170'], 'error: frames: '),
        (['--from', '1', '--from', '2'], 'error: from: '),
        (['--fps', '-1'], 'error: fps: '),
        (['--components', '20'], 'error: components: '),
        (['--skip-columns', '24'], 'error: skip_columns: '),
        (['--find-turns', '--bend-deg', '900'], 'error: recordings: '),
        (['--seed', '-1'], 'error: seed: '),
        (['--robot', 'nosuch', '--to-gait'], 'error: robot: '),
        (['--out', '/proc/foo'], 'error: out: '),
    ],
)
def test_what_cannot_be_used_is_named(
    arguments: list[str],
    said: str,
    file: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    rest = [] if '--out' in arguments else ['--out', str(tmp_path / 'out')]
    assert main(['worm', str(file), '--fps', '32', *rest, *arguments]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / 'out' / 'worm.json').exists()


def test_a_gap_that_is_too_long_is_named_by_frame(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = np.load(file)
    table[80:95] = np.nan
    np.save(file, table)
    assert main(['worm', str(file), '--fps', '32', '--out', str(tmp_path / 'out')]) == 2
    assert "error: made.npy frame 80: got '15 frames without values'" in capsys.readouterr().err
    record = run(tmp_path, file, '--max-gap', 0.5)
    assert len(record['recordings'][0]['filled_frames']) == 15
