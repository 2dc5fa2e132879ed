"""A worm's cycle becomes a gait that keeps the robot's limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from waves_of import FPS, Truth, fitted, recorded, turning

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import gait_to_mapping, load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.self_collision import self_clearance
from omega_turn_ros.robot import Robot, load_robot
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.to_gait import WormGait, deepest_cycle, worm_gait


@pytest.fixture(scope='module')
def robot() -> Robot:
    return load_robot('limbless16')


def shrunk(truth: Truth, factor: float) -> Truth:
    return replace(truth, amplitudes=tuple(factor * a for a in truth.amplitudes))


def made(truth: Truth, robot: Robot, **how: int) -> WormGait:
    trial = recorded(truth, noise=0.0)
    return worm_gait([trial], robot, 'made', **how)


@pytest.fixture(scope='module')
def deep(robot: Robot) -> WormGait:
    """Of a worm that bends further than the robot can."""
    return made(turning(), robot)


@pytest.mark.parametrize('sign', [-1.0, 1.0])
def test_a_periodic_turn_comes_back_in_curvature_and_direction(robot: Robot, sign: float) -> None:
    """The robot's angles are the worm's curvature at the same places of the body."""
    truth = shrunk(turning(sign=sign), 0.3)
    gait = made(truth, robot)
    assert gait.factor == 1.0
    assert gait.likeness > 0.999
    assert math.copysign(1.0, gait.entry.gait.k_t) == sign
    trial = recorded(truth, noise=0.0).resampled(8)
    cycle = gait.entry.gait.sampled(8, 2000)
    frames = trial.angles[gait.cycle.start : gait.cycle.stop]
    nearest = np.abs(frames[:, None] - cycle).max(axis=2).min(axis=1)
    mirrored = np.abs(frames[:, None] + cycle).max(axis=2).min(axis=1)
    # resampling 24 to 8 positions linearly costs a little of the curvature
    assert min(nearest.max(), mirrored.max()) < 0.04 * np.abs(frames).max()


def test_the_gait_keeps_every_limit_of_the_robot(deep: WormGait, robot: Robot) -> None:
    path = deep.entry.gait.sampled(robot.n_yaw, 5000)
    assert np.abs(path).max() <= robot.position_limit + 1e-9
    chain = PlanarChain.of_robot(robot)
    assert self_clearance(chain, robot.module_width, path).min() >= 0.0
    assert deep.factor < 1.0
    assert deep.unscaled > deep.entry.calibration.largest_angle
    assert deep.clearance >= 0.0


def test_it_is_a_gait_of_the_library_and_turns_counter_clockwise(
    deep: WormGait, tmp_path: pytest.TempPathFactory
) -> None:
    path = f'{tmp_path}/made.yaml'
    with open(path, 'w', encoding='utf-8') as stream:
        yaml.safe_dump(gait_to_mapping(deep.entry), stream)
    again = load_gait(path)
    assert again.robot == 'limbless16'
    assert again.calibration.largest_angle == pytest.approx(
        deep.entry.calibration.largest_angle, abs=1e-5
    )
    assert again.calibration.largest_angle > math.radians(1.0)
    np.testing.assert_allclose(again.gait.sampled(8), deep.entry.gait.sampled(8), atol=1e-6)


def test_harmonics_follow_an_uneven_worm_more_closely(robot: Robot) -> None:
    truth = shrunk(turning(), 0.3)
    tau = truth.phases[0]
    uneven = replace(truth, phases=(tau, tau + 1.0 + 0.4 * np.sin(2.0 * tau)))
    one, two = (made(uneven, robot, harmonics=n).likeness for n in (1, 2))
    assert one + 0.01 < two


def test_the_deepest_bent_cycle_is_taken() -> None:
    calm = turning(frames=300)
    size = np.where(np.arange(300) // 60 == 3, 1.0, 0.3)
    truth = replace(calm, amplitudes=tuple(size * a for a in calm.amplitudes))
    trials = [recorded(shrunk(calm, 0.3)), recorded(truth)]
    trials[1] = Kymograph('late', trials[1].angles, FPS, first=1000)
    cycle = deepest_cycle(trials, fitted(*trials))
    assert cycle.trial == 1
    assert 1160 < 0.5 * (cycle.start + cycle.stop) < 1260
    assert cycle.stop - cycle.start == pytest.approx(FPS / 0.6, abs=8)


def test_what_no_gait_can_be_made_of_is_refused(robot: Robot) -> None:
    short = recorded(turning(frames=40))
    with pytest.raises(BadInputError, match=r'^recording: .*cycle'):
        worm_gait([short], robot, 'x')
    fine = recorded(turning(1.0, 1.6))
    with pytest.raises(BadInputError, match=r'^k_f: '):
        worm_gait([fine], robot.with_yaw_joints(3), 'x')
    with pytest.raises(BadInputError, match=r'^harmonics: '):
        worm_gait([fine], robot, 'x', 0)
