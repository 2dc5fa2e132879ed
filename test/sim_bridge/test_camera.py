"""The camera looks at the real physics scene."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from omega_turn_ros.errors import BadInputError, SimulationError
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.camera import render_from_above
from omega_turn_sim_bridge.simulation import Simulation


@pytest.fixture
def simulation() -> Iterator[Simulation]:
    with Simulation(load_robot('limbless16')) as made:
        yield made


def head_in_picture(picture: np.ndarray) -> np.ndarray:
    """Column and row range of the orange head, shape (2, 2)."""
    red, green, blue = np.moveaxis(picture.astype(int), -1, 0)
    rows, columns = np.nonzero((red > 150) & (red > 2 * green) & (blue < 80))
    return np.array([[columns.min(), columns.max() + 1], [rows.min(), rows.max() + 1]])


def test_the_picture_has_the_size_asked_for(simulation: Simulation) -> None:
    picture = render_from_above(simulation, 200, 120)
    assert picture.shape == (120, 200, 3)
    assert picture.dtype == np.uint8


@pytest.mark.parametrize(('centre', 'span'), [((0.0, 0.0), 1.6), ((0.3, -0.2), 2.4)])
def test_the_head_is_where_the_physics_has_it(
    simulation: Simulation, centre: tuple[float, float], span: float
) -> None:
    robot = simulation.robot
    picture = render_from_above(simulation, 640, 480, centre, span)
    scale = span / 640  # [m/px]
    columns, rows = head_in_picture(picture)
    front = centre[0] + scale * (columns[1] - 320)
    assert front == pytest.approx(0.5 * robot.length, abs=2 * scale + 0.02 * robot.head_length)
    assert scale * np.ptp(columns) == pytest.approx(0.96 * robot.head_length, abs=2 * scale)
    middle = centre[1] - scale * (rows.mean() - 240)
    assert middle == pytest.approx(0.0, abs=2 * scale)
    assert scale * np.ptp(rows) == pytest.approx(robot.module_width, abs=2 * scale)


def test_a_body_that_bends_left_shows_its_head_higher(simulation: Simulation) -> None:
    before = head_in_picture(render_from_above(simulation, 320, 320, (0.0, 0.0), 1.6))
    bent = np.zeros(simulation.robot.n_joints)
    bent[0] = -0.8  # the body behind joint 1 turns clockwise, so the head looks left
    simulation.command(bent)
    simulation.step(200)
    after = head_in_picture(render_from_above(simulation, 320, 320, (0.0, 0.0), 1.6))
    assert after[1].mean() < before[1].mean() - 5


def test_looking_changes_nothing_and_two_scenes_stay_apart(simulation: Simulation) -> None:
    first = render_from_above(simulation, 160, 120)
    with Simulation(simulation.robot) as other:
        other.command(np.full(simulation.robot.n_joints, 0.3))
        other.step(100)
        assert not np.array_equal(render_from_above(other, 160, 120), first)
    assert np.array_equal(render_from_above(simulation, 160, 120), first)
    assert simulation.time == 0.0


@pytest.mark.parametrize(
    ('field', 'arguments'),
    [
        ('width', (0, 100, (0.0, 0.0), 1.0)),
        ('height', (100, 100_000, (0.0, 0.0), 1.0)),
        ('centre_xy', (100, 100, (0.0, float('nan')), 1.0)),
        ('span', (100, 100, (0.0, 0.0), -1.0)),
    ],
)
def test_a_view_that_makes_no_picture_is_refused_by_name(
    simulation: Simulation, field: str, arguments: tuple[int, int, tuple[float, float], float]
) -> None:
    with pytest.raises(BadInputError, match=f'^{field}: '):
        render_from_above(simulation, *arguments)


def test_a_closed_simulation_gives_no_picture() -> None:
    simulation = Simulation(load_robot('limbless16'))
    simulation.close()
    with pytest.raises(SimulationError):
        render_from_above(simulation)
