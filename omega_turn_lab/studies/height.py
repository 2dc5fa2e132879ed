"""Height functions, limits and gait paths on the three sub-shape spaces (fig:height_function).

Rows: bodies over each plane, what joint limit and self-collision forbid, and the rotational height
function with the path of the gait. Its turn is given three ways: surface integral with the loops
that belong to it, line integral of the linear connection, and nonlinear integration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.body_shapes import body_polygons
from omega_turn_lab.studies.figures import new_figure
from omega_turn_ros.design.problem import DesignProblem
from omega_turn_ros.design.sub_shape import PLANES, SubShape, grid
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.height_function import ROTATION, ConnectionField, line_integral
from omega_turn_ros.mechanics.local_connection import local_connection
from omega_turn_ros.mechanics.shape_grid import PERIOD, ShapeAxis

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

POINTS = 96  # of the height function along each axis
FINE = 180  # of the feasibility map
STEPS = 1440  # of the path
REACH = 1.25  # largest amplitude drawn, over the joint limit
BODIES = (7, 5)  # drawn over a plane
SYMBOLS = {'turning': (r'\tau_o', 'A_o'), 'forward': (r'\tau_f', 'A_f')}
SYMBOLS['phase'] = (r'\tau_f', r'\tau_o')
PATHS = {'turning': '$f_2$', 'forward': '$f_1$', 'phase': '$f_3$'}
PATH_COLOUR = '#1f6fd0'
OVER_LIMIT, COLLIDES = '#b9b9b9', '#000000'
RED_BLACK = ('#1a1a1a', '#8c8c8c', '#ffffff', '#f08a80', '#b00d0d')  # as the paper's


@dataclass(frozen=True, slots=True)
class PlaneTurn:
    """The turn of a gait, by its path in one plane.

    Attributes:
        surface: surface integral of the height function [rad].
        loops: what belongs to it by `mechanics.height_function` [rad].
        line: integral of the linear connection along the path [rad].
        direct: integral of the nonlinear force balance [rad].
        misfit: of the linear connection, mean over the path [-].
    """

    surface: float
    loops: float
    line: float
    direct: float
    misfit: float


def plane_turn(sub: SubShape, field: ConnectionField) -> PlaneTurn:
    """Turn of the gait of a plane three ways."""
    path = sub.path(STEPS)
    along = local_connection(sub.problem.motion, *sub.shapes(path))
    return PlaneTurn(
        surface=field.surface(path),
        loops=field.loops(path),
        line=float(line_integral(along.matrix, path)[ROTATION]),
        direct=sub.problem.turn(sub.problem.path(sub.gait, STEPS)),
        misfit=float(along.misfit.mean()),
    )


def height_rows(problem: DesignProblem, gait: WaveGait) -> list[tuple[str, str, str, float]]:
    """Turn of a gait on its three planes, as (case, quantity, unit, value).

    Raises:
        BadInputError: the gait is not of eq:prescribe_amp.
    """
    rows = []
    for sub in _planes(problem, gait):
        turn = plane_turn(sub, sub.field(POINTS, _reach(sub)))
        first, second = SYMBOLS[sub.plane]
        case = f'{first}, {second}'.replace('\\', '')
        for name in ('surface', 'loops', 'line', 'direct'):
            rows.append((case, name, 'deg', math.degrees(getattr(turn, name))))
        rows.append((case, 'misfit', '1', turn.misfit))
    return rows


def draw_height(problem: DesignProblem, gait: WaveGait, out: Path) -> None:
    """Draw the figure into `out`/height.png.

    Raises:
        BadInputError: the gait is not of eq:prescribe_amp.
    """
    subs = _planes(problem, gait)
    fields = [sub.field(POINTS, _reach(sub)) for sub in subs]
    with new_figure(out / 'height.png', height=6.9, width=7.2) as figure:
        grid_of_axes = figure.subplots(3, 3)
        pictures = []
        for column, (sub, field) in enumerate(zip(subs, fields)):
            shapes, limits, heights = grid_of_axes[:, column]
            shapes.set_title(_name(sub, 'abc'[column]), fontsize=9.0)
            _draw_bodies(shapes, sub)
            _draw_limits(limits, sub)
            pictures.append(_draw_height(heights, sub, field))
            heights.set_title(_account(plane_turn(sub, field)), fontsize=6.5, loc='left')
            _draw_path(limits, sub)
            _draw_path(heights, sub)
            for axes in (shapes, limits, heights):
                _dress(axes, sub, labelled=axes is heights)
        for axes, picture in zip(grid_of_axes[2], pictures):
            bar = figure.colorbar(picture, ax=axes, orientation='horizontal', aspect=30)
            bar.set_label('height function of rotation [rad$^{-1}$]')
            bar.outline.set_visible(False)


def _planes(problem: DesignProblem, gait: WaveGait) -> list[SubShape]:
    if not isinstance(gait, TwoWaveGait):
        raise BadInputError('gait', type(gait).__name__, 'a TwoWaveGait (eq:prescribe_amp)')
    return [SubShape(problem, gait, plane) for plane in PLANES]


def _name(sub: SubShape, letter: str) -> str:
    first, second = SYMBOLS[sub.plane]
    return f'({letter})  plane of ${first}$ and ${second}$, path {PATHS[sub.plane]}'


def _account(turn: PlaneTurn) -> str:
    """Say the turn three ways [deg], with true minus signs."""
    angles = (turn.surface, turn.loops, turn.surface + turn.loops, turn.line, turn.direct)
    surface, loops, total, line, direct = (f'{math.degrees(a):.1f}°' for a in angles)
    text = f'surface {surface} + loops {loops} = {total}\nline {line}, nonlinear {direct}'
    return text.replace('-', '\N{MINUS SIGN}')


def _reach(sub: SubShape) -> float:
    """Largest amplitude of the picture [rad]: past the limit, and past the path."""
    largest = float(np.abs(sub.path(STEPS)[:, 1]).max()) if sub.plane != 'phase' else 0.0
    return max(REACH * sub.problem.theta_max, 1.05 * largest)


def _bounds(sub: SubShape) -> tuple[float, float, float, float]:
    """Picture of a plane: phases in turns, amplitudes in degrees."""
    if sub.plane == 'phase':
        return 0.0, 1.0, 0.0, 1.0
    reach = math.degrees(_reach(sub))
    return 0.0, 1.0, -reach, reach


def _in_picture(sub: SubShape, r: Array) -> tuple[Array, Array]:
    second = r[..., 1] / PERIOD if sub.plane == 'phase' else np.degrees(r[..., 1])
    return r[..., 0] / PERIOD, second


def _dress(axes: Axes, sub: SubShape, labelled: bool) -> None:
    """Limits, ticks and labels of a plane."""
    first, second = SYMBOLS[sub.plane]
    left, right, bottom, top = _bounds(sub)
    axes.set(xlim=(left, right), ylim=(bottom, top))
    if labelled:
        axes.set_xlabel(f'${first}$', labelpad=1)
    phases = ([0.0, 0.5, 1.0], ['0', r'$\pi$', r'$2\pi$'])
    axes.set_xticks(*phases)
    if sub.plane == 'phase':
        axes.set_yticks(*phases)
        axes.set_ylabel(f'${second}$', labelpad=2)
    else:
        axes.set_yticks([-90, -45, 0, 45, 90])
        axes.set_ylabel(f'${second}$ [deg]', labelpad=0)
    for spine in axes.spines.values():
        spine.set_visible(True)


def _draw_bodies(axes: Axes, sub: SubShape) -> None:
    """Bodies over the plane, blue where feasible."""
    from matplotlib.collections import PolyCollection

    across, up = BODIES
    left, right, bottom, top = _bounds(sub)
    amplitude = PERIOD if sub.plane == 'phase' else _reach(sub)
    low = 0.0 if sub.plane == 'phase' else -amplitude
    first = (np.arange(across) + 0.5) / across * PERIOD
    second = low + (np.arange(up) + 0.5) / up * (amplitude - low)
    r = np.stack(np.meshgrid(first, second, indexing='ij'), axis=-1).reshape(-1, 2)
    theta, _ = sub.shapes(r)
    limits = sub.feasibility(r)
    chain = sub.problem.chain
    # One body length takes the width of a cell, on paper as high as wide.
    size = 0.9 / across / chain.lengths.sum()
    stretch = np.array([right - left, (top - bottom) * across / up]) * size
    polygons = body_polygons(chain.outline(theta, np.zeros(3)), sub.problem.width)
    for body, place, over, collides in zip(
        polygons, np.stack(_in_picture(sub, r), axis=-1), limits.over_limit, limits.collides
    ):
        colour = COLLIDES if collides else OVER_LIMIT if over else PATH_COLOUR
        axes.add_collection(
            PolyCollection(list(place + stretch * body), facecolor=colour, linewidth=0)
        )


def _fine_axes(sub: SubShape) -> tuple[ShapeAxis, ShapeAxis]:
    """Grid for contours, ends of the period included."""
    phase = ShapeAxis(np.linspace(0.0, PERIOD, FINE))
    reach = _reach(sub)
    return phase, phase if sub.plane == 'phase' else ShapeAxis(np.linspace(-reach, reach, FINE))


def _forbid(axes: Axes, sub: SubShape, over: str, collides: str, hatch: str | None) -> None:
    """Fill what either limit forbids."""
    r = grid(_fine_axes(sub))
    limits = sub.feasibility(r)
    x, y = _in_picture(sub, r)
    clearance = np.minimum(limits.clearance, sub.problem.width)
    for table, levels, colour in (
        (limits.bend, (1.0, np.inf), over),
        (clearance, (-np.inf, 0.0), collides),
    ):
        axes.contourf(x, y, table, levels=levels, colors=[colour], hatches=[hatch], zorder=2)


def _draw_limits(axes: Axes, sub: SubShape) -> None:
    """Feasibility map: joint limit grey, self-collision black."""
    from matplotlib.patches import Patch

    _forbid(axes, sub, OVER_LIMIT, COLLIDES, None)
    if sub.plane == 'turning':
        limit = math.degrees(sub.problem.theta_max)
        handles = [
            Patch(facecolor=OVER_LIMIT, label=f'a joint beyond {limit:.0f}°'),
            Patch(facecolor=COLLIDES, label='self-collision'),
        ]
        axes.legend(
            handles=handles, loc='lower left', fontsize=6.0, frameon=True, framealpha=0.9
        ).set_zorder(6)


def _draw_height(axes: Axes, sub: SubShape, field: ConnectionField) -> Any:
    """Height function of rotation, forbidden shapes black with white stripes."""
    import matplotlib
    from matplotlib.colors import LinearSegmentedColormap

    table = field.height[..., ROTATION]
    allowed = np.abs(table[~sub.feasibility(grid(field.axes)).infeasible])
    largest = float(np.quantile(allowed if allowed.size else np.abs(table), 0.995))
    picture = axes.imshow(
        table.T,
        origin='lower',
        extent=_bounds(sub),
        aspect='auto',
        interpolation='bicubic',
        cmap=LinearSegmentedColormap.from_list('red_black', RED_BLACK),
        vmin=-largest,
        vmax=largest,
    )
    with matplotlib.rc_context({'hatch.color': '#6e6e6e', 'hatch.linewidth': 0.4}):
        _forbid(axes, sub, COLLIDES, COLLIDES, '/////')
    return picture


def _draw_path(axes: Axes, sub: SubShape) -> None:
    """Path of the gait, and the loops its surface is bounded by."""
    x, y = _in_picture(sub, sub.path(STEPS))
    if sub.plane == 'phase':
        y = np.mod(y, 1.0)
        y[1:][np.abs(np.diff(y)) > 0.5] = np.nan
        axes.plot([0, 1], [0, 0], [0, 0], [0, 1], color=PATH_COLOUR, lw=2.2, ls='--', zorder=4)
    else:
        axes.axhline(0.0, color=PATH_COLOUR, lw=1.1, ls='--', zorder=4)
    axes.plot(x, y, color='w', lw=3.2, zorder=4)
    axes.plot(x, y, color=PATH_COLOUR, lw=1.8, zorder=5)
