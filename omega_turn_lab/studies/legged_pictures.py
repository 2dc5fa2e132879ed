"""Figure of the robot with legs: shape space, height function, snapshots, rotation over A_3."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from omega_turn_lab.studies.figures import COLOURS, new_figure
from omega_turn_lab.studies.height import PATH_COLOUR, RED_BLACK
from omega_turn_lab.studies.legged_height import path_turn, shapes_at
from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.mechanics.cell_height import CellHeight
from omega_turn_ros.mechanics.legged import LeggedMotion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

BODIES = (6, 5)  # drawn over the shape space
INSTANTS = (0.0, 0.25, 0.5, 0.75, 1.0)  # of a cycle, snapshots
LOW_HIGH = (0.5, 1.0)  # scales of A_3 whose paths are drawn
PERIOD = 2.0 * math.pi
TICKS = ([0.0, 0.5, 1.0], ['0', r'$\pi$', r'$2\pi$'])


@dataclass(frozen=True, slots=True)
class Curves:
    """Rotation per cycle [deg].

    Attributes:
        fine: A_3 of the model [deg], shape (F,).
        model: by (loads, path), each shape (F,).
        a_3: of PyBullet's trials [deg].
        played: by (ground, path), None where it was not played; empty without PyBullet.
    """

    fine: Array
    model: Mapping[tuple[str, str], Array]
    a_3: Sequence[float]
    played: Mapping[tuple[str, str], Sequence[float | None]]


def draw_legged(
    path: Path,
    motion: LeggedMotion,
    gait: LeggedGait,
    field: CellHeight,
    curves: Curves,
    motions: Mapping[float, Mapping[str, Any]],
) -> None:
    """Draw the four panels into `path`.

    Args:
        path: of the picture.
        motion: the robot on its ground.
        gait: at the largest A_3.
        field: its height function.
        curves: rotation over A_3.
        motions: `poses`, `angles` and `fraction` of a cycle by A_3 [deg].
    """
    with new_figure(path, height=5.6, width=7.2) as figure:
        (shapes, heights), (snapshots, angles) = figure.subplots(2, 2)
        _draw_shapes(shapes, motion, gait)
        picture = _draw_height(heights, motion, gait, field)
        bar = figure.colorbar(picture, ax=heights, aspect=25)
        bar.set_label(
            'height function of rotation [rad$^{-1}$],\nmean over the delay of a leg pair'
        )
        bar.outline.set_visible(False)
        _draw_snapshots(snapshots, motion, motions)
        _draw_angles(angles, curves)
        for axes, letter in zip((shapes, heights, snapshots, angles), 'abcd'):
            axes.set_title(f'({letter})', loc='left', fontsize=9.0, x=-0.1)


def _draw_robot(axes: Axes, motion: LeggedMotion, q: Array, place: Array, frame: Array) -> None:
    """Draw one posture: body, legs, and a dot under each foot that is down.

    Args:
        axes: to draw into.
        motion: the robot.
        q: all joint angles [rad], shape (5 n - 1,).
        place: of its mean body frame in the picture, shape (2,).
        frame: what one metre forward and to the left is in the picture, rows, shape (2, 2).
    """
    robot = motion.robot
    body = motion.chain.outline(q[robot.yaw_indices], np.zeros(3)) @ frame + place
    hips = motion.feet.hips(q)
    feet = motion.feet.places(q)
    for hip, foot, down in zip(hips @ frame + place, feet @ frame + place, motion.feet.down(q)):
        axes.plot(*np.stack([hip, foot]).T, color='0.45', lw=0.8, zorder=2)
        if down:
            axes.plot(*foot, 'o', color=COLOURS[1], ms=1.8, mew=0.0, zorder=3)
    axes.plot(*body.T, color=PATH_COLOUR, lw=2.2, solid_capstyle='round', zorder=4)
    axes.plot(*body[0], 'o', color=PATH_COLOUR, ms=3.2, mew=0.0, zorder=4)


def _draw_shapes(axes: Axes, motion: LeggedMotion, gait: LeggedGait) -> None:
    """Postures over phi and w_3."""
    across, up = BODIES
    top = math.degrees(gait.a_3) * (1.0 + 1.0 / (up - 1))
    size = 0.8 / across / motion.robot.length
    # As high on paper as wide: the panel is about 1.35 times as wide as high.
    frame = np.array([[size, 0.0], [0.0, size * 2.0 * top * 1.35]])
    for i in range(across):
        for w in np.linspace(-gait.a_3, gait.a_3, up):
            phase = (i + 0.5) / across
            q = shapes_at(gait, np.array(phase * PERIOD), np.array(w))
            _draw_robot(axes, motion, q, np.array([phase, math.degrees(w)]), frame)
    axes.set(xlim=(0.0, 1.0), ylim=(-top, top), xlabel=r'$\phi$', ylabel='$w_3$ [deg]')
    axes.set_xticks(*TICKS)


def _draw_height(axes: Axes, motion: LeggedMotion, gait: LeggedGait, field: CellHeight) -> Any:
    """Height function with the forward path and two turning paths."""
    from matplotlib.colors import LinearSegmentedColormap

    # Each foot that comes down or goes up makes a ridge; over the delay of a pair there are two.
    window = round(gait.xi * field.mean.shape[0] / gait.n_pairs)
    shown = uniform_filter1d(field.mean, window, axis=0, mode='wrap')
    limit = float(np.abs(shown).max())
    low, high = np.degrees(field.second[[0, -1]])
    left = field.first[0] / PERIOD
    # The grid begins half a cell late; a period before it the same cells come again.
    twice = np.concatenate([shown, shown]).T
    picture = axes.imshow(
        twice,
        origin='lower',
        extent=(left - 1.0, left + 1.0, low, high),
        aspect='auto',
        interpolation='nearest',
        cmap=LinearSegmentedColormap.from_list('red_black', RED_BLACK),
        vmin=-limit,
        vmax=limit,
    )
    phase = np.linspace(0.0, 1.0, 241)
    axes.axhline(0.0, color=PATH_COLOUR, lw=1.4, ls='--', label='forward')
    for scale, style in zip(LOW_HIGH, ('-.', '-')):
        turn = path_turn(motion, gait, field, scale)
        surface, direct = math.degrees(turn.surface), math.degrees(turn.direct)
        a_3 = math.degrees(scale * gait.a_3)
        label = f'$A_3$ = {a_3:.0f}°: surface {surface:.1f}°, nonlinear {direct:.1f}°'
        w = np.degrees(scale * gait.offset(phase * PERIOD))
        axes.plot(phase, w, color='w', lw=3.0)
        axes.plot(phase, w, color=PATH_COLOUR, lw=1.6, ls=style, label=label)
    axes.legend(loc='lower left', fontsize=6.0, frameon=True, framealpha=0.9, handlelength=3.0)
    axes.set(xlim=(0.0, 1.0), ylim=(low, high), xlabel=r'$\phi$', ylabel='$w_3$ [deg]')
    axes.set_xticks(*TICKS)
    return picture


def _draw_snapshots(
    axes: Axes, motion: LeggedMotion, motions: Mapping[float, Mapping[str, Any]]
) -> None:
    """A cycle of each amplitude, side by side, first heading up the page."""
    wide = 0.75 * motion.robot.length
    for row, (a_3, record) in enumerate(motions.items()):
        poses, angles = np.array(record['poses']), np.array(record['angles'])
        for column, instant in enumerate(INSTANTS):
            k = int(np.argmin(np.abs(np.array(record['fraction']) - instant)))
            turned = poses[k, 2] - poses[0, 2]
            c, s = math.cos(turned), math.sin(turned)
            frame = np.array([[-s, c], [-c, -s]])
            start = poses[0, 2]
            moved = poses[k, :2] - poses[0, :2]
            ahead = math.cos(start) * moved[0] + math.sin(start) * moved[1]
            place = np.array([column * wide, ahead - 1.6 * row * motion.robot.length])
            _draw_robot(axes, motion, _grounded(motion, angles[k]), place, frame)
        at = -1.6 * row * motion.robot.length
        axes.text(-1.05 * wide, at, f'$A_3$ = {a_3:.0f}°', rotation=90, va='center')
    for column, instant in enumerate(INSTANTS):
        axes.text(column * wide, 0.98 * motion.robot.length, f'{6.0 * instant:.1f} s', ha='center')
    axes.set_aspect('equal')
    axes.axis('off')


def _grounded(motion: LeggedMotion, q: Array) -> Array:
    """Measured angles with lifts too small to leave the ground taken as none [rad]."""
    lift = np.array(motion.robot.joint_axes) == 'lift'
    return np.where(lift & (q < math.radians(1.0)), 0.0, q)


def _draw_angles(axes: Axes, curves: Curves) -> None:
    """Rotation per cycle over A_3: lines are the model, marks PyBullet."""
    styles = {'equal': ('-', 'equal loads'), 'static': ('--', 'loads of a level body')}
    colours: dict[str, str] = {}
    for loads, name in curves.model:
        colour = colours.setdefault(name, COLOURS[len(colours)])
        style, text = styles[loads]
        label = f'${_as_formula(name)}$, {text}'
        axes.plot(curves.fine, curves.model[loads, name], style, color=colour, label=label)
    for (ground, name), values in curves.played.items():
        pairs = [(a, v) for a, v in zip(curves.a_3, values) if v is not None]
        carpet = ground == 'carpet'
        axes.plot(
            *np.array(pairs).T,
            '^' if carpet else 'o',
            color=COLOURS[2] if carpet else colours[name],
            mfc='none',
            ms=5.0,
            label=f'PyBullet, {"carpet" if carpet else _dollar(name)}',
        )
    axes.set(xlabel='$A_3$ [deg]', ylabel='rotation per cycle [deg]', xlim=(-0.5, 20.5))
    axes.legend(fontsize=6.0)


def _as_formula(name: str) -> str:
    return 'w_3 = ' + name.replace('cos', r'\cos').replace('sin', r'\sin').replace('phi', r'\phi')


def _dollar(name: str) -> str:
    return f'${_as_formula(name)}$'
