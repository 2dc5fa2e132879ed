"""What the studies say of given gaits, beside the paper."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from conftest import PAPER
from PIL.PngImagePlugin import PngImageFile

from omega_turn_lab.studies import published
from omega_turn_lab.studies.areas import area_readings
from omega_turn_lab.studies.flat import AREA_LIMITS
from omega_turn_lab.studies.rows import Row, print_table, write_json
from omega_turn_lab.studies.run import load_study
from omega_turn_lab.studies.study import Outcome
from omega_turn_ros import __version__
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.quasi_static import QuasiStatic

GRID = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5]


def rows_of(name: str, outcome: Outcome, quantity: str, **params: float) -> list[Row]:
    return [
        row
        for row in load_study(name).rows(outcome)
        if row.quantity == quantity and all(row.params[k] == v for k, v in params.items())
    ]


@pytest.mark.parametrize('name', PAPER)
def test_every_number_of_the_paper_stands_beside_one_of_ours(name: str, outcome: Outcome) -> None:
    found = {
        (row.quantity, tuple(row.params.items()), row.paper, row.paper_std)
        for row in load_study(name).rows(outcome)
        if row.paper is not None and row.quasi_static is not None
    }
    for entry in published._figures().get(name, ()):
        matching = [
            params
            for quantity, params, value, std in found
            if (quantity, value, std) == (entry['quantity'], entry['value'], entry['std'])
            and all(entry[key] == number for key, number in params if key in entry)
        ]
        assert matching, entry


@pytest.mark.parametrize('name', PAPER)
def test_the_file_holds_exactly_what_was_promised(
    name: str, outcome: Outcome, tmp_path: Path
) -> None:
    rows = load_study(name).rows(outcome)
    path = tmp_path / f'{name}.json'
    write_json(path, name, rows, seed=3, seconds=1.25)
    record = json.loads(path.read_text())
    assert set(record) == {'study', 'rows', 'seed', 'version', 'seconds'}
    assert (record['study'], record['seed'], record['seconds']) == (name, 3, 1.25)
    assert record['version'] == __version__ and len(record['rows']) == len(rows) > 3
    for row in record['rows']:
        assert list(row) == [
            *('case', 'params', 'quantity', 'unit'),
            *('paper', 'paper_std', 'quasi_static', 'pybullet'),
        ]
        assert set(row['params']) == {'N', 'k_f', 'k_t', 'theta_max_deg'}
        assert isinstance(row['quasi_static'], float)
    named = [(row['case'], row['quantity'], row['unit']) for row in record['rows']]
    assert len(set(named)) == len(named), 'two rows of one name'


@pytest.mark.parametrize('name', PAPER)
def test_without_pybullet_its_column_is_empty_and_ours_the_same(
    name: str, outcome: Outcome, without_pybullet: Outcome
) -> None:
    study = load_study(name)
    full, rows = study.rows(outcome), study.rows(without_pybullet)
    assert [row.quasi_static for row in rows] == [row.quasi_static for row in full]
    assert all(row.pybullet is None for row in rows)
    in_pybullet = study.played or bool(study.trials(outcome))
    assert all((row.pybullet is not None) == in_pybullet for row in full)


@pytest.mark.parametrize(
    ('name', 'families'),
    [
        ('flat', [(8, 1.5, 90.0, GRID)]),
        ('amplitude', [(8, 1.5, limit, GRID) for limit in (60.0, 75.0, 90.0)]),
        (
            'frequency',
            [
                (8, 1.0, 90.0, GRID[:5]),
                (8, 1.5, 90.0, GRID),
                (8, 2.0, 90.0, [*GRID, 1.75, 2.0]),
            ],
        ),
        ('joints', [(n, 1.5, 90.0, GRID) for n in (6, 7, 8)]),
    ],
)
def test_a_study_samples_what_the_paper_sampled(
    name: str, families: list[tuple[int, float, float, list[float]]], outcome: Outcome
) -> None:
    expected = [
        {'N': n, 'k_f': k_f, 'k_t': k_t, 'theta_max_deg': limit}
        for n, k_f, limit, grid in families
        for k_t in grid
    ]
    assert [row.params for row in rows_of(name, outcome, 'angle')] == expected


def test_an_angle_is_that_of_the_gait_on_the_paper_s_ground(outcome: Outcome) -> None:
    for row in rows_of('joints', outcome, 'angle', k_t=1.0):
        n = int(row.params['N'])
        task = outcome.plan.design(1.0, n=n)
        path = outcome.gait(task).angles(np.linspace(0.0, 2.0 * np.pi, 1001), n)
        chain = PlanarChain(np.full(n + 1, 0.14))
        assert row.quasi_static == pytest.approx(
            math.degrees(QuasiStatic(chain).turn(path)), abs=0.05
        )
        assert np.abs(path).max() <= math.radians(90.0) + 1e-4


def test_a_range_is_the_largest_limit_s_angle_less_the_smallest_s(outcome: Outcome) -> None:
    for k_t in GRID:
        (span,) = rows_of('amplitude', outcome, 'angle_range', k_t=k_t)
        angle = {
            row.params['theta_max_deg']: row
            for row in rows_of('amplitude', outcome, 'angle', k_t=k_t)
        }
        for column in ('quasi_static', 'pybullet'):
            high, low = (getattr(angle[limit], column) for limit in (90.0, 60.0))
            assert getattr(span, column) == pytest.approx(high - low)


def test_the_best_k_t_is_where_the_angle_is_largest(outcome: Outcome) -> None:
    for n in (6, 7, 8):
        (best,) = rows_of('joints', outcome, 'best_k_t', N=n)
        angles = rows_of('joints', outcome, 'angle', N=n)
        for column in ('quasi_static', 'pybullet'):
            top = max(angles, key=lambda row: getattr(row, column))
            assert getattr(best, column) == top.params['k_t']


def test_heading_ends_at_the_angle_of_the_cycle(outcome: Outcome) -> None:
    quarters = rows_of('evolution', outcome, 'heading')
    (angle,) = rows_of('flat', outcome, 'angle', k_t=1.0)
    assert quarters[-1].quasi_static == pytest.approx(angle.quasi_static, abs=0.1)
    assert [row.paper is None for row in quarters] == [True, True, True, False]
    assert len({row.quasi_static for row in quarters}) == 4


def test_grains_as_smooth_as_friction_turn_the_body_as_friction_does(outcome: Outcome) -> None:
    for k_t in (0.0, 1.0, 1.5):
        smooth, *rough = (
            row for row in rows_of('granular', outcome, 'angle', k_t=k_t) if 'hard' in row.case
        )
        (angle,) = rows_of('flat', outcome, 'angle', k_t=k_t)
        assert smooth.case.endswith(' 1')
        assert smooth.quasi_static == pytest.approx(angle.quasi_static, abs=0.01)
        assert all(abs(row.quasi_static - angle.quasi_static) > 0.1 for row in rough)


def test_stronger_grains_change_what_motors_do_and_not_what_the_balance_says(
    outcome: Outcome,
) -> None:
    for k_t in (0.0, 1.0, 1.5):
        rows = rows_of('granular', outcome, 'angle_by_strength', k_t=k_t)
        assert len({row.quasi_static for row in rows}) == 1
        strengths = [float(row.case.split()[-3]) for row in rows]
        assert strengths == sorted(set(strengths)) and len(strengths) > 3
        assert all(row.paper is not None for row in rows)
    trials = load_study('granular').trials(outcome)
    assert len(set(trials)) == len(trials)


def test_the_front_has_a_point_of_angle_and_area_for_each_weight(outcome: Outcome) -> None:
    points = rows_of('flat', outcome, 'pareto')
    assert [row.unit for row in points] == ['deg', 'BL^2'] * (1 + len(AREA_LIMITS))
    (angle,) = rows_of('flat', outcome, 'angle', k_t=1.0)
    assert points[0].quasi_static == angle.quasi_static
    assert len({row.quasi_static for row in points}) == len(points)


def test_a_rod_that_turns_about_its_middle_sweeps_a_disc() -> None:
    chain, width, steps = PlanarChain([1.0, 1.0, 1.0]), 0.3, 400
    poses = np.zeros((steps + 1, 3))
    poses[:, 2] = np.linspace(0.0, np.pi, steps + 1)
    areas = area_readings(chain, width, np.zeros((steps + 1, 2)), poses)
    disc = math.pi * 1.5**2 / 3.0**2
    for reading in ('swept_area', 'swept_area_least', 'swept_area_most'):
        assert areas[reading] == pytest.approx(disc, rel=1e-3)
    assert areas['swept_area_markers'] == pytest.approx(disc / 9.0, rel=1e-3)
    wide = math.pi * (1.5**2 + (0.5 * width) ** 2) / 3.0**2
    assert areas['swept_area_union'] == pytest.approx(wide, rel=1e-3)


def test_what_a_cycle_sweeps_depends_on_where_it_starts() -> None:
    """A rod of length 3 goes 2 sideways and 1 back: from half-way up it needs 1 only."""
    chain, steps = PlanarChain([1.0, 1.0, 1.0]), 400
    poses = np.zeros((steps + 1, 3))
    fraction = np.linspace(0.0, 1.0, steps + 1)
    poses[:, 1] = np.interp(fraction, [0.0, 0.5, 1.0], [0.0, 2.0, 1.0])
    placed = poses + np.array([5.0, -3.0, 0.0])
    for given in (poses, placed):
        areas = area_readings(chain, 0.1, np.zeros((steps + 1, 2)), given)
        assert areas['swept_area'] == pytest.approx(2.0 * 3.0 / 9.0)
        assert areas['swept_area_most'] == pytest.approx(2.0 * 3.0 / 9.0)
        assert areas['swept_area_least'] == pytest.approx(1.0 * 3.0 / 9.0)


@pytest.mark.parametrize('name', PAPER)
def test_a_figure_is_one_or_two_columns_wide_and_not_empty(
    name: str, outcome: Outcome, without_pybullet: Outcome, tmp_path: Path
) -> None:
    seen = []
    for folder, given in (('with', outcome), ('without', without_pybullet)):
        (tmp_path / folder).mkdir()
        load_study(name).draw(given, tmp_path / folder)
        for path in sorted((tmp_path / folder).iterdir()):
            with PngImageFile(path) as picture:
                assert picture.width in (1050, 2160), path.name  # 3.5, 7.2 in at 300 dots per inch
                pixels = np.asarray(picture.convert('RGB')).astype(int)
            assert (np.ptp(pixels, axis=2) > 60).sum() > 1000, 'no colours'
            seen.append((path.name, pixels.tobytes()))
    assert f'{name}.png' in dict(seen)
    if load_study(name).played or load_study(name).trials(outcome):
        assert len({content for _, content in seen}) == len(seen), 'PyBullet is not drawn'


def test_the_table_shows_ours_the_paper_s_and_the_difference(
    outcome: Outcome, capsys: pytest.CaptureFixture[str]
) -> None:
    study = load_study('amplitude')
    rows = study.rows(outcome)
    print_table(study.title, rows)
    lines = capsys.readouterr().out.splitlines()
    row = next(row for row in rows if row.paper == 64.2)
    assert row.quasi_static is not None
    (line,) = (line for line in lines if '64.2 ± 2.7' in line)
    assert f'{row.quasi_static:.1f}' in line
    assert f'{row.quasi_static - 64.2:+.1f}' in line


def test_an_unknown_study_is_refused() -> None:
    with pytest.raises(BadInputError, match='study'):
        load_study('tables')
