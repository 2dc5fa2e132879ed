"""Stokes' theorem on planes, cylinders and tori of shapes (eq:stokes)."""

from __future__ import annotations

import numpy as np
import pytest

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.height_function import ConnectionField, line_integral
from omega_turn_ros.mechanics.shape_grid import GridFunction, ShapeAxis

PERIOD = 2.0 * np.pi
TIME = np.linspace(0.0, PERIOD, 4001)
ORDER = 3.5  # at least, of the error in the grid step; the splines promise 4

CIRCLE = np.stack([0.2 + 0.6 * np.cos(TIME), -0.1 + 0.7 * np.sin(TIME)], axis=-1)
GRAPH = np.stack([TIME, 0.5 * (1.0 + np.sin(TIME - 2.0))], axis=-1)
DIAGONAL = np.stack([TIME, TIME + 1.3 + 0.2 * np.sin(2.0 * TIME)], axis=-1)
FLAT, CYLINDER, TORUS = (False, False), (True, False), (True, True)
CASES = pytest.mark.parametrize(
    ('cyclic', 'path'),
    [(FLAT, CIRCLE), (CYLINDER, CIRCLE), (CYLINDER, GRAPH), (TORUS, CIRCLE), (TORUS, DIAGONAL)],
    ids=['flat loop', 'loop on cylinder', 'around cylinder', 'loop on torus', 'around torus'],
)


def connection(r: np.ndarray, cyclic: tuple[bool, bool]) -> np.ndarray:
    """A smooth connection, periodic where asked, shape (..., 3, 2)."""
    x, y = np.moveaxis(r, -1, 0)
    if not cyclic[0]:
        x = 0.8 * x + 0.1 * x**2
    if not cyclic[1]:
        y = 0.9 * y - 0.2 * y**2
    first = [np.sin(x + y), np.cos(2.0 * x) * np.sin(y), 0.3 + np.cos(x - y)]
    second = [np.cos(x) ** 2, np.sin(y) + np.sin(x), 0.1 + np.sin(2.0 * x + y)]
    return np.stack([np.stack(first, axis=-1), np.stack(second, axis=-1)], axis=-1)


def field(n: int, cyclic: tuple[bool, bool]) -> ConnectionField:
    axes = tuple(ShapeAxis.phase(n) if c else ShapeAxis(np.linspace(-1.2, 1.4, n)) for c in cyclic)
    r = np.stack(np.meshgrid(axes[0].values, axes[1].values, indexing='ij'), axis=-1)
    return ConnectionField((axes[0], axes[1]), connection(r, cyclic), np.zeros((n, n)))


@CASES
def test_surface_and_loops_are_the_line_integral(
    cyclic: tuple[bool, bool], path: np.ndarray
) -> None:
    line = line_integral(connection(path, cyclic), path)
    fine = field(96, cyclic)
    for row in range(3):
        for reference in (0.0, 0.4):
            total = fine.surface(path, reference, row) + fine.loops(path, reference, row)
            assert total == pytest.approx(line[row], abs=2e-5)


@CASES
def test_error_falls_with_the_fourth_power_of_the_step(
    cyclic: tuple[bool, bool], path: np.ndarray
) -> None:
    line = line_integral(connection(path, cyclic), path)[2]
    errors = [
        abs(grid.surface(path) + grid.loops(path) - line)
        for grid in (field(16, cyclic), field(64, cyclic))
    ]
    assert errors[1] < errors[0] * 4.0**-ORDER + 2e-6  # the latter of the line integral itself


def test_surface_is_the_height_function_added_up_inside_a_loop() -> None:
    """By counting fine cells, with the sign of the sense of going round."""
    n = 400
    plane = field(n, FLAT)
    x, y = np.meshgrid(plane.axes[0].values, plane.axes[1].values, indexing='ij')
    inside = ((x - 0.2) / 0.6) ** 2 + ((y + 0.1) / 0.7) ** 2 < 1.0
    cell = (2.6 / (n - 1)) ** 2
    added = (plane.height[..., 2] * inside).sum() * cell
    assert plane.surface(CIRCLE) == pytest.approx(added, rel=5e-3)
    assert plane.surface(CIRCLE[::-1]) == pytest.approx(-plane.surface(CIRCLE), rel=1e-12)


def test_surface_on_a_cylinder_lies_between_reference_line_and_path() -> None:
    n = 400
    cylinder = field(n, CYLINDER)
    x, y = np.meshgrid(cylinder.axes[0].values, cylinder.axes[1].values, indexing='ij')
    under = (y > 0.0) & (y < 0.5 * (1.0 + np.sin(x - 2.0)))
    added = (cylinder.height[..., 2] * under).sum() * (PERIOD / n) * (2.6 / (n - 1))
    assert cylinder.surface(GRAPH) == pytest.approx(-added, abs=5e-3)


def test_surface_on_a_torus_is_one_corner_of_the_square_less_the_other() -> None:
    """Fig. height_function c: the triangles above and below the path tau_o = tau_f + psi."""
    n = 400
    psi = 83 * PERIOD / n
    torus = field(n, TORUS)
    x, y = np.meshgrid(torus.axes[0].values, torus.axes[1].values, indexing='ij')
    # half a cell counts where the path runs through it
    upper = np.heaviside(np.round(y - x - psi, 9), 0.5)
    lower = np.heaviside(np.round(x + psi - PERIOD - y, 9), 0.5)
    added = (torus.height[..., 2] * (upper - lower)).sum() * (PERIOD / n) ** 2
    path = np.stack([TIME, TIME + psi], axis=-1)
    assert torus.surface(path) == pytest.approx(added, abs=0.02)


def test_heights_of_a_torus_add_up_to_nothing() -> None:
    np.testing.assert_allclose(field(32, TORUS).height.mean(axis=(0, 1)), 0.0, atol=1e-12)


def test_height_is_the_curl() -> None:
    for cyclic in (FLAT, CYLINDER, TORUS):
        plane = field(80, cyclic)
        h = 1e-5
        r = np.stack(np.meshgrid(*(a.values for a in plane.axes), indexing='ij'), axis=-1)
        step = h * np.eye(2)
        by_first, by_second = (
            (connection(r + d, cyclic) - connection(r - d, cyclic)) / (2 * h) for d in step
        )
        expected = by_first[..., 1] - by_second[..., 0]
        np.testing.assert_allclose(plane.height, expected, atol=2e-3)


@pytest.mark.parametrize(
    ('cyclic', 'path', 'field_name'),
    [
        (FLAT, CIRCLE[:-7], 'path ends'),
        (FLAT, GRAPH, 'path ends'),
        (CYLINDER, DIAGONAL, 'path ends'),
        (FLAT, 3.0 * CIRCLE, 'r_1'),
        (CYLINDER, CIRCLE + np.array([0.0, 1.0]), 'r_2'),
        (FLAT, np.full((5, 2), np.nan), 'path'),
        (FLAT, CIRCLE[:, :1], 'path'),
    ],
)
def test_path_that_does_not_close_or_leaves_the_grid_is_refused(
    cyclic: tuple[bool, bool], path: np.ndarray, field_name: str
) -> None:
    with pytest.raises(BadInputError) as caught:
        field(16, cyclic).surface(path)
    assert caught.value.field == field_name


@pytest.mark.parametrize(
    ('values', 'cyclic'),
    [
        (np.arange(5.0), False),
        (np.arange(10.0) ** 2, False),
        (-np.arange(10.0), False),
        (np.full(10, np.nan), False),
        (np.linspace(0.0, PERIOD, 16), True),
    ],
)
def test_uneven_or_coarse_axes_are_refused(values: np.ndarray, cyclic: bool) -> None:
    with pytest.raises(BadInputError, match='axis values'):
        ShapeAxis(values, cyclic)


def test_tables_that_do_not_fit_their_axes_are_refused() -> None:
    axes = (ShapeAxis.phase(8), ShapeAxis.phase(9))
    with pytest.raises(BadInputError, match='table'):
        GridFunction(axes, np.zeros((9, 8)))
    with pytest.raises(BadInputError, match='matrix'):
        ConnectionField(axes, np.zeros((9, 8, 3, 2)), np.zeros((9, 8)))
    with pytest.raises(BadInputError, match='matrix'):
        line_integral(np.zeros((4, 3, 2)), np.zeros((5, 2)))


def test_interpolation_meets_the_table_and_the_function_on_both_sides_of_the_seam() -> None:
    axes = (ShapeAxis.phase(24), ShapeAxis(np.linspace(-1.0, 1.0, 24)))
    x, y = np.meshgrid(axes[0].values, axes[1].values, indexing='ij')
    table = np.sin(x) * y**2
    function = GridFunction(axes, table)
    np.testing.assert_allclose(function(x, y), table, atol=1e-12)
    for turn in (-PERIOD, 0.0, 3 * PERIOD):
        across = np.array([-0.11, 0.0, 0.07]) + turn
        np.testing.assert_allclose(function(across, 0.5), 0.25 * np.sin(across), atol=1e-4)
