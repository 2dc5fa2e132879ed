"""Pictures of a real turn, made by the quasi-static model."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL.GifImagePlugin import GifImageFile
from PIL.PngImagePlugin import PngImageFile

from omega_turn_lab.animation import MAX_FRAMES, animate_turn
from omega_turn_lab.body_shapes import body_polygons, module_polygons, nice_step
from omega_turn_lab.pictures import draw_turn
from omega_turn_lab.run_record import RunRecord
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.trajectory import pose_along
from omega_turn_ros.robot import Robot, load_robot

OMEGA = TwoWaveGait(1.5, 1.0, 0.59, 0.0, -1.02, -0.78, -2.75, -3.07)
LARGEST_GIF = 2_000_000  # [bytes]
HEAD_COLOUR = (224, 112, 44)


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='module')
def record(robot: Robot) -> RunRecord:
    """One omega turn of +94 deg in 4 s."""
    phase = np.linspace(0.0, 2.0 * np.pi, 121)
    yaw = OMEGA.mirrored().angles(phase, robot.n_yaw)
    pose = pose_along(PlanarChain.of_robot(robot), yaw)
    joints = np.zeros((phase.size, robot.n_joints))
    joints[:, robot.yaw_indices] = yaw
    remaining = pose[-1, 2] - pose[:, 2]
    return RunRecord(4.0 * phase / phase[-1], pose, joints, joints, remaining)


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_the_figure_is_a_wide_picture_with_start_and_end_in_their_colours(
    record: RunRecord, robot: Robot, tmp_path: Path
) -> None:
    path = tmp_path / 'out' / 'turn.png'
    draw_turn(record, robot, 90.0, path)
    with PngImageFile(path) as picture:
        assert picture.width >= 1200 and picture.width > picture.height
        pixels = np.asarray(picture.convert('RGB')).reshape(-1, 3).astype(int)
    for colour in ((0x1F, 0x62, 0xB0), (0xC4, 0x1A, 0x1A)):
        assert np.count_nonzero(np.abs(pixels - colour).max(axis=1) < 8) > 2000


def test_the_title_keeps_one_decimal(
    record: RunRecord, robot: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    titles: list[str] = []
    monkeypatch.setattr(Figure, 'suptitle', lambda self, text, **_: titles.append(text))
    draw_turn(record, robot, -135.0, tmp_path / 'turn.png')
    assert 'commanded \N{MINUS SIGN}135.0°, achieved ' in titles[0]


def test_a_turn_the_other_way_and_one_that_never_moves_are_drawn_too(
    record: RunRecord, robot: Robot, tmp_path: Path
) -> None:
    mirror = np.array([1.0, -1.0, -1.0])
    other = replace(record, pose=record.pose * mirror, joint_positions=-record.joint_positions)
    still = RunRecord(
        np.array([0.0, 1.0]), np.zeros((2, 3)), np.zeros((2, 16)), np.zeros((2, 16)), np.zeros(2)
    )
    for name, run in (('other', other), ('still', still)):
        draw_turn(run, robot, -90.0, tmp_path / f'{name}.png')
        animate_turn(run, robot, tmp_path / f'{name}.gif')
        assert (tmp_path / f'{name}.png').stat().st_size > 10_000
        assert (tmp_path / f'{name}.gif').stat().st_size > 1000


def test_the_animation_lasts_as_long_as_the_run_and_stays_small(
    record: RunRecord, robot: Robot, tmp_path: Path
) -> None:
    path = tmp_path / 'turn.gif'
    animate_turn(record, robot, path)
    assert path.stat().st_size < LARGEST_GIF
    with GifImageFile(path) as picture:
        frames = picture.n_frames
        assert picture.size == (480, 480)
        durations = []
        for k in range(frames - 1):
            picture.seek(k)
            durations.append(picture.info['duration'])
        assert 1e-3 * sum(durations) == pytest.approx(4.0, abs=0.1)
        assert 45 <= frames <= 60


def test_a_long_run_is_shown_faster_instead_of_in_more_frames(
    record: RunRecord, robot: Robot, tmp_path: Path
) -> None:
    path = tmp_path / 'turn.gif'
    animate_turn(replace(record, time=record.time * 20.0), robot, path)
    assert path.stat().st_size < LARGEST_GIF
    with GifImageFile(path) as picture:
        assert 100 < picture.n_frames <= MAX_FRAMES


def test_the_head_is_seen_where_the_pose_has_it(
    record: RunRecord, robot: Robot, tmp_path: Path
) -> None:
    path = tmp_path / 'turn.gif'
    animate_turn(record, robot, path)
    seen = []
    with GifImageFile(path) as picture:
        for k in (0, picture.n_frames - 1):
            picture.seek(k)
            pixels = np.asarray(picture.convert('RGB')).astype(int)
            rows, columns = np.nonzero(np.abs(pixels - HEAD_COLOUR).max(axis=2) < 12)
            seen.append((columns.mean(), -rows.mean()))
    yaw = record.joint_positions[[0, -1]][:, robot.yaw_indices]
    outline = PlanarChain.of_robot(robot).outline(yaw, record.pose[[0, -1]])
    heads = outline[:, 0] + 0.5 * robot.head_length * np.array(
        [(p[1] - p[0]) / np.linalg.norm(p[1] - p[0]) for p in outline]
    )
    moved_seen = np.subtract(seen[1], seen[0])
    moved = heads[1] - heads[0]
    cosine = moved_seen @ moved / np.linalg.norm(moved_seen) / np.linalg.norm(moved)
    assert cosine > 0.999


def test_a_straight_body_covers_its_length_and_width(robot: Robot) -> None:
    outline = PlanarChain.of_robot(robot).outline(np.zeros(8), (0.3, -0.2, 0.0))
    corners = body_polygons(outline, robot.module_width).reshape(-1, 2)
    assert np.ptp(corners, axis=0) == pytest.approx([robot.length, robot.module_width])
    modules = module_polygons(outline, robot)
    assert modules.shape[0] == robot.n_joints + 1
    assert np.ptp(modules[0, :, 0]) == pytest.approx(robot.head_length, rel=0.05)
    assert np.ptp(modules[5, :, 0]) == pytest.approx(robot.module_length, rel=0.1)
    assert all(area(polygon) > 0.0 for polygon in (*modules, *body_polygons(outline, 0.05)))


def test_a_grid_step_is_a_round_number() -> None:
    steps = [nice_step(v) for v in (0.013, 0.2, 0.21, 0.7, 3.0)]
    assert steps == pytest.approx([0.02, 0.2, 0.5, 1.0, 5.0])


def test_a_record_of_another_robot_is_refused_by_name(record: RunRecord, robot: Robot) -> None:
    short = replace(
        record,
        joint_positions=record.joint_positions[:, :8],
        joint_commands=record.joint_commands[:, :8],
    )
    with pytest.raises(BadInputError, match='joint_positions'):
        draw_turn(short, robot, 90.0, Path('never.png'))
    with pytest.raises(BadInputError, match='speed'):
        animate_turn(record, robot, Path('never.gif'), speed=0.0)


def test_importing_the_module_leaves_matplotlib_and_pillow_alone() -> None:
    code = (
        'import sys, omega_turn_lab.animation, omega_turn_lab.pictures; '
        'print([m for m in ("matplotlib", "PIL", "rclpy") if m in sys.modules])'
    )
    done = subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, timeout=120, check=True
    )
    assert done.stdout.strip() == '[]'
