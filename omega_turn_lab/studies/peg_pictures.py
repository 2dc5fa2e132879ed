"""The pegboard's figure: angles over spacing, and the robot between the pegs from above."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from omega_turn_lab.body_shapes import body_polygons
from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_lab.studies.figures import COLOURS, MARKERS, new_figure
from omega_turn_lab.studies.spread import Spread
from omega_turn_lab.studies.tasks import Result
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_sim_bridge.peg_lattice import peg_positions

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DODGE = 0.007  # [BL] between the marks of two modes
SHAPES = 9  # drawn of a turn
MARGIN = 0.12  # [m] around the robot's way
EXTRA_COLOURS = (*COLOURS, '0.5', '#E69F00', '#56B4E9')
EXTRA_MARKERS = (*MARKERS, 'x', 'v', 'P')


def draw_pegboard(
    path: Path,
    spacings: Sequence[float],
    curves: Mapping[str, Sequence[Spread]],
    free: float,
    motions: Mapping[str, tuple[ObstacleTrial, Result]],
) -> None:
    """Draw the study.

    Args:
        path: of the picture.
        spacings: of the pegs [BL].
        curves: angle per cycle [deg] of each mode, one per spacing.
        free: angle per cycle on open ground [deg].
        motions: trials to be seen from above, by title.
    """
    with new_figure(path, 5.4) as figure:
        grid = figure.add_gridspec(2, len(motions), height_ratios=(1.15, 1.0))
        _draw_angles(figure.add_subplot(grid[0, :]), spacings, curves, free)
        figure.legend(loc='outside upper center', ncols=2)
        for i, (title, (trial, result)) in enumerate(motions.items()):
            place = figure.add_subplot(grid[1, i])
            _draw_motion(place, trial, result)
            turned = result['total_deg']
            place.set_title(f'{title}: {turned:.0f}° in {trial.cycles} cycles', fontsize=7.0)


def _draw_angles(
    axes: Axes, spacings: Sequence[float], curves: Mapping[str, Sequence[Spread]], free: float
) -> None:
    axes.axhline(free, color='0.6', linewidth=0.8, linestyle=':')
    axes.annotate('open ground', (spacings[-1], free), ha='right', va='bottom', color='0.4')
    for i, (mode, spreads) in enumerate(curves.items()):
        x = np.asarray(spacings) + DODGE * (i - 0.5 * (len(curves) - 1))
        means = [s.mean for s in spreads]
        colour = EXTRA_COLOURS[i]
        axes.errorbar(
            x,
            means,
            yerr=[s.deviation for s in spreads],
            color=colour,
            marker=EXTRA_MARKERS[i],
            ms=3.5,
            linewidth=0.9 if i < 2 else 0.5,
            elinewidth=0.6,
            capsize=2.0,
            label=mode,
        )
        axes.vlines(x, [s.low for s in spreads], [s.high for s in spreads], colour, linewidth=2.4)
    axes.set_xticks(list(spacings))
    axes.set_xlabel('spacing of the pegs [BL]')
    axes.set_title('thin: ± std, thick: 95 % interval of the mean', loc='left', fontsize=7.0)
    axes.set_ylabel('angle per cycle [deg]')


def _draw_motion(axes: Axes, trial: ObstacleTrial, result: Result) -> None:
    """Body over time between the pegs: pale at first, dark at the end, head marked."""
    from matplotlib.colors import to_rgb
    from matplotlib.patches import Circle, Polygon

    chain = PlanarChain.of_robot(trial.robot)
    poses, angles = np.array(result['poses']), np.array(result['yaw_angles'])
    chosen = np.linspace(0, len(poses) - 1, SHAPES).round().astype(int)
    outlines = chain.outline(angles[chosen], poses[chosen])
    for i, outline in enumerate(outlines):
        depth = 0.15 + 0.85 * i / (SHAPES - 1)
        # Mixed with white by hand: a body of see-through strips would show its overlaps.
        body, head = ((1.0 - depth) + depth * np.array(to_rgb(c)) for c in COLOURS[:2])
        for polygon in body_polygons(outline, trial.robot.module_width):
            axes.add_patch(Polygon(polygon, facecolor=body, lw=0, zorder=1 + i))
        axes.plot(*outline[0], 'o', color=head, ms=2.2, zorder=1 + i)
    low, high = (f(outlines.reshape(-1, 2), axis=0) for f in (np.min, np.max))
    for peg in peg_positions(trial.terrain, trial.robot, trial.seed):
        axes.add_patch(
            Circle(tuple(peg), trial.terrain.peg_radius, facecolor='0.25', lw=0, zorder=SHAPES + 1)
        )
    axes.set_xlim(low[0] - MARGIN, high[0] + MARGIN)
    axes.set_ylim(low[1] - MARGIN, high[1] + MARGIN)
    axes.set_aspect('equal')
    axes.axis('off')
