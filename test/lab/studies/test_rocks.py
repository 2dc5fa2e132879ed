"""What the rocks study makes of its trials."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from PIL.PngImagePlugin import PngImageFile

from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_lab.studies.patches import PatchesTask
from omega_turn_lab.studies.rocks import BEARINGS, GAITS, OTHER_FILLS, PILES, STUDY
from omega_turn_lab.studies.rows import Row
from omega_turn_lab.studies.run import ROBOT
from omega_turn_lab.studies.study import Outcome, Plan
from omega_turn_lab.studies.tasks import Task
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.robot import load_robot

HARD = 80.0  # [deg] of every gait on hard ground in the made-up trials; half of it on rocks


def made_up(task: Task) -> dict[str, Any]:
    """Half the angle on rocks, and every fourth pile rolls the robot over."""
    if isinstance(task, PatchesTask):
        return {'angles_deg': [70.0, 90.0]}
    assert isinstance(task, ObstacleTrial)
    on_rocks = task.terrain.kind == 'rocks'
    rolled = on_rocks and task.seed % 4 == 0
    angle = 0.5 * HARD + task.seed % 2 - 0.5 if on_rocks else HARD
    return {
        'angle_deg': angle,
        'total_deg': 2.0 * angle,
        'least_upright': -0.9 if rolled else 0.9,
        'time': [0.0, 1.0],
        'poses': [[0.0, 0.0, 0.0], [0.1, 0.0, 1.0]],
        'yaw_angles': [[0.0] * task.robot.n_yaw] * 2,
    }


@pytest.fixture(scope='module')
def tried() -> Outcome:
    plan = Plan(load_robot(ROBOT), seed=3)
    gait = load_gait('omega').gait.to_mapping()
    designed = {
        task: {'kind': 'two_wave', 'gait': {**gait, 'k_t': task.k_t}, 'angle_deg': 91.9}
        for task in STUDY.designs(plan)
    }
    trials = STUDY.trials(Outcome(plan, designed))
    return Outcome(plan, designed, {}, {task: made_up(task) for task in trials})


@pytest.fixture(scope='module')
def table(tried: Outcome) -> list[Row]:
    return STUDY.rows(tried)


def value(table: list[Row], case: str, quantity: str) -> float | None:
    (row,) = [r for r in table if (r.case, r.quantity) == (case, quantity)]
    return row.pybullet


def test_each_gait_meets_the_same_piles(tried: Outcome) -> None:
    trials = [task for task in tried.tried if isinstance(task, ObstacleTrial)]
    piles = [task for task in trials if task.terrain.kind == 'rocks']
    assert len(piles) == (len(GAITS) + len(OTHER_FILLS)) * PILES
    for task in piles:
        # What lies flat may sag; what lifts itself needs its torque.
        assert (task.pitch_effort > 0.0) is isinstance(task.gait, WaveGait)


@pytest.mark.parametrize('gait', GAITS)
def test_what_rocks_leave_of_a_turn_is_told(table: list[Row], gait: str) -> None:
    assert value(table, f'{gait}, hard ground', 'angle') == HARD
    assert value(table, f'{gait}, rocks', 'angle') == pytest.approx(0.5 * HARD)
    assert value(table, f'{gait}, rocks', 'kept') == pytest.approx(0.5)
    assert value(table, f'{gait}, rocks', 'rolled_over') == 0.25


def test_other_fillings_are_told_for_the_omega_turn(table: list[Row]) -> None:
    for fill in OTHER_FILLS:
        case = f'omega turn, rocks, stones {fill:g} of their size between'
        assert value(table, case, 'angle') == pytest.approx(0.5 * HARD)


def test_theory_tells_what_patchy_support_alone_does(table: list[Row]) -> None:
    for bearing in BEARINGS:
        case = f'omega turn, level patches that bear, {bearing:g} of the ground'
        mean, deviation = (row for row in table if row.case == case)
        assert (mean.quantity, mean.quasi_static) == ('angle', 80.0)
        assert (deviation.quantity, deviation.quasi_static) == (
            'angle_std',
            pytest.approx(200.0**0.5),
        )


def test_file_tells_every_trial_but_not_its_motion(tried: Outcome) -> None:
    records = STUDY.records(tried)
    assert len(records) == len(tried.tried) - len(BEARINGS)
    assert all('poses' not in record for record in records)


def test_picture_and_bare_table(tried: Outcome, tmp_path: Path) -> None:
    STUDY.draw(tried, tmp_path)
    with PngImageFile(str(tmp_path / 'rocks.png')) as picture:
        assert min(picture.size) > 700
    bare = Outcome(tried.plan, tried.designed)
    assert all(row.pybullet is None for row in STUDY.rows(bare)) and STUDY.records(bare) == []
