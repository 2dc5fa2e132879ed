"""How the figures of the studies look: one journal column wide, safe for colour-blind readers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN = 3.5  # [in] width of a journal column
# Okabe and Ito's colours, each with a marker of its own.
COLOURS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7')
MARKERS = ('o', 's', '^', 'D')
DODGE = 0.025  # of k_t, between our marks and the paper's
STYLE: dict[Any, Any] = {
    'font.family': 'sans-serif',
    'font.size': 7.5,
    'axes.labelsize': 8.0,
    'axes.titlesize': 8.0,
    'axes.linewidth': 0.6,
    'axes.spines.top': False,
    'axes.spines.right': False,
    'xtick.major.width': 0.6,
    'ytick.major.width': 0.6,
    'legend.fontsize': 7.0,
    'legend.frameon': False,
    'legend.handlelength': 1.6,
    'lines.linewidth': 1.1,
}


@dataclass(frozen=True, slots=True)
class Series:
    """One curve over k_t with what stands beside it.

    Attributes:
        label: in the legend.
        k: spatial frequencies of the turning wave.
        quasi_static: ours by force balance, as many.
        pybullet: ours in PyBullet, as many, or None.
        paper: (k, mean, standard deviation or None) of the paper's robot.
    """

    label: str
    k: Sequence[float]
    quasi_static: Sequence[float]
    pybullet: Sequence[float] | None
    paper: Sequence[tuple[float, float, float | None]]


@contextmanager
def new_figure(path: Path, height: float, width: float = COLUMN) -> Iterator[Figure]:
    """Give an empty figure of that size [in]; write it to `path` at the end."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width, height), dpi=300, layout='constrained')
        FigureCanvasAgg(figure)
        yield figure
        figure.savefig(path)


def draw_series(axes: Axes, series: Sequence[Series]) -> None:
    """Draw curves over k_t: lines are ours, open marks PyBullet, error bars the paper's robot."""
    for one, colour, marker in zip(series, COLOURS, MARKERS):
        axes.plot(one.k, one.quasi_static, color=colour, marker=marker, ms=3.2, label=one.label)
        if one.pybullet is not None:
            axes.plot(
                one.k,
                one.pybullet,
                linestyle='none',
                marker=marker,
                ms=6.5,
                markerfacecolor='none',
                markeredgecolor=colour,
                markeredgewidth=0.8,
            )
        for k, mean, deviation in one.paper:
            draw_paper(axes, k, mean, deviation, colour if len(series) > 1 else 'k')
    axes.set_xlabel('spatial frequency of the turning wave, $k_t$')
    axes.set_xticks(sorted({k for one in series for k in one.k}))
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))


def draw_paper(
    axes: Axes, x: float, mean: float, deviation: float | None, colour: str, dodge: float = DODGE
) -> None:
    """Draw the paper's mean and standard deviation, a little to the right of ours."""
    axes.errorbar(
        x + dodge,
        mean,
        yerr=deviation,
        color=colour,
        marker='_',
        ms=7,
        markeredgewidth=1.6,
        elinewidth=1.1,
        capsize=2.6,
        capthick=0.8,
        zorder=4,
    )


def add_legend(figure: Figure, axes: Axes, with_pybullet: bool) -> None:
    """Add a legend above everything: what the marks are, then what the colours are."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    grey = '0.3'
    marks = {'quasi-static': Line2D([], [], color=grey, marker='o', ms=3.2)}
    if with_pybullet:
        marks['PyBullet'] = Line2D(
            [], [], linestyle='none', marker='o', markersize=6.5, mfc='none', mec=grey
        )
    bar = axes.errorbar([], [], yerr=[], color=grey, marker='_', ms=7, mew=1.6, capsize=2.6)
    handles, labels = axes.get_legend_handles_labels()
    entries: dict[str, Any] = {**marks, 'paper, mean ± std': bar}
    families: dict[str, Any] = dict(zip(labels, handles)) if len(labels) > 1 else {}
    # Legends fill column by column; a blank evens the two rows out.
    columns = max(len(entries), len(families))
    rows = [list(part.items()) for part in (entries, families) if part]
    for row in rows:
        row += [(' ' * len(row), Patch(alpha=0.0))] * (columns - len(row))
    ordered = [row[column] for column in range(columns) for row in rows]
    figure.legend(
        [handle for _, handle in ordered],
        [label for label, _ in ordered],
        loc='outside upper center',
        ncols=columns,
        columnspacing=1.2,
    )
