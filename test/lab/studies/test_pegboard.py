"""What the pegboard study makes of its trials."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL.PngImagePlugin import PngImageFile

from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_lab.studies.pegboard import MODES, OPEN, SPACINGS_BL, STUDY
from omega_turn_lab.studies.rows import Row, write_json
from omega_turn_lab.studies.run import ROBOT
from omega_turn_lab.studies.study import Outcome, Plan
from omega_turn_lab.studies.tasks import Task
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.robot import load_robot

GAIN = 12.0  # [deg] of every compliant mode in the made-up trials


def made_up(task: Task) -> dict[str, Any]:
    """Angles that grow with the spacing and differ by placement."""
    assert isinstance(task, ObstacleTrial)
    angle = 100.0 * task.terrain.spacing_bl + task.seed % 5
    angle += 0.0 if task.compliance is None else GAIN
    frames = 12
    poses = np.zeros((frames, 3))
    poses[:, 2] = np.linspace(0.0, 1.0, frames)
    return {
        'angle_deg': angle,
        'total_deg': 2.0 * angle,
        'limits_broken': 0,
        'deepest_contact': 0.004,
        'energy': {'largest_excess': 1e-12},
        'largest_offsets': [0.1, 0.2],
        'time': np.arange(frames, dtype=float).tolist(),
        'poses': poses.tolist(),
        'yaw_angles': np.zeros((frames, task.robot.n_yaw)).tolist(),
    }


@pytest.fixture(scope='module')
def tried() -> Outcome:
    plan = Plan(load_robot(ROBOT), seed=3)
    (task,) = STUDY.designs(plan)
    gait = load_gait('omega').gait
    designed = {task: {'kind': 'two_wave', 'gait': gait.to_mapping(), 'angle_deg': 91.9}}
    found = Outcome(plan, designed)
    return Outcome(plan, designed, {}, {t: made_up(t) for t in STUDY.trials(found)})


@pytest.fixture(scope='module')
def table(tried: Outcome) -> list[Row]:
    return STUDY.rows(tried)


def value(table: list[Row], case: str, quantity: str) -> float | None:
    (row,) = [r for r in table if (r.case, r.quantity) == (case, quantity)]
    return row.pybullet


def test_every_mode_meets_the_same_twenty_placements_at_each_spacing(tried: Outcome) -> None:
    among_pegs = [t for t in STUDY.trials(tried) if t.terrain.kind == 'pegboard' and t.cycles == 2]
    for spacing in SPACINGS_BL:
        for compliance in MODES.values():
            seeds = [
                t.seed
                for t in among_pegs
                if t.terrain.spacing_bl == spacing and t.compliance == compliance
            ]
            assert sorted(seeds) == list(range(20))


def test_gain_is_paired_by_placement_so_its_interval_leaves_their_spread_out(
    table: list[Row],
) -> None:
    for mode in MODES:
        if mode == OPEN:
            continue
        case = f'0.4 BL, {mode}'
        for quantity in ('gain', 'gain_low', 'gain_high'):
            assert value(table, case, quantity) == pytest.approx(GAIN)
    assert value(table, '0.4 BL, pushing', 'angle_std') == pytest.approx(1.45, abs=0.01)
    assert value(table, '0.4 BL, pushing', 'ratio') == pytest.approx(54.0 / 42.0)


def test_file_tells_every_trial_but_not_its_motion(
    tried: Outcome, table: list[Row], tmp_path: Path
) -> None:
    path = tmp_path / 'pegboard.json'
    write_json(path, STUDY.name, table, 3, 1.0, STUDY.records(tried))
    record = json.loads(path.read_text())
    assert len(record['trials']) == len(tried.tried)
    named = {
        (t['terrain'], t['spacing_bl'], t['mode'], t['seed'], t['cycles'])
        for t in record['trials']
    }
    assert len(named) == len(record['trials'])
    assert all('poses' not in t and 'angle_deg' in t for t in record['trials'])


def test_picture_shows_angles_and_the_robot_between_the_pegs(
    tried: Outcome, tmp_path: Path
) -> None:
    STUDY.draw(tried, tmp_path)
    with PngImageFile(str(tmp_path / 'pegboard.png')) as picture:
        assert min(picture.size) > 900
        assert len(set(np.asarray(picture.convert('L')).ravel().tolist())) > 50


def test_without_pybullet_only_open_ground_is_told(tried: Outcome, tmp_path: Path) -> None:
    bare = Outcome(tried.plan, tried.designed)
    assert {row.case for row in STUDY.rows(bare)} == {
        'open ground, open loop',
        'open ground, pushing',
        'open ground, gentle yielding',
    }
    assert all(row.pybullet is None for row in STUDY.rows(bare))
    STUDY.draw(bare, tmp_path)
    assert not list(tmp_path.iterdir()) and STUDY.records(bare) == []
