"""Grounds seen from above, and pictures of turns on them."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from PIL.GifImagePlugin import GifImageFile

pytest.importorskip('pybullet')

from omega_turn_lab.animation import animate_turn
from omega_turn_lab.cli import main
from omega_turn_lab.ground_view import GroundView, view_ground
from omega_turn_lab.pictures import draw_turn
from omega_turn_lab.run_record import RunRecord
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_sim_bridge.peg_lattice import peg_positions
from omega_turn_sim_bridge.terrain_config import TerrainConfig

PEGS = TerrainConfig('pegboard', spacing_bl=0.3)


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='module')
def still(robot: Robot) -> RunRecord:
    joints = np.zeros((2, robot.n_joints))
    return RunRecord(np.array([0.0, 1.0]), np.zeros((2, 3)), joints, joints, np.zeros(2))


def test_pegs_are_circles_where_the_bridge_puts_them(robot: Robot) -> None:
    view = view_ground(PEGS, robot, 3)
    pegs = peg_positions(PEGS, robot, 3)
    assert len(view.obstacles) == len(pegs)
    for outline, peg in zip(view.obstacles, pegs):
        np.testing.assert_allclose(np.hypot(*(outline - peg).T), PEGS.peg_radius)
    assert '0.3 BL' in view.title and not view.grainy


def test_rocks_are_convex_outlines_of_their_size(robot: Robot) -> None:
    terrain = TerrainConfig('rocks', extent_bl=0.4)
    view = view_ground(terrain, robot, 0)
    assert view.carries
    across = np.array([np.ptp(outline, axis=0).max() for outline in view.obstacles])
    rock = terrain.rock_size_bl * robot.length
    large = across > 0.7 * rock
    assert across[large].mean() == pytest.approx(rock, rel=0.25)
    assert across[~large].mean() == pytest.approx(terrain.rock_fill * rock, rel=0.25)
    for outline in view.obstacles:
        x, y = (np.roll(outline, -1, axis=0) - outline).T
        assert (x * np.roll(y, -1) - y * np.roll(x, -1) > 0.0).all()


def test_grains_lie_evenly_and_stay_where_they_are_whatever_the_view(robot: Robot) -> None:
    view = view_ground(TerrainConfig('granular'), robot, 0)
    low, high = np.array([-0.31, 0.2]), np.array([0.5, 0.9])
    grains = view.grains(low, high)
    assert np.all(grains > low - 0.03) and np.all(grains < high + 0.03)
    counts = np.histogram2d(*grains.T, bins=4)[0]
    assert counts.min() > 0.6 * counts.mean()
    wider = view.grains(low - 1.0, high + 1.0)
    assert {tuple(p) for p in grains.tolist()} <= {tuple(p) for p in wider.tolist()}


def test_level_ground_shows_nothing(robot: Robot) -> None:
    view = view_ground(TerrainConfig(), robot, 0)
    assert view == GroundView()
    assert view.grains(np.zeros(2), np.ones(2)).size == 0


def test_what_stands_there_is_seen_and_does_not_widen_the_view(
    still: RunRecord, robot: Robot, tmp_path: Path
) -> None:
    seen = {}
    for kind in ('flat', 'pegboard', 'granular'):
        view = view_ground(TerrainConfig(kind), robot, 0)
        draw_turn(still, robot, 10.0, tmp_path / f'{kind}.png', view)
        animate_turn(still, robot, tmp_path / f'{kind}.gif', ground=view)
        with GifImageFile(tmp_path / f'{kind}.gif') as picture:
            pixels = np.asarray(picture.convert('RGB')).astype(int)
        seen[kind] = [
            int((np.abs(pixels - colour).max(axis=2) < 12).sum())
            for colour in ((224, 112, 44), (143, 136, 124), (217, 201, 168))  # head, peg, grain
        ]
    assert seen['flat'][0] == seen['pegboard'][0] == seen['granular'][0] > 100
    assert seen['pegboard'][1] > 500 + seen['flat'][1]
    assert seen['granular'][2] > 500 + seen['flat'][2]


@pytest.mark.slow
def test_demo_turns_among_pegs_through_the_live_nodes(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip('rclpy')
    command = '--terrain pegboard --spacing 0.4 --compliance on --turn-deg 8 --period 5 --seed 2'
    code = main(['demo', *command.split(), '--heading-feedback', 'none', '--out', str(tmp_path)])
    said = capfd.readouterr()
    assert code == 0
    assert 'terrain pegboard' in said.err + said.out
    result = json.loads((tmp_path / 'turn.json').read_text())
    assert (result['terrain'], result['spacing_bl']) == ('pegboard', 0.4)
    assert result['compliance'] is True
    assert math.isfinite(result['turn_deg_achieved'])
    assert (tmp_path / 'turn.png').is_file() and (tmp_path / 'turn.mcap').is_file()
