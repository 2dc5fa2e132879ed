"""A jam is told by cycles that get nowhere while motors strain."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from rig import Rig

from omega_turn_ros.gaits.jam import JamWatch

MakeRig = Callable[..., Rig]
FEEDBACK = {'heading_feedback': True, 'max_corrections': 2}


def jams_of(rig: Rig, effort: float) -> tuple[int, bool]:
    rig.ask(math.radians(80.0))
    rig.finish(effort=effort)
    return rig.state.jam.cycles, rig.state.jam.jammed


def test_cycles_that_get_nowhere_while_motors_strain_are_a_jam(make_rig: MakeRig) -> None:
    rig = make_rig(**FEEDBACK, ground=0.01)
    cycles, jammed = jams_of(rig, rig.controller.robot.effort_limit)
    assert jammed
    assert cycles == rig.state.cycles


@pytest.mark.parametrize(('ground', 'share'), [(1.0, 1.0), (0.01, 0.5), (0.01, 0.0)])
def test_progress_or_ease_is_no_jam(make_rig: MakeRig, ground: float, share: float) -> None:
    rig = make_rig(**FEEDBACK, ground=ground)
    assert jams_of(rig, share * rig.controller.robot.effort_limit) == (0, False)


def test_a_cycle_that_turns_again_ends_the_jam() -> None:
    stuck = JamWatch().advanced(5.0, 5.0, 1.0).judged(0.1, 1.5, 10.0)
    assert stuck.jammed
    free = stuck.advanced(5.0, 5.0, 1.0).judged(1.4, 1.5, 10.0)
    assert (free.jammed, free.cycles) == (False, 1)


def test_a_short_strain_is_no_jam() -> None:
    assert not JamWatch().advanced(5.0, 5.0, 0.2).judged(0.0, 1.5, 10.0).jammed
