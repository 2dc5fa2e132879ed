"""Paths through shape space and where they take the body."""

from __future__ import annotations

import math

import numpy as np
import pytest

from omega_turn_ros.gaits.two_wave import two_wave_angles
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import body_velocity
from omega_turn_ros.mechanics.posture import unbend_heading
from omega_turn_ros.mechanics.trajectory import heading_along, pose_along, straight_path

SOLVER = 1e-5  # [rad per rad of shape change] accuracy of one body velocity, see force balance


def loop(steps: int, amplitude: float = 0.6) -> np.ndarray:
    """A closed path that turns the body: two waves, the amplitude of one rising and falling."""
    phase = np.linspace(0.0, 2.0 * np.pi, steps + 1)
    rising = amplitude * (1.0 + np.sin(phase - 2.75))
    return two_wave_angles(amplitude * np.sin(phase - 1.0), phase, rising, phase + 0.2, 1.5, 1, 8)


def test_way_there_and_back_turns_and_moves_nothing(chain: PlanarChain) -> None:
    there = loop(60)[:40]
    path = np.concatenate([there, there[-2::-1]])
    assert abs(heading_along(chain, there)[-1]) > 0.05
    assert heading_along(chain, path)[-1] == pytest.approx(0.0, abs=SOLVER)
    np.testing.assert_allclose(pose_along(chain, path)[-1], 0.0, atol=SOLVER)


def test_only_the_sequence_of_shapes_counts(chain: PlanarChain) -> None:
    """Pauses change nothing at all; other spacing along the loop only within the step error."""
    path = loop(180)
    heading = heading_along(chain, path)
    paused = np.repeat(path, np.arange(181) % 3 + 1, axis=0)
    assert heading_along(chain, paused)[-1] == pytest.approx(heading[-1], abs=SOLVER)
    time = np.linspace(0.0, 1.0, 271)
    warped = time + 0.1 * np.sin(2.0 * np.pi * time)
    phase = np.linspace(0.0, 1.0, 3601)
    fine = loop(3600)
    uneven = np.stack([np.interp(warped, phase, fine[:, i]) for i in range(8)], axis=1)
    assert heading_along(chain, uneven)[-1] == pytest.approx(heading[-1], abs=math.radians(0.05))


def test_backward_loop_turns_back(chain: PlanarChain) -> None:
    path = loop(90)
    there, back = heading_along(chain, path)[-1], heading_along(chain, path[::-1])[-1]
    assert abs(there) > 0.1
    assert back == pytest.approx(-there, abs=SOLVER)


def test_mirrored_loop_turns_the_other_way(chain: PlanarChain) -> None:
    path = loop(90)
    assert heading_along(chain, -path)[-1] == pytest.approx(
        -heading_along(chain, path)[-1], abs=SOLVER
    )


def test_waves_of_constant_amplitude_cannot_turn(chain: PlanarChain) -> None:
    """theta(t + T/2) = -theta(t): the second half cycle undoes the first."""
    phase = np.linspace(0.0, 2.0 * np.pi, 121)
    path = two_wave_angles(0.6, phase, 0.4, phase + 0.7, 1.5, 1.0, 8)
    heading = heading_along(chain, path)
    assert np.abs(heading).max() > 0.1
    assert heading[-1] == pytest.approx(0.0, abs=SOLVER)


def test_step_error_falls_with_the_square_of_the_step(chain: PlanarChain) -> None:
    coarse, middle, fine = (
        np.array([heading_along(chain, loop(n, size))[-1] for size in (0.3, 0.5, 0.7, 0.9, 1.1)])
        for n in (20, 60, 540)
    )
    # A ninth for a smooth integrand; friction's kinks leave it somewhat above.
    assert np.abs(middle - fine).mean() < 0.3 * np.abs(coarse - fine).mean()
    assert np.abs(middle - fine).max() < math.radians(0.5)


def test_heading_of_many_paths_is_that_of_each(chain: PlanarChain) -> None:
    paths = np.stack([loop(30), loop(30, 0.3), loop(30, -0.5)])
    together = heading_along(chain, paths)
    assert together.shape == (3, 31)
    assert (together[:, 0] == 0.0).all()
    for path, heading in zip(paths, together):
        np.testing.assert_allclose(heading_along(chain, path), heading, atol=SOLVER)


def test_pose_turns_by_the_heading(chain: PlanarChain) -> None:
    path = loop(60)
    pose = pose_along(chain, path)
    np.testing.assert_allclose(pose[:, 2], heading_along(chain, path), atol=1e-12)
    assert (pose[0] == 0.0).all()
    assert np.hypot(*pose[-1, :2]) > 0.01  # the loop does move the body


def test_pose_is_the_product_of_exact_rigid_motions(chain: PlanarChain) -> None:
    """Each step against the exponential of its twist, summed as a power series."""
    path = loop(12)  # large steps, up to 0.5 rad of turn
    step = np.diff(path, axis=0)
    world = np.eye(3)
    for shape, change in zip(path[:-1] + 0.5 * step, step):
        x, y, turn = body_velocity(chain, shape, change)
        twist = np.array([[0.0, -turn, x], [turn, 0.0, y], [0.0, 0.0, 0.0]])
        term, motion = np.eye(3), np.eye(3)
        for k in range(1, 25):
            term = term @ twist / k
            motion = motion + term
        world = world @ motion
    x, y, heading = pose_along(chain, path)[-1]
    # each shape is solved alone here and in one batch there
    np.testing.assert_allclose([x, y], world[:2, 2], atol=12 * SOLVER)
    assert heading == pytest.approx(math.atan2(world[1, 0], world[0, 0]), abs=12 * SOLVER)


def test_poses_of_two_paths_in_a_row_combine_as_rigid_motions(chain: PlanarChain) -> None:
    path = loop(60)
    whole = pose_along(chain, path)
    x, y, turn = pose_along(chain, path[25:])[-1]
    first = whole[25]
    c, s = math.cos(first[2]), math.sin(first[2])
    np.testing.assert_allclose(
        whole[-1],
        [first[0] + c * x - s * y, first[1] + s * x + c * y, first[2] + turn],
        atol=60 * SOLVER,
    )


def test_straight_path_is_a_line_from_start_to_end() -> None:
    path = straight_path([0.0, 1.0], [1.0, -1.0], steps=4)
    np.testing.assert_array_equal(
        path, [[0.0, 1.0], [0.25, 0.5], [0.5, 0.0], [0.75, -0.5], [1.0, -1.0]]
    )


def test_unbending_a_posture_takes_back_what_bending_it_turned(chain: PlanarChain) -> None:
    posture = np.random.default_rng(11).uniform(-0.9, 0.9, chain.n_joints)
    bending = heading_along(chain, straight_path(np.zeros(8), posture))[-1]
    assert abs(bending) > 0.01
    assert unbend_heading(chain, posture) == pytest.approx(-bending, abs=SOLVER)
    assert unbend_heading(chain, -posture) == pytest.approx(bending, abs=SOLVER)
    assert unbend_heading(chain, np.zeros(8)) == 0.0
