"""The pegboard's figure: angles over spacing, and the robot between the pegs from above."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_lab.studies.figures import COLOURS, MARKERS, new_figure
from omega_turn_lab.studies.motion_picture import draw_motion
from omega_turn_lab.studies.spread import Spread
from omega_turn_lab.studies.tasks import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DODGE = 0.007  # [BL] between the marks of two modes
EXTRA_COLOURS = (*COLOURS, '0.5', '#E69F00', '#56B4E9')
EXTRA_MARKERS = (*MARKERS, 'x', 'v', 'P')


def draw_pegboard(
    path: Path,
    spacings: Sequence[float],
    curves: Mapping[str, Sequence[Spread]],
    stressed: Collection[str],
    free: float,
    motions: Mapping[str, tuple[ObstacleTrial, Result]],
) -> None:
    """Draw the study.

    Args:
        path: of the picture.
        spacings: of the pegs [BL].
        curves: angle per cycle [deg] of each mode, one per spacing.
        stressed: modes drawn thick.
        free: angle per cycle on open ground [deg].
        motions: trials to be seen from above, by title.
    """
    with new_figure(path, 5.4) as figure:
        grid = figure.add_gridspec(2, len(motions), height_ratios=(1.15, 1.0))
        axes = figure.add_subplot(grid[0, :])
        _draw_angles(axes, spacings, curves, stressed, free)
        figure.legend(loc='outside upper center', ncols=2)
        for i, (title, (trial, result)) in enumerate(motions.items()):
            place = figure.add_subplot(grid[1, i])
            draw_motion(place, trial, result)
            place.set_title(title, fontsize=7.0)


def _draw_angles(
    axes: Axes,
    spacings: Sequence[float],
    curves: Mapping[str, Sequence[Spread]],
    stressed: Collection[str],
    free: float,
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
            linewidth=1.2 if mode in stressed else 0.4,
            elinewidth=0.6,
            capsize=2.0,
            label=mode,
        )
        axes.vlines(x, [s.low for s in spreads], [s.high for s in spreads], colour, linewidth=2.4)
    axes.set_xticks(list(spacings))
    axes.set_xlabel('spacing of the pegs [BL]')
    axes.set_title('thin: ± std, thick: 95 % interval of the mean', loc='left', fontsize=7.0)
    axes.set_ylabel('angle per cycle [deg]')
