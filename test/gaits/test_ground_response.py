"""How cycles are planned on ground that turns the robot otherwise than predicted."""

from __future__ import annotations

import numpy as np
import pytest

from omega_turn_ros.gaits.ground_response import BELIEVED, LEAST_SHARE, GroundResponse

LARGE, SMALL = 1.5, 0.2  # [rad] predicted


def after(
    response: GroundResponse, ratio: float, predicted: float = LARGE, remaining: float = 0.5
) -> GroundResponse:
    return response.judged(ratio * predicted, predicted, remaining, firm=True)


def test_even_ground_is_learned_within_a_few_cycles() -> None:
    response = GroundResponse()
    for _ in range(8):
        response = after(response, 0.6)
    assert response.planned == pytest.approx(0.6, abs=0.005)
    assert response.usual == pytest.approx(0.6, abs=0.005)


@pytest.mark.parametrize('ratio', [-1.0, 0.0, 100.0])
def test_no_single_cycle_is_believed_wholly(ratio: float) -> None:
    low, high = BELIEVED
    assert low**0.5 <= after(GroundResponse(), ratio).ratio <= high**0.5


def test_overshoot_halves_what_the_next_cycle_plans_for() -> None:
    once = after(GroundResponse(), 1.0, remaining=-0.1)
    assert once.planned == 2.0 * once.ratio
    response = once
    for _ in range(5):
        response = after(response, 1.0, remaining=-0.1)
    assert response.share == LEAST_SHARE


def test_a_cycle_that_did_not_overshoot_raises_the_share_again() -> None:
    response = after(GroundResponse(), 1.0, remaining=-0.1)
    for _ in range(2):
        response = after(response, 1.0)
    assert response.share == 1.0


def test_small_cycles_say_nothing_of_the_next_turn() -> None:
    response = after(GroundResponse(), 2.0, SMALL)
    assert response.ratio > 1.0
    assert response.restarted() == GroundResponse()
    assert after(GroundResponse(), 2.0).restarted() == GroundResponse(1.5, 1.5)


def test_a_small_miss_makes_push_harder_only_who_is_firm() -> None:
    assert GroundResponse().judged(0.5 * SMALL, SMALL, 0.1, firm=True).ratio < 1.0
    assert GroundResponse().judged(0.5 * SMALL, SMALL, 0.1, firm=False).ratio == 1.0


def test_corrections_shrink_where_half_of_each_cycle_is_chance() -> None:
    """Planning for the whole rest, as the last cycle had it, they do not."""
    rng = np.random.default_rng(5)
    careful, hasty = (
        [_left_after(14, rng.normal(1.0, 1.0, 14), learn) for _ in range(300)]
        for learn in (True, False)
    )
    assert np.median(np.abs(careful)) < 0.1 * np.median(np.abs(hasty))


def _left_after(cycles: int, gains: np.ndarray, learn: bool) -> float:
    """Angle left of 1 rad [rad]; each cycle turns by its plan times its gain."""
    response, left = GroundResponse(), 1.0
    for gain in gains[:cycles]:
        predicted = left / response.planned
        turned = gain * predicted
        left -= turned
        if learn:
            response = response.judged(turned, predicted, left, firm=True)
        else:
            response = GroundResponse(min(max(gain, BELIEVED[0]), BELIEVED[1]))
    return left
