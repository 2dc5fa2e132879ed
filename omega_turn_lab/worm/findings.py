"""The numbers of a recording that the paper speaks of, and what to beware of."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from omega_turn_lab.studies.published import paper_figure
from omega_turn_ros.worm.analysis import WormAnalysis
from omega_turn_ros.worm.to_gait import WormGait

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Finding:
    """One number of a recording beside the paper's.

    Attributes:
        case: what it is of.
        quantity: such as 'k'.
        unit: '1' or 'rad'.
        paper: the paper's number, None where it gives none.
        measured: ours.
        std: its standard deviation over resampled recordings, None where there is none.
    """

    case: str
    quantity: str
    unit: str
    paper: float | None
    measured: float
    std: float | None


@dataclass(frozen=True, slots=True)
class GaitResult:
    """A gait made of a worm.

    Attributes:
        made: the gait and how it came from the worm.
        path: its file.
        played: angle of a cycle in PyBullet [rad], None without PyBullet.
    """

    made: WormGait
    path: Path
    played: float | None


def findings(found: WormAnalysis) -> list[Finding]:
    """The numbers the paper speaks of: variance explained, and spatial frequencies."""
    count = len(found.sines)
    spread = found.spread
    together = found.components.explained
    rows = [_finding(f'{count} components', 'variance_explained', together, spread.explained)]
    for k, sine in enumerate(found.sines):
        rows.append(_finding(f'PC {k + 1}', 'k', sine.k, spread.component_k[:, k]))
    for pair in found.pairs:
        both = list(pair.components)
        case = f'PC {both[0] + 1} and {both[1] + 1}'
        rows.append(_finding(case, 'k', pair.k, spread.component_k[:, both].mean(axis=1)))
        rows.append(_finding(case, 'quality', pair.quality))
    waves = found.waves
    rows.append(_finding('turning wave', 'k', waves.k_t, spread.pair[:, 0]))
    rows.append(_finding('forward wave', 'k', waves.k_f, spread.pair[:, 1]))
    rows.append(_finding('both waves', 'variance_explained', waves.explained))
    return rows


def _finding(case: str, quantity: str, measured: float, samples: Array | None = None) -> Finding:
    paper, _ = paper_figure('worm', f'{case}: {quantity}', {})
    std = None if samples is None else float(samples.std(ddof=1))
    return Finding(case, quantity, '1', paper, measured, std)


def remarks(found: WormAnalysis) -> list[str]:
    """What a reader of the numbers should beware of."""
    said = []
    if not found.waves.distinct:
        said.append(
            'the two waves cannot be told apart here: one wave whose amplitude changes along the '
            'body explains these frames as well; k_t and k_f are as near as they are allowed'
        )
    for pair in found.pairs:
        if not pair.travels:
            names = ' and '.join(str(k + 1) for k in pair.components)
            said.append(f'PC {names} are no travelling wave (quality {pair.quality:.2f})')
    backward = [wave.backward_share for wave in found.waves.forward]
    if np.mean(backward) < 0.5:
        said.append(
            'the forward wave mostly travels towards the first column: the worm crawls backward, '
            'or that column is the tail (--tail-first)'
        )
    return said
