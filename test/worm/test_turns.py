"""Turns are found where the body is bent back on itself, whoever recorded it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from waves_of import FPS

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.turns import deepest_bend, find_turns


def crawl_with_turn(
    bend_deg: float, seconds: float, positions: int = 24, start: float = 5.0
) -> Kymograph:
    """Crawling worm whose front third takes on a bend of one side for a while."""
    time = np.arange(round(12.0 * FPS)) / FPS
    place = np.arange(1, positions + 1) / positions
    angles = 5.0 / positions * np.sin(2 * np.pi * (1.5 * place - 0.5 * time[:, None]))
    inside = (time >= start) & (time < start + seconds)
    front = place <= 1.0 / 3.0
    angles[inside] = 0.0
    angles[np.ix_(inside, front)] = math.radians(bend_deg) / front.sum()
    return Kymograph('crawl', angles, FPS, first=100)


def test_the_deepest_bend_is_the_largest_angle_between_two_places() -> None:
    rng = np.random.default_rng(0)
    for angles in rng.normal(size=(20, 9)):
        direction = np.concatenate([[0.0], np.cumsum(angles)])
        turned = direction[None, :] - direction[:, None]
        pairs = [turned[a, b] for a in range(10) for b in range(a, 10)]
        assert float(deepest_bend(angles)) == pytest.approx(max(pairs, key=abs))
    np.testing.assert_allclose(deepest_bend(-angles), -deepest_bend(angles))


@pytest.mark.parametrize('sign', [1.0, -1.0])
@pytest.mark.parametrize('positions', [12, 24, 99])
def test_a_turn_is_found_where_it_is(positions: int, sign: float) -> None:
    trial = crawl_with_turn(sign * 230.0, 1.5, positions)
    (turn,) = find_turns(trial)
    assert (turn.start, turn.stop) == (100 + 160, 100 + 208)
    assert turn.start <= turn.peak < turn.stop
    assert math.degrees(turn.bend) == pytest.approx(sign * 230.0, abs=1.0)
    np.testing.assert_array_equal(deepest_bend(trial.cut(turn.start, turn.stop).angles), turn.bend)


@pytest.mark.parametrize(('bend', 'seconds'), [(170.0, 1.5), (230.0, 0.4)])
def test_neither_shallow_nor_brief_bends_are_turns(bend: float, seconds: float) -> None:
    assert find_turns(crawl_with_turn(bend, seconds)) == []


def test_the_bend_can_be_asked_for() -> None:
    assert len(find_turns(crawl_with_turn(170.0, 1.5), math.radians(160.0))) == 1
    for bad in (0.0, math.nan):
        with pytest.raises(BadInputError, match=r'^bend: '):
            find_turns(crawl_with_turn(170.0, 1.5), bad)


@pytest.mark.parametrize(('gap', 'count'), [(8, 1), (9, 2)])
def test_short_interruptions_are_bridged(gap: int, count: int) -> None:
    trial = crawl_with_turn(230.0, 2.0)
    angles = trial.angles.copy()
    angles[190 : 190 + gap] = 0.0
    broken = Kymograph('broken', angles, FPS)
    assert len(find_turns(broken)) == count
