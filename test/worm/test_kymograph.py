"""What a recording must be, and what becomes of its numbers."""

from __future__ import annotations

import re

import numpy as np
import pytest
from waves_of import FPS, turning

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.worm.kymograph import Kymograph, Reading, make_kymograph

ANGLES = turning(frames=100).angles(24)


def made(table: np.ndarray, start: int = 0, stop: int | None = None, **how: object) -> Kymograph:
    return make_kymograph('rec', table, Reading(FPS, **how), start, stop)  # type: ignore[arg-type]


def test_radians_degrees_curvature_and_tangents_tell_the_same_body() -> None:
    tangents = np.concatenate([np.zeros((100, 1)), np.cumsum(ANGLES, axis=1)], axis=1)
    spinning = np.arange(100)[:, None] * 0.3  # how the animal lies does not count
    wrapped = (tangents + spinning + np.pi) % (2.0 * np.pi) - np.pi
    for trial in (
        made(np.degrees(ANGLES), degrees=True),
        made(ANGLES * 24.0, kind='curvature'),
        made(ANGLES * 24.0 / 1.2, kind='curvature', worm_length=1.2),  # per mm, of 1.2 mm
        made(wrapped, kind='tangent'),
        made(ANGLES[:, ::-1], tail_first=True),
    ):
        np.testing.assert_allclose(trial.angles, ANGLES, atol=1e-12)
        np.testing.assert_allclose(trial.curvature, 24.0 * ANGLES, atol=1e-10)


def test_short_gaps_are_interpolated_and_counted() -> None:
    table = ANGLES.copy()
    table[40:45] = np.nan
    table[70, 3] = np.nan
    trial = made(table)
    assert trial.filled == (40, 41, 42, 43, 44, 70)
    share = np.arange(1, 6)[:, None] / 6.0
    np.testing.assert_allclose(trial.angles[40:45], (1 - share) * ANGLES[39] + share * ANGLES[45])
    assert trial.angles[70, 3] == pytest.approx(0.5 * (ANGLES[69, 3] + ANGLES[71, 3]))
    np.testing.assert_array_equal(np.delete(trial.angles[70], 3), np.delete(ANGLES[70], 3))


@pytest.mark.parametrize(
    ('gap', 'longest', 'fine'), [(8, 0.25, True), (9, 0.25, False), (1, 0.0, False)]
)
def test_the_longest_gap_is_the_one_stated(gap: int, longest: float, fine: bool) -> None:
    table = ANGLES.copy()
    table[50 : 50 + gap] = np.nan
    if fine:
        assert len(made(table, max_gap=longest).filled) == gap
    else:
        with pytest.raises(BadInputError, match=r'^rec frame 50: '):
            made(table, max_gap=longest)


def test_frames_are_numbered_as_in_the_recording() -> None:
    table = ANGLES.copy()
    table[:10] = np.nan
    table[60] = np.nan
    with pytest.raises(BadInputError, match=r'^rec frame 0: .*--from'):
        made(table)
    trial = made(table, 20, 90)
    assert (trial.first, trial.n_frames, trial.filled) == (20, 70, (60,))
    assert trial.time[0] == 20 / FPS
    part = trial.cut(50, 80)
    assert (part.first, part.n_frames, part.filled) == (50, 30, (60,))
    np.testing.assert_array_equal(part.angles, trial.angles[30:60])


def test_a_recording_told_at_other_positions_keeps_its_curvature() -> None:
    fine = made(turning(frames=100).angles(96))
    coarse = fine.resampled(24)
    # i/24 of the waves is where positions 4 i - 2 and 4 i - 1 of 96 meet, half a position early
    exact = turning(frames=100)
    shift = 2.0 * np.pi * (0.5 / 96 - 0.5 / 24)
    phases = tuple(tau + k * shift for tau, k in zip(exact.phases, exact.k))
    expected = type(exact)(exact.k, exact.amplitudes, phases).angles(24)
    np.testing.assert_allclose(coarse.angles, expected, atol=3e-3)


BAD_TABLES = {
    'few frames': (ANGLES[:15], 'rec: .* 16'),
    'few positions': (ANGLES[:, :5], 'rec: .* 6'),
    'infinite': (np.where(np.arange(24) == 4, np.inf, ANGLES), 'rec frame 0, position 5'),
    'still': (np.tile(ANGLES[0], (50, 1)), 'rec: .*moves'),
    'all missing': (np.full((50, 24), np.nan), 'rec frame 0: '),
    'on its side': (np.tile(ANGLES.T, (1, 10)), 'rec: .*--transposed'),
    'time first': (np.column_stack([np.arange(100) / 32, ANGLES]), 'rec column 1: .*--skip'),
}


@pytest.mark.parametrize('case', BAD_TABLES)
def test_an_unusable_table_is_refused_by_place(case: str) -> None:
    table, said = BAD_TABLES[case]
    with pytest.raises(BadInputError, match=said):
        made(table)


@pytest.mark.parametrize('frames', [(-1, None), (0, 101), (50, 50), (60, 40)])
def test_a_cut_outside_the_recording_is_refused(frames: tuple[int, int | None]) -> None:
    with pytest.raises(BadInputError, match=r'^frames: '):
        made(ANGLES, *frames)


@pytest.mark.parametrize(
    ('field', 'how'),
    [
        ('fps', {'fps': 0.0}),
        ('fps', {'fps': float('nan')}),
        ('kind', {'kind': 'bend'}),
        ('worm_length', {'kind': 'curvature', 'worm_length': -1.0}),
        ('worm_length', {'worm_length': 2.0}),
        ('degrees', {'kind': 'curvature', 'degrees': True}),
        ('max_gap', {'max_gap': -0.1}),
    ],
)
def test_a_reading_that_cannot_be_is_refused(field: str, how: dict[str, object]) -> None:
    with pytest.raises(BadInputError, match=f'^{re.escape(field)}: '):
        Reading(**{'fps': FPS, **how})  # type: ignore[arg-type]
