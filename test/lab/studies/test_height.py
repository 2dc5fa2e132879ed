"""The height-function figure and its numbers."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from omega_turn_lab.studies.height import draw_height, height_rows
from omega_turn_ros.design.problem import DesignProblem
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.robot import load_robot

GAIT = TwoWaveGait(1.5, 1.0, -0.55, 0.05, -1.0, 0.7, -2.7, -3.0)
PROBLEM = DesignProblem.of_robot(load_robot('limbless16'), math.radians(90.0))


def test_turn_of_every_plane_is_told_three_ways() -> None:
    """Surface and loops are the line integral; the linear connection only nears the truth."""
    rows = height_rows(PROBLEM, GAIT)
    turn = math.degrees(PROBLEM.turn(PROBLEM.path(GAIT, 2000)))
    cases = {case for case, *_ in rows}
    assert len(cases) == 3
    for case in cases:
        found = {quantity: value for name, quantity, _, value in rows if name == case}
        assert found['surface'] + found['loops'] == pytest.approx(found['line'], abs=1.0)
        assert found['direct'] == pytest.approx(turn, abs=0.02)
        assert found['line'] == pytest.approx(turn, rel=0.25)
        assert 0.0 < found['misfit'] < 0.3
    assert {unit for *_, unit, _ in rows} == {'deg', '1'}


def test_figure_shows_the_colours_of_paths_heights_and_limits(tmp_path: Path) -> None:
    draw_height(PROBLEM, GAIT, tmp_path)
    with Image.open(tmp_path / 'height.png') as picture:
        assert picture.width >= 2000 and picture.height >= 1800
        pixels = np.asarray(picture.convert('RGB')).astype(int).reshape(-1, 3)
    for colour in ((31, 111, 208), (0, 0, 0), (185, 185, 185)):
        assert (np.abs(pixels - colour).max(axis=1) < 3).sum() > 1000
    red = (pixels[:, 0] > 150) & (pixels[:, 1:].max(axis=1) < 120)
    assert red.sum() > 1000


def test_gait_of_another_family_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match='gait'):
        height_rows(PROBLEM, load_gait('omega_fast').gait)
