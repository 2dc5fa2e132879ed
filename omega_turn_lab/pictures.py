"""One turn as a figure for a paper and as a moving picture, both seen from above."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_lab.run_record import RunRecord
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.robot import Robot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

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
SNAPSHOTS = 8
ROUND = 13  # corners of each half circle; odd, so that one lies at its tip

FRAME_SIZE = 480  # [px]
SUPERSAMPLING = 2  # drawn larger and shrunk, which smooths the edges
MAX_FRAMES = 150
HOLD = 1500  # [ms] the last frame stays before the picture starts again


def draw_turn(record: RunRecord, robot: Robot, command_deg: float, path: Path) -> None:
    """Draw the figure of one turn: the body from above, its heading and its joints over time.

    Args:
        record: the run.
        robot: the robot that made it.
        command_deg: the angle it was told to turn [deg], + = counter-clockwise.
        path: the PNG to write; missing folders are made.

    Raises:
        BadInputError: the record is not of this robot.
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    outlines = _outlines(record, robot)
    heading = _turned_deg(record)
    chosen = _snapshots(outlines, SNAPSHOTS)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 3.7), dpi=200, layout='constrained')
        FigureCanvasAgg(figure)
        grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1.0))
        from_above = figure.add_subplot(grid[:, 0])
        over_time = figure.add_subplot(grid[0, 1])
        joints = figure.add_subplot(grid[1, 1], sharex=over_time)
        _draw_bodies(from_above, record, robot, outlines, chosen)
        _draw_heading(over_time, record.time, heading, command_deg, chosen)
        _draw_kymograph(figure, joints, record, robot)
        figure.align_ylabels([over_time, joints])
        figure.suptitle(
            f'Turn in place of {robot.name}: commanded {_degrees(command_deg)}, '
            f'achieved {_degrees(heading[-1])}',
            fontsize=10,
        )
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path)


def animate_turn(
    record: RunRecord,
    robot: Robot,
    path: Path,
    frames_per_second: float = 12.0,
    speed: float = 1.0,
) -> None:
    """Write the turn as an animated GIF seen from above, the camera fixed.

    Args:
        record: the run.
        robot: the robot that made it.
        path: the GIF to write; missing folders are made.
        frames_per_second: of the picture, rounded to what GIF can say (1/100 s per frame).
        speed: seconds of the run per second watched; raised as far as a long run needs to stay
            within `MAX_FRAMES`.

    Raises:
        BadInputError: a rate that is not positive, or the record is not of this robot.
    """
    for field, value in (('frames_per_second', frames_per_second), ('speed', speed)):
        if not math.isfinite(value) or value <= 0.0:
            raise BadInputError(field, value, 'a finite number > 0')
    frame_ms = max(20, round(100.0 / frames_per_second) * 10)
    times, speed = _frame_times(record.time, 1e-3 * frame_ms, speed)
    scene = _Scene(_sampled(record, times), robot, speed)
    frames = [scene.frame(i) for i in range(len(times))]
    path.parent.mkdir(parents=True, exist_ok=True)
    frames[0].save(
        path,
        save_all=True,
        append_images=frames[1:],
        duration=[frame_ms] * (len(frames) - 1) + [HOLD],
        loop=0,
        optimize=True,
    )


def stadiums(
    starts: ArrayLike, ends: ArrayLike, width: float, overhang: tuple[ArrayLike, ArrayLike]
) -> Array:
    """Strips with round ends, as polygons.

    Args:
        starts: one end of each strip's axis [m], shape (..., M, 2).
        ends: the other end [m], shape (..., M, 2).
        width: of the strips [m].
        overhang: how far the tip of each round end reaches past `starts` and past `ends` [m], each
            a number or shape (M,).

    Returns:
        Corners [m], counter-clockwise, shape (..., M, 2 ROUND, 2).
    """
    a, b = np.asarray(starts, float), np.asarray(ends, float)
    axis = (b - a) / np.linalg.norm(b - a, axis=-1, keepdims=True)
    left = np.stack([-axis[..., 1], axis[..., 0]], axis=-1)
    radius = 0.5 * width
    a = a - (np.asarray(overhang[0], float) - radius)[..., None] * axis
    b = b + (np.asarray(overhang[1], float) - radius)[..., None] * axis
    bow = np.linspace(-0.5 * np.pi, 0.5 * np.pi, ROUND)
    c, s = radius * np.cos(bow)[:, None], radius * np.sin(bow)[:, None]
    front = b[..., None, :] + c * axis[..., None, :] + s * left[..., None, :]
    back = a[..., None, :] - c * axis[..., None, :] - s * left[..., None, :]
    return np.concatenate([front, back], axis=-2)


def body_polygons(outline: Array, width: float) -> Array:
    """The body's silhouette as overlapping strips, one per link, round at the joints.

    Args:
        outline: head tip, joints, tail tip [m], shape (..., N + 2, 2).
        width: of the body [m].

    Returns:
        Corners [m], shape (..., N + 1, 2 ROUND, 2).
    """
    reach = np.full(outline.shape[-2], 0.5 * width)
    reach[[0, -1]] = 0.0  # joints are covered, tips are not passed
    first, second = outline[..., :-1, :], outline[..., 1:, :]
    return stadiums(first, second, width, (reach[:-1], reach[1:]))


def module_polygons(outline: Array, robot: Robot) -> Array:
    """The body's modules as rounded strips, head first; pitch joints are taken as straight.

    Args:
        outline: head tip, yaw joints, tail tip [m], shape (N + 2, 2).
        robot: whose modules they are.

    Returns:
        Corners [m], shape (n_joints + 1, 2 ROUND, 2).
    """
    along = np.concatenate([[0.0], np.cumsum(robot.planar_link_lengths)])
    seams = np.concatenate([[0.0], np.cumsum(robot.body_lengths)])
    points = np.stack([np.interp(seams, along, outline[:, k]) for k in (0, 1)], axis=-1)
    gap = -0.03 * robot.module_length
    return stadiums(points[:-1], points[1:], robot.module_width, (gap, gap))


def nice_step(least: float) -> float:
    """Smallest of 1, 2, 5 times a power of ten that is not below `least`."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(power * digit for digit in (1, 2, 5, 10) if power * digit >= least)


def _outlines(record: RunRecord, robot: Robot) -> Array:
    """Body axes [m], shape (T, N + 2, 2)."""
    columns = np.shape(record.joint_positions)[1]
    if columns != robot.n_joints:
        raise BadInputError('joint_positions', columns, f'{robot.n_joints} joints of {robot.name}')
    yaw = record.joint_positions[:, robot.yaw_indices]
    return PlanarChain.of_robot(robot).outline(yaw, record.pose)


def _turned_deg(record: RunRecord) -> Array:
    """Heading since the start [deg], shape (T,)."""
    turned: Array = np.degrees(record.pose[:, 2] - record.pose[0, 2])
    return turned


def _degrees(value: float, digits: int = 1) -> str:
    """Print an angle [deg] with at most `digits` decimals, no '-0' and a true minus sign."""
    text = f'{round(float(value), digits) + 0.0:.{digits}f}'
    text = text.rstrip('0').rstrip('.') if '.' in text else text
    return text.replace('-', '\N{MINUS SIGN}') + '°'


def _snapshots(outlines: Array, count: int) -> NDArray[np.intp]:
    """Indices of instants between which the body moves equally far, first and last among them."""
    moved = np.linalg.norm(np.diff(outlines, axis=0), axis=-1).mean(axis=-1)
    travelled = np.concatenate([[0.0], np.cumsum(moved)])
    wanted = np.linspace(0.0, travelled[-1], count)
    nearest = np.abs(travelled[:, None] - wanted).argmin(axis=0)
    return np.unique(np.append(nearest, len(outlines) - 1))


def _sampled(record: RunRecord, times: Array) -> RunRecord:
    """The record at other times [s], linear in between."""

    def at(table: Array) -> Array:
        columns = np.asarray(table, float).reshape(len(record.time), -1)
        values = [np.interp(times, record.time, column) for column in columns.T]
        return np.stack(values, axis=-1).reshape(len(times), *np.shape(table)[1:])

    return RunRecord(
        times,
        at(record.pose),
        at(record.joint_positions),
        at(record.joint_commands),
        at(record.remaining),
    )


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
    for index in chosen:
        colour = colours(scale(record.time[index]))
        _draw_body(axes, outlines[index], robot.module_width, colour, solid=index in ends)
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


def _draw_body(axes: Axes, outline: Array, width: float, colour: Any, solid: bool) -> None:
    """One body in its true width: solid with a white eye, or pale with its axis and a head dot."""
    from matplotlib.patches import Circle, PathPatch
    from matplotlib.path import Path as Shape

    tip, joint = outline[0], outline[1]
    centre = tip + 0.5 * width * _unit(joint - tip)
    # One path for all links: where they overlap the paint does not double.
    body = Shape.make_compound_path(*(Shape(p, closed=True) for p in _closed(outline, width)))
    order = 3.0 if solid else 2.0
    if solid:
        axes.add_patch(PathPatch(body, facecolor='w', edgecolor='w', linewidth=1.6, zorder=order))
    else:
        tail = outline[-1] + 0.5 * width * _unit(outline[-2] - outline[-1])
        spine = np.vstack([centre, outline[1:-1], tail])
        axes.plot(*spine.T, color=colour, linewidth=0.9, zorder=order)
    opacity = 1.0 if solid else 0.26
    fill = PathPatch(body, facecolor=colour, linewidth=0, alpha=opacity, zorder=order)
    fill.set_snap(False)  # or corners jump to whole pixels and the joints show as bumps
    axes.add_patch(fill)
    dot = 'w' if solid else colour
    axes.add_patch(
        Circle(tuple(centre), 0.27 * width, facecolor=dot, linewidth=0, zorder=order + 0.1)
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
    angles = np.degrees(_sampled(record, time).joint_commands[:, robot.yaw_indices])
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


def _frame_times(time: Array, frame_seconds: float, speed: float) -> tuple[Array, float]:
    """Instants shown [s], first and last of the run among them, and the speed that fits them."""
    duration = float(time[-1] - time[0])
    speed = max(speed, duration / ((MAX_FRAMES - 1) * frame_seconds))
    count = max(1, math.ceil(duration / (speed * frame_seconds) - 1e-9))
    shown = time[0] + speed * frame_seconds * np.arange(count + 1)
    return np.minimum(shown, time[-1]), speed


class _Scene:
    """A run seen from a fixed camera.

    Args:
        record: the run, one sample per frame.
        robot: the robot that made it.
        speed: seconds of the run per second watched, told in the picture.
    """

    PAPER, GRID, INK, FAINT = '#ffffff', '#e4e4e4', '#222222', '#8c8c8c'
    SPINE, MODULE, HEAD, TRAIL = '#3d5266', '#6d8ba6', '#e0702c', '#1f62b0'

    def __init__(self, record: RunRecord, robot: Robot, speed: float) -> None:
        from PIL import ImageFont

        self._record, self._robot, self._speed = record, robot, speed
        self._outlines = _outlines(record, robot)
        self._turned = _turned_deg(record)
        self._side = FRAME_SIZE * SUPERSAMPLING
        corners = self._outlines.reshape(-1, 2)
        low, high = corners.min(axis=0), corners.max(axis=0)
        self._centre = 0.5 * (low + high)
        # The strip of text above the ground must not cover the body.
        self._view = 1.16 * float((high - low).max()) + 2.0 * robot.module_width  # [m] per side
        self._font = ImageFont.load_default(size=0.042 * self._side)
        self._small = ImageFont.load_default(size=0.03 * self._side)
        self._palette = self._make_palette()
        self._ground = self._draw_ground()

    def frame(self, index: int) -> Image:
        """Draw one instant, as a palette image of FRAME_SIZE squared."""
        from PIL import Image, ImageDraw

        picture = self._ground.copy()
        draw = ImageDraw.Draw(picture)
        trail = self._pixels(self._record.pose[: index + 1, :2])
        if len(trail) > 1:
            draw.line(trail, fill=self.TRAIL, width=3 * SUPERSAMPLING // 2, joint='curve')
        for polygon in body_polygons(self._outlines[index], 0.7 * self._robot.module_width):
            draw.polygon(self._pixels(polygon), fill=self.SPINE)
        modules = module_polygons(self._outlines[index], self._robot)
        for k, polygon in enumerate(modules):
            draw.polygon(self._pixels(polygon), fill=self.MODULE if k else self.HEAD)
        self._draw_arrow(draw, self._record.pose[index], self.INK)
        self._draw_text(draw, index)
        small = picture.resize((FRAME_SIZE, FRAME_SIZE), Image.Resampling.BOX)
        return small.quantize(palette=self._palette, dither=Image.Dither.NONE)

    def _pixels(self, points: Array) -> list[tuple[float, float]]:
        """World [m] to picture [px], y up."""
        scale = self._side / self._view
        middle = 0.5 * self._side
        x = middle + scale * (points[..., 0] - self._centre[0])
        y = middle - scale * (points[..., 1] - self._centre[1])
        return list(zip(x.tolist(), y.tolist()))

    def _draw_ground(self) -> Image:
        """Grid, scale bar and first heading: all that stays the same."""
        from PIL import Image, ImageDraw

        picture = Image.new('RGB', (self._side, self._side), self.PAPER)
        draw = ImageDraw.Draw(picture)
        step = nice_step(self._view / 12.0)
        reach = 0.5 * self._view
        for axis in (0, 1):
            first = math.ceil((self._centre[axis] - reach) / step)
            last = math.floor((self._centre[axis] + reach) / step)
            for k in range(first, last + 1):
                line = np.tile(self._centre, (2, 1))
                line[:, axis] = k * step
                line[:, 1 - axis] += (-reach, reach)
                draw.line(self._pixels(line), fill=self.GRID, width=SUPERSAMPLING)
        self._draw_scale_bar(draw, step)
        self._draw_arrow(draw, self._record.pose[0], self.FAINT)
        return picture

    def _draw_scale_bar(self, draw: ImageDraw, step: float) -> None:
        length = 2.0 * step
        pixels = length * self._side / self._view
        x, y = 0.04 * self._side, 0.96 * self._side
        draw.line([(x, y), (x + pixels, y)], fill=self.INK, width=2 * SUPERSAMPLING)
        draw.text((x, y - 6), f'{length:g} m', fill=self.INK, font=self._small, anchor='lb')

    def _draw_arrow(self, draw: ImageDraw, pose: Array, colour: str) -> None:
        """Heading arrow from the mean body frame."""
        direction = np.array([math.cos(pose[2]), math.sin(pose[2])])
        side = np.array([-direction[1], direction[0]])
        length, barb = 0.35 * self._robot.length, 0.03 * self._view
        tip = pose[:2] + length * direction
        neck = tip - 1.3 * barb * direction
        draw.line(self._pixels(np.array([pose[:2], neck])), fill=colour, width=2 * SUPERSAMPLING)
        head = np.array([tip, neck + 0.5 * barb * side, neck - 0.5 * barb * side])
        draw.polygon(self._pixels(head), fill=colour)

    def _draw_text(self, draw: ImageDraw, index: int) -> None:
        edge, top = 0.04 * self._side, 0.035 * self._side
        time = self._record.time[index] - self._record.time[0]
        pace = '' if abs(self._speed - 1.0) < 0.05 else f'  (x {self._speed:.2g})'
        draw.text((edge, top), f'{time:.1f} s{pace}', fill=self.INK, font=self._font, anchor='lt')
        turned = f'turned {round(float(self._turned[index])):d}°'
        draw.text((self._side - edge, top), turned, fill=self.INK, font=self._font, anchor='rt')

    def _make_palette(self) -> Image:
        """Every colour and its steps towards paper and ink, which smoothed edges need."""
        from PIL import Image, ImageColor

        def mixed(one: str, other: str) -> list[int]:
            a, b = (np.array(ImageColor.getrgb(c), float) for c in (one, other))
            steps = np.linspace(0.0, 1.0, 7)[:, None]
            return [round(value) for value in ((1.0 - steps) * a + steps * b).ravel().tolist()]

        pairs = [(self.PAPER, c) for c in (self.INK, self.FAINT, self.TRAIL)]
        pairs += [(c, self.PAPER) for c in (self.SPINE, self.MODULE, self.HEAD)]
        pairs += [(self.SPINE, self.MODULE), (self.SPINE, self.HEAD)]
        pairs += [(c, self.INK) for c in (self.MODULE, self.HEAD, self.FAINT)]
        values = [*ImageColor.getrgb(self.GRID)]
        for pair in pairs:
            values += mixed(*pair)
        palette = Image.new('P', (1, 1))
        palette.putpalette(values)
        return palette
