"""A real omega turn: 600 frames of 24 joint angles, 32 frames per second, head first.

`examples/kymogram_omega-turn.npy` of the source distribution of `elegansbot` 1.0.2 on PyPI. The
README says how to get it; the environment variable OMEGA_TURN_KYMOGRAPH says where it is.
"""

from __future__ import annotations

import math
import os
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.mechanics.trajectory import straight_path
from omega_turn_ros.robot import load_robot
from omega_turn_ros.worm.analysis import analyse
from omega_turn_ros.worm.components import centred, principal_components
from omega_turn_ros.worm.kymograph import Kymograph, Reading, make_kymograph
from omega_turn_ros.worm.table import read_table
from omega_turn_ros.worm.template import fit_two_waves
from omega_turn_ros.worm.to_gait import worm_gait
from omega_turn_ros.worm.turns import find_turns

VARIABLE = 'OMEGA_TURN_KYMOGRAPH'
FILE = 'kymogram_omega-turn.npy'


def where_it_is() -> Path | None:
    """The file named by the variable, or beside an unpacked `elegansbot` on the import path."""
    if VARIABLE in os.environ:
        return Path(os.environ[VARIABLE])
    spec = find_spec('elegansbot')
    if spec is None or spec.origin is None:
        return None
    path = Path(spec.origin).parent.parent / 'examples' / FILE
    return path if path.is_file() else None


@pytest.fixture(scope='module')
def worm() -> Kymograph:
    path = where_it_is()
    if path is None:
        pytest.skip(f'no recording: set {VARIABLE} to {FILE}, see the README')
    return make_kymograph(FILE, read_table(path), Reading(32.0))


def test_four_components_explain_91_percent(worm: Kymograph) -> None:
    found = principal_components([centred(worm)], 4)
    assert found.explained == pytest.approx(0.914, abs=0.002)
    kept = principal_components([centred(worm, 'keep')], 4)
    assert kept.explained == pytest.approx(0.903, abs=0.002)


def test_the_one_omega_turn_is_found(worm: Kymograph) -> None:
    (turn,) = find_turns(worm)
    assert (turn.start, turn.stop, turn.peak) == (326, 398, 341)
    assert math.degrees(turn.bend) == pytest.approx(-375.0, abs=1.0)


def test_crawling_and_turning_are_two_waves(worm: Kymograph) -> None:
    found = analyse([worm])
    waves = found.waves
    assert waves.distinct and waves.explained > 0.89
    assert waves.k_t == pytest.approx(1.19, abs=0.02)
    assert waves.k_f == pytest.approx(1.67, abs=0.02)
    assert (found.spread.pair.std(axis=0) < 0.15).all()
    turning, forward = waves.turning[0].amplitude, waves.forward[0].amplitude
    assert turning[326:398].mean() > 2.0 * forward[326:398].mean()
    assert forward[:200].mean() > 2.0 * turning[:200].mean()


def test_in_the_turn_the_first_two_components_are_one_wave_as_long_as_the_body(
    worm: Kymograph,
) -> None:
    (turn,) = find_turns(worm)
    found = analyse([worm.cut(turn.start, turn.stop)])
    first = found.pairs[0]
    assert first.components == (0, 1) and first.travels
    assert first.k == pytest.approx(1.09, abs=0.02)
    assert found.components.variance[:2].sum() > 0.9
    assert not found.waves.distinct  # the second wave is too weak to be told from the first


def test_the_recording_read_the_other_way_round_has_the_same_waves(worm: Kymograph) -> None:
    other = Kymograph('other', -worm.angles[:, ::-1], worm.fps)
    first, second = (fit_two_waves([centred(k)], [k.angles], k.fps) for k in (worm, other))
    assert (second.k_t, second.k_f) == pytest.approx((first.k_t, first.k_f), abs=1e-4)
    shares = [w.backward_share for w in (*first.forward, *second.forward)]
    assert sum(shares) == pytest.approx(1.0, abs=0.02)


def test_its_gait_turns_as_the_worm_does_and_keeps_the_robots_limits(worm: Kymograph) -> None:
    robot = load_robot('limbless16')
    gait = worm_gait([worm], robot, 'worm')
    assert gait.cycle.start < 398 and gait.cycle.stop > 326
    assert gait.likeness > 0.85
    assert np.abs(gait.entry.gait.sampled(8)).max() <= robot.position_limit + 1e-9
    assert gait.clearance >= 0.0
    assert gait.entry.calibration.largest_angle > math.radians(20.0)
    # the recorded frames themselves, from straight to straight, on the same ground
    body = QuasiStatic(PlanarChain(np.full(25, 0.04)))
    frames = worm.angles[gait.cycle.start : gait.cycle.stop]
    ends = (straight_path(0.0 * frames[0], frames[0]), straight_path(frames[-1], 0.0 * frames[0]))
    angle = sum(body.turn(path) for path in (ends[0], frames, ends[1]))
    assert gait.unscaled == pytest.approx(abs(angle), rel=0.35)
