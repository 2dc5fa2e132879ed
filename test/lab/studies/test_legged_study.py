"""The ten-legged robot's study, without PyBullet and with trials made up."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from omega_turn_lab.studies import legged
from omega_turn_lab.studies.legged_height import legged_height, path_turn
from omega_turn_lab.studies.study import Outcome, Plan
from omega_turn_ros.mechanics.legged import LeggedMotion
from omega_turn_ros.robot import load_robot


@pytest.fixture(scope='module')
def outcome() -> Outcome:
    return Outcome(Plan(load_robot('limbless16'), 0), {})


def test_rotation_grows_with_a_3_and_the_printed_path_turns_nowhere(outcome: Outcome) -> None:
    rows = legged.STUDY.rows(outcome)
    for loads in ('equal', 'static'):
        ours = [r for r in rows if legged.OURS in r.case and r.case.endswith(f'{loads} loads')]
        angles = [r.quasi_static for r in ours if r.quantity == 'angle']
        assert len(angles) == len(legged.A_3_DEG)
        assert (np.diff(np.array(angles, float)) > 1.0).all()
    printed = [r.quasi_static for r in rows if legged.PRINTED in r.case]
    assert len(printed) == 8 and np.abs(np.array(printed, float)).max() < 1e-3
    assert all(r.pybullet is None and r.paper is None for r in rows)


def test_height_function_predicts_the_turn() -> None:
    whole = legged.gait(legged.OURS, 20.0)
    motion = LeggedMotion(legged.robot())
    turn = path_turn(motion, whole, legged_height(motion, whole), 1.0)
    assert turn.surface == pytest.approx(turn.direct, rel=0.15)


def test_height_function_has_the_symmetry_of_the_robot() -> None:
    """h(phi + pi, -w_3) = h(phi, w_3)."""
    whole = legged.gait(legged.OURS, 20.0)
    mean = legged_height(LeggedMotion(legged.robot()), whole).mean
    mirrored = np.roll(mean, mean.shape[0] // 2, axis=0)[:, ::-1]
    assert np.corrcoef(mean.ravel(), mirrored.ravel())[0, 1] > 0.98


def test_figure_and_records(outcome: Outcome, tmp_path: Path) -> None:
    legged.STUDY.draw(outcome, tmp_path)
    assert (tmp_path / 'legged.png').stat().st_size > 50_000
    assert legged.STUDY.records(outcome) == []
    motion = legged._by_theory(10.0)
    played = {
        task: {**motion, 'angle_deg': 1.0, 'cycle_angles_deg': [0.5, 1.5], 'advance_bl': 0.3}
        for task in legged.STUDY.trials(outcome)
    }
    tried = Outcome(outcome.plan, {}, {}, played)
    records = legged.STUDY.records(tried)
    assert len(records) == len(played)
    assert {r['w_3'] for r in records} == set(legged.PATHS)
    assert {r['static_friction'] for r in records} == {0.5, legged.CARPET}
    rows = legged.STUDY.rows(tried)
    assert all(r.pybullet is not None for r in rows if r.quantity == 'angle')
    spreads = [r.pybullet for r in rows if r.quantity == 'angle_std']
    assert spreads == [pytest.approx(0.5**0.5)] * 2 * len(legged.A_3_DEG)
