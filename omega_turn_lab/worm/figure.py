"""The figure of `omega_turn worm`: postures, kymograph, fitted waves, components, variance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.studies.figures import COLOURS, new_figure
from omega_turn_ros.worm.analysis import WormAnalysis
from omega_turn_ros.worm.components import centred
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.sines import explained_by, sine_basis
from omega_turn_ros.worm.template import LEAST_APART
from omega_turn_ros.worm.turns import Turn, deepest_bend

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

WIDTH, HEIGHT = 7.2, 5.8  # [in] two journal columns
LONGEST = 30.0  # [s] of a recording that are shown
SNAPSHOTS = 7
SIDES = 'PuOr'  # of curvature: colour-blind readers tell them apart
TURNING, FORWARD = COLOURS[1], COLOURS[0]
BARS = 10  # components whose variance is shown
PAPER = (1.0, 1.5)  # k_t and k_f of the paper
GREYS = ('0.62', '0.69', '0.76', '0.83', '0.9', '0.95', '1.0')  # the darker, the better


def draw_worm(
    path: Path,
    trials: Sequence[Kymograph],
    turns: Sequence[Sequence[Turn]],
    found: WormAnalysis,
) -> None:
    """Draw the deepest bent of the trials analysed beside what was found in all of them.

    Args:
        path: the PNG to write.
        trials: the recordings.
        turns: found in each of them.
        found: what their frames, or the frames of their turns, are made of.
    """
    peaks = [float(np.abs(deepest_bend(trial.angles)).max()) for trial in found.trials]
    index = int(np.argmax(peaks))
    shown = _window(found.trials[index])
    marked = [
        turn
        for trial, own in zip(trials, turns)
        if trial.name == shown.name
        for turn in own
        if turn.stop > shown.first and turn.start < shown.first + shown.n_frames
    ]
    with new_figure(path, HEIGHT, WIDTH) as figure:
        halves: Any = figure.subfigures(1, 2, width_ratios=(1.5, 1.0))
        left, right = halves
        rows = left.subplots(4, 1, height_ratios=(0.42, 1.0, 1.0, 0.85))
        _draw_bodies(rows[0], shown)
        _draw_kymographs(left, rows[1:3], shown, found, index)
        _draw_amplitudes(rows[3], shown, found, index, marked)
        shapes, variance, spread = right.subplots(3, 1, height_ratios=(1.15, 0.8, 1.1))
        _draw_components(shapes, found)
        _draw_variance(variance, found)
        _draw_spread(right, spread, found)
        left.align_ylabels(rows[1:])


def _window(trial: Kymograph) -> Kymograph:
    """The part around the deepest bend, where a recording is too long to be seen."""
    most = int(LONGEST * trial.fps)
    if trial.n_frames <= most:
        return trial
    peak = int(np.abs(deepest_bend(trial.angles)).argmax())
    start = trial.first + min(max(peak - most // 2, 0), trial.n_frames - most)
    return trial.cut(start, start + most)


def _draw_bodies(axes: Axes, shown: Kymograph) -> None:
    """Postures from above over time, the deepest bend among them; the dot is the head."""
    frames = ((np.arange(SNAPSHOTS) + 0.5) / SNAPSHOTS * shown.n_frames).astype(int)
    peak = int(np.abs(deepest_bend(shown.angles)).argmax())
    frames[np.abs(frames - peak).argmin()] = peak
    segment = np.zeros(shown.n_positions + 1)
    for place, frame in enumerate(frames):
        segment[1:] = np.cumsum(shown.angles[frame])
        direction = segment - segment.mean()
        steps = np.column_stack([np.cos(direction), np.sin(direction)]) / segment.size
        body = np.concatenate([[(0.0, 0.0)], -np.cumsum(steps, axis=0)])
        body += (place + 0.5, 0.0) - 0.5 * (body.min(axis=0) + body.max(axis=0))
        axes.plot(*body.T, color='0.25', linewidth=2.0, solid_capstyle='round')
        axes.plot(*body[0], 'o', color=TURNING, markersize=3.5, clip_on=False)
        seconds = f'{shown.time[frame]:.1f} s'
        axes.annotate(seconds, (place + 0.5, -0.5), ha='center', va='top', fontsize=6.5)
    axes.set_xlim(0.0, SNAPSHOTS)
    axes.set_ylim(-0.75, 0.5)
    axes.set_aspect('equal')
    axes.set_axis_off()


def _draw_kymographs(
    figure: Any, rows: Sequence[Axes], shown: Kymograph, found: WormAnalysis, index: int
) -> None:
    """Curvature as recorded, and that of the two fitted waves."""
    waves = found.waves
    skipped = shown.first - found.trials[index].first
    frames = slice(skipped, skipped + shown.n_frames)
    pair = (waves.turning[index], waves.forward[index])
    turning, forward = (wave.angles(shown.n_positions)[frames] for wave in pair)
    fitted = (turning + forward) * shown.n_positions
    largest = float(np.quantile(np.abs(shown.curvature), 0.995))
    extent = (*_ends(shown), 1.0, 0.0)
    for axes, curvature, word in zip(rows, (shown.curvature, fitted), ('recorded', 'two waves')):
        picture = axes.imshow(
            curvature.T,
            aspect='auto',
            cmap=SIDES,
            vmin=-largest,
            vmax=largest,
            extent=extent,
            interpolation='nearest',
        )
        axes.set_title(word, loc='left', pad=2.0)
        axes.set_yticks([0.0, 1.0], ['head', 'tail'])
        axes.tick_params(labelbottom=False)
    bar = figure.colorbar(picture, ax=list(rows), pad=0.015, aspect=30)
    bar.set_label('curvature [BL$^{-1}$]')
    bar.outline.set_visible(False)


def _ends(shown: Kymograph) -> tuple[float, float]:
    return float(shown.time[0]), float(shown.time[-1] + 1.0 / shown.fps)


def _draw_amplitudes(
    axes: Axes, shown: Kymograph, found: WormAnalysis, index: int, turns: Sequence[Turn]
) -> None:
    """Amplitude of both waves over time; turns are shaded."""
    skipped = shown.first - found.trials[index].first
    frames = slice(skipped, skipped + shown.n_frames)
    waves = found.waves
    for wave, colour, word in (
        (waves.turning[index], TURNING, f'turning, $k_t$ = {waves.k_t:.2f}'),
        (waves.forward[index], FORWARD, f'forward, $k_f$ = {waves.k_f:.2f}'),
    ):
        size = wave.amplitude[frames] * shown.n_positions
        axes.plot(shown.time, size, color=colour, label=word)
    for turn in turns:
        axes.axvspan(turn.start / shown.fps, turn.stop / shown.fps, color='0.9', linewidth=0)
    axes.set_xlim(*_ends(shown))
    axes.set_ylim(0.0, 1.35 * axes.get_ylim()[1])
    axes.set_xlabel('time [s]')
    axes.set_ylabel('amplitude [BL$^{-1}$]')
    axes.legend(loc='upper left', ncols=2)


def _draw_components(axes: Axes, found: WormAnalysis) -> None:
    """Shapes of the components, one above the other, each with its fitted sine."""
    shapes = found.components.shapes
    positions = shapes.shape[1]
    place = (np.arange(positions) + 0.5) / positions
    step = 2.2 * float(np.abs(shapes).max())
    for k, (shape, sine) in enumerate(zip(shapes, found.sines)):
        level = -step * k
        axes.plot((0.0, 1.0), (level, level), color='0.8', linewidth=0.5)
        axes.plot(
            place, level + sine.values(positions), color=COLOURS[2], linewidth=2.6, alpha=0.5
        )
        axes.plot(place, level + shape, color='k')
        std = found.spread.component_k[:, k].std(ddof=1)
        axes.annotate(
            f'PC {k + 1}\n$k$ = {sine.k:.2f} ± {std:.2f}',
            (1.04, level),
            va='center',
        )
    axes.set_xlim(0.0, 1.6)
    axes.set_xticks([0.0, 1.0], ['head', 'tail'])
    axes.spines['bottom'].set_bounds(0.0, 1.0)
    axes.set_yticks([])
    axes.spines['left'].set_visible(False)
    axes.set_title('components and their sines', loc='left', pad=2.0)


def _draw_variance(axes: Axes, found: WormAnalysis) -> None:
    """Share of the variance of each component, and summed up."""
    share = 100.0 * found.components.variance[:BARS]
    kept = len(found.sines)
    number = np.arange(1, share.size + 1)
    total = np.cumsum(share)
    axes.bar(number, share, color=['0.35' if k < kept else '0.75' for k in range(share.size)])
    axes.plot(number, total, 'o-', color=COLOURS[2], markersize=3.0)
    axes.annotate(
        f'{total[kept - 1]:.1f} %',
        (number[kept - 1], total[kept - 1]),
        (2, -4),
        textcoords='offset points',
        va='top',
        color=COLOURS[2],
    )
    axes.set_ylim(0.0, 104.0)
    axes.set_xticks(number)
    axes.set_xlabel('component')
    axes.set_ylabel('variance [%]')


def _draw_spread(figure: Any, axes: Axes, found: WormAnalysis) -> None:
    """Variance that two waves explain, over their spatial frequencies."""
    moments = sum(x.T @ x for x in (centred(t, found.mean_posture) for t in found.trials))
    waves, pairs = found.waves, found.spread.pair
    k_t = np.linspace(max(0.1, min(0.5, waves.k_t - 0.3)), max(1.8, waves.k_t + 0.3), 81)
    k_f = np.linspace(max(0.4, min(0.9, waves.k_f - 0.3)), max(2.3, waves.k_f + 0.3), 81)
    grid = np.stack(np.meshgrid(k_t, k_f), axis=-1)
    apart = grid[..., 1] - grid[..., 0] >= LEAST_APART
    loss = np.full(apart.shape, math.nan)
    basis = sine_basis(grid[apart], moments.shape[0])
    loss[apart] = 100.0 * (waves.explained - explained_by(basis, moments) / np.trace(moments))
    levels = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
    picture = axes.contourf(
        k_t, k_f, np.maximum(loss, 0.0), levels, colors=GREYS, extend='max', antialiased=False
    )
    axes.plot(*pairs.T, '.', color=COLOURS[2], markersize=1.8, alpha=0.6, label='resampled')
    axes.plot(waves.k_t, waves.k_f, 'o', color=TURNING, markersize=5.0, label='fit')
    axes.plot(*PAPER, 'D', color=FORWARD, markersize=4.5, mfc='none', mew=1.2, label='paper')
    axes.set_xlim(k_t[0], k_t[-1])
    axes.set_ylim(k_f[0], k_f[-1])
    axes.set_xlabel('turning wave, $k_t$')
    axes.set_ylabel('forward wave, $k_f$')
    axes.legend(loc='lower right', handletextpad=0.2, borderpad=0.1)
    bar = figure.colorbar(picture, ax=axes, pad=0.02)
    bar.set_label('explained less than best [%]')
    bar.outline.set_visible(False)
