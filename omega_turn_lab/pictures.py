"""One turn as a figure for a paper."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.body_shapes import (
    body_outlines,
    body_polygons,
    leg_lines,
    nice_step,
    sampled_at,
    turned_deg,
)
from omega_turn_lab.ground_view import LEVEL, GroundView
from omega_turn_lab.run_record import RunRecord
from omega_turn_ros.robot import LeggedRobot, Robot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

# Blue to red through violet: colour-blind readers tell the ends apart.
TIME_COLOURS = ('#1f62b0', '#7b4fa3', '#c8377a', '#c41a1a')
STYLE: dict[Any, Any] = {
    'font.family': 'sans-serif',
    'font.size': 8.0,
    'axes.titlesize': 8.0,
    'axes.linewidth': 0.6,
    'axes.spines.top': False,
    'axes.spines.right': False,
    'xtick.major.width': 0.6,
    'ytick.major.width': 0.6,
    'xtick.direction': 'out',
    'ytick.direction': 'out',
}
SNAPSHOTS = 5  # more of a turn in place hide each other
GRAIN_COLOUR = '#c9b48a'
STANDING: dict[str, Any] = {'facecolor': '0.35', 'zorder': 2.95}  # over bodies, below their ends
LYING: dict[str, Any] = {'facecolor': '0.93', 'edgecolor': '0.75', 'linewidth': 0.5, 'zorder': 0.4}
PALE = 0.3  # share of its colour in a body between start and end


def draw_turn(
    record: RunRecord,
    robot: Robot,
    command_deg: float,
    path: Path,
    ground: GroundView = LEVEL,
) -> None:
    """Draw the figure of one turn: the body from above, its heading and its joints over time.

    Args:
        record: the run.
        robot: the robot that made it.
        command_deg: the angle it was told to turn [deg], + = counter-clockwise.
        path: the PNG to write; missing folders are made.
        ground: what it turned on.

    Raises:
        BadInputError: the record is not of this robot.
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    outlines = body_outlines(record, robot)
    heading = turned_deg(record)
    chosen = _snapshots(outlines, SNAPSHOTS)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 3.7), dpi=200, layout='constrained')
        FigureCanvasAgg(figure)
        grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1.0))
        from_above = figure.add_subplot(grid[:, 0])
        over_time = figure.add_subplot(grid[0, 1])
        joints = figure.add_subplot(grid[1, 1], sharex=over_time)
        _draw_bodies(from_above, record, robot, outlines, chosen)
        _draw_ground(from_above, ground)
        _draw_heading(over_time, record.time, heading, command_deg, chosen)
        _draw_kymograph(figure, joints, record, robot)
        figure.align_ylabels([over_time, joints])
        turn = 'Turn while walking' if isinstance(robot, LeggedRobot) else 'Turn in place'
        figure.suptitle(
            f'{turn} of {robot.name}{ground.title}: commanded {_degrees(command_deg)}, '
            f'achieved {_degrees(heading[-1])}',
            fontsize=10,
        )
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path)


def _degrees(value: float) -> str:
    """Print an angle [deg] without '-0' and with a true minus sign."""
    text = f'{round(float(value), 1) + 0.0:.1f}'
    return text.replace('-', '\N{MINUS SIGN}') + '°'


def _snapshots(outlines: Array, count: int) -> NDArray[np.intp]:
    """Indices of instants between which the body moves equally far, first and last among them."""
    moved = np.linalg.norm(np.diff(outlines, axis=0), axis=-1).mean(axis=-1)
    travelled = np.concatenate([[0.0], np.cumsum(moved)])
    wanted = np.linspace(0.0, travelled[-1], count)
    nearest = np.abs(travelled[:, None] - wanted).argmin(axis=0)
    return np.unique(np.append(nearest, len(outlines) - 1))


def _colours(time: Array) -> tuple[Any, Any]:
    """Colour map over time, and the scale that feeds it."""
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    scale = Normalize(float(time[0]), float(max(time[-1], time[0] + 1e-9)))
    return LinearSegmentedColormap.from_list('time', TIME_COLOURS), scale


def _draw_bodies(
    axes: Axes, record: RunRecord, robot: Robot, outlines: Array, chosen: NDArray[np.intp]
) -> None:
    """Top view: bodies over time, path of the mean body frame, first and last heading."""
    from matplotlib.patheffects import withStroke
    from matplotlib.ticker import MultipleLocator

    colours, scale = _colours(record.time)
    ends = {0: 'start', len(record.time) - 1: 'end'}
    legs, down = leg_lines(record, robot)
    for place, index in enumerate(chosen):
        colour = colours(scale(record.time[index]))
        solid = index in ends
        order = 3.0 if solid else 2.0 + 0.1 * place  # the later covers the earlier
        _draw_legs(axes, legs[index], down[index], colour, order)
        _draw_body(axes, outlines[index], robot.module_width, colour, solid, order)
    for index, word in ends.items():
        colour = colours(scale(record.time[index]))
        _draw_heading_arrow(axes, record.pose[index], 0.62 * robot.length, colour, word)
    halo = withStroke(linewidth=2.4, foreground='w')
    axes.plot(*record.pose[:, :2].T, color='k', linewidth=1.0, zorder=5, path_effects=[halo])
    axes.set_aspect('equal', adjustable='datalim')
    axes.margins(0.05)
    axes.autoscale_view()
    step = nice_step(float(np.ptp(axes.dataLim.intervalx)) / 9.0)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(step))
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')
    axes.set_title('from above; colour is time, see the dots at right', loc='left', color='0.4')


def _draw_ground(axes: Axes, ground: GroundView) -> None:
    """Draw what stands there and grains; neither widens the view."""
    from matplotlib.collections import PolyCollection
    from matplotlib.lines import Line2D

    view = axes.viewLim
    reach = max(view.width, view.height)  # equal axes may widen the view up to a square
    middle = np.array([0.5 * (view.x0 + view.x1), 0.5 * (view.y0 + view.y1)])
    grains = ground.grains(middle - reach, middle + reach)
    dots: dict[str, Any] = {'linestyle': 'none', 'marker': '.', 'ms': 1.1, 'mew': 0, 'zorder': 0.5}
    axes.add_artist(Line2D(*grains.T, color=GRAIN_COLOUR, **dots))
    look = LYING if ground.carries else STANDING
    obstacles = PolyCollection(ground.obstacles, **look)
    axes.add_collection(obstacles, autolim=False)


def _draw_legs(
    axes: Axes, legs: Array, down: NDArray[np.bool_], colour: Any, order: float
) -> None:
    """Legs of one body, with a dot under each foot that is down."""
    for leg, stands in zip(legs, down):
        axes.plot(*leg.T, color=colour, linewidth=0.9, zorder=order)
        if stands:
            axes.plot(*leg[1], 'o', color=colour, markersize=2.0, zorder=order)


def _draw_body(
    axes: Axes, outline: Array, width: float, colour: Any, solid: bool, order: float
) -> None:
    """One body in its true width: solid with a white eye, or pale with its axis and a head dot."""
    from matplotlib.patches import Circle, PathPatch
    from matplotlib.path import Path as Shape

    tip, joint = outline[0], outline[1]
    centre = tip + 0.5 * width * _unit(joint - tip)
    # One path for all links: where they overlap the paint does not double.
    body = Shape.make_compound_path(*(Shape(p, closed=True) for p in _closed(outline, width)))
    # Opaque, with a white rim: bodies that cross stay apart where glass would make a tangle.
    axes.add_patch(PathPatch(body, facecolor='w', edgecolor='w', linewidth=1.6, zorder=order))
    paint = np.array(colour[:3])
    if not solid:
        tail = outline[-1] + 0.5 * width * _unit(outline[-2] - outline[-1])
        spine = np.vstack([centre, outline[1:-1], tail])
        axes.plot(*spine.T, color=colour, linewidth=0.9, zorder=order + 0.02)
        paint = 1.0 - PALE * (1.0 - paint)
    fill = PathPatch(body, facecolor=tuple(paint), linewidth=0, zorder=order + 0.01)
    fill.set_snap(False)  # or corners jump to whole pixels and the joints show as bumps
    axes.add_patch(fill)
    dot = 'w' if solid else colour
    axes.add_patch(
        Circle(tuple(centre), 0.27 * width, facecolor=dot, linewidth=0, zorder=order + 0.03)
    )


def _unit(vector: Array) -> Array:
    length: Array = vector / np.linalg.norm(vector)
    return length


def _closed(outline: Array, width: float) -> Array:
    """Link polygons with the first corner repeated, shape (N + 1, 2 ROUND + 1, 2)."""
    links = body_polygons(outline, width)
    return np.concatenate([links, links[:, :1]], axis=1)


def _draw_heading_arrow(axes: Axes, pose: Array, length: float, colour: Any, word: str) -> None:
    """Arrow from the mean body frame along its heading, past the head, with a word at its tip."""
    direction = np.array([math.cos(pose[2]), math.sin(pose[2])])
    tip = pose[:2] + length * direction
    style = {'arrowstyle': '-|>', 'color': colour, 'lw': 1.0, 'shrinkA': 0, 'shrinkB': 0}
    axes.annotate('', tuple(tip), tuple(pose[:2]), arrowprops=style, zorder=2.9)
    places = (('left', 'center', 'right'), ('bottom', 'center', 'top'))
    ha, va = (names[1 - round(d)] for names, d in zip(places, direction))
    axes.annotate(
        word,
        tuple(tip),
        tuple(3.0 * direction),
        textcoords='offset points',
        ha=ha,
        va=va,
        color=colour,
        fontweight='bold',
    )
    axes.update_datalim([tuple(tip + 0.15 * length * direction)])


def _draw_heading(
    axes: Axes, time: Array, heading: Array, command_deg: float, chosen: NDArray[np.intp]
) -> None:
    """Heading over time beside the commanded angle; dots tell when the bodies were seen."""
    from matplotlib.ticker import MaxNLocator

    colours, scale = _colours(time)
    axes.axhline(command_deg, color='0.4', linewidth=0.9, linestyle=(0, (5, 3)))
    axes.plot(time, heading, color='k', linewidth=1.1)
    axes.scatter(
        time[chosen],
        heading[chosen],
        s=26,
        c=colours(scale(time[chosen])),
        edgecolor='w',
        linewidth=0.7,
        zorder=3,
        clip_on=False,
    )
    up = 1.0 if command_deg >= 0.0 else -1.0
    axes.annotate(
        f'commanded {_degrees(command_deg)}',
        (time[0], command_deg),
        (3, 3 * up),
        textcoords='offset points',
        va='bottom' if up > 0 else 'top',
        color='0.4',
    )
    axes.annotate(
        _degrees(heading[-1]),
        (time[-1], heading[-1]),
        (7, 0),
        textcoords='offset points',
        va='center',
        color=colours(1.0),
        fontweight='bold',
        in_layout=False,  # there is room above the colour bar
    )
    axes.margins(x=0.0, y=0.12)
    axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 1.5, 3, 4.5, 9, 10]))
    axes.tick_params(labelbottom=False)
    axes.set_ylabel('heading [deg]')


def _draw_kymograph(figure: Figure, axes: Axes, record: RunRecord, robot: Robot) -> None:
    """Commanded yaw angles: joint by time."""
    time = np.linspace(record.time[0], record.time[-1], 400)
    angles = np.degrees(sampled_at(record, time).joint_commands[:, robot.yaw_indices])
    largest = max(1.0, float(np.abs(angles).max()))
    picture = axes.imshow(
        angles.T,
        aspect='auto',
        cmap='PuOr',
        vmin=-largest,
        vmax=largest,
        extent=(time[0], time[-1], robot.n_yaw + 0.5, 0.5),
        interpolation='nearest',
    )
    axes.set_xlabel('time [s]')
    axes.set_ylabel('yaw joint, head to tail')
    axes.set_yticks(range(1, robot.n_yaw + 1))
    bar = figure.colorbar(picture, ax=axes, pad=0.02)
    bar.set_label('commanded angle [deg]')
    bar.outline.set_visible(False)
