"""The JSON file of `omega_turn worm`: every number behind its table and its figure."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from omega_turn_lab.worm.findings import Finding, GaitResult
from omega_turn_lab.worm.options import WormOptions
from omega_turn_ros import __version__
from omega_turn_ros.worm.analysis import WormAnalysis
from omega_turn_ros.worm.components import centred
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.template import Wave, best_pair
from omega_turn_ros.worm.turns import Turn

DIGITS = 5  # of numbers over time


def write_record(
    path: Path,
    options: WormOptions,
    trials: Sequence[Kymograph],
    turns: Sequence[Sequence[Turn]],
    found: WormAnalysis,
    rows: Sequence[Finding],
    gaits: Sequence[GaitResult],
    seconds: float,
) -> None:
    """Write every number behind the table and the figure."""
    record = {
        'study': 'worm',
        'rows': [_rounded(asdict(row)) for row in rows],
        'seed': options.seed,
        'version': __version__,
        'seconds': round(seconds, 3),
        'reading': asdict(options.reading),
        'recordings': [_recording(*pair) for pair in zip(trials, turns)],
        'analysed': 'turns' if options.turns_only else 'all frames',
        'mean_posture': found.mean_posture,
        'undulation_hz': round(found.frequency, 6),
        'resampling': {'samples': len(found.spread.pair), 'block_frames': found.spread.block},
        'variance': _listed(found.components.variance, 9),
        'components': _components(found),
        'pairs': _pairs(found),
        'waves': _waves(found),
        'gaits': [_gait(result) for result in gaits],
    }
    path.write_text(json.dumps(record, indent=1, allow_nan=False) + '\n', encoding='utf-8')


def _rounded(row: dict[str, Any]) -> dict[str, Any]:
    return {k: round(v, 6) if isinstance(v, float) else v for k, v in row.items()}


def _listed(values: ArrayLike, digits: int = DIGITS) -> list[Any]:
    listed: list[Any] = np.round(np.asarray(values, float), digits).tolist()
    return listed


def _recording(trial: Kymograph, turns: Sequence[Turn]) -> dict[str, Any]:
    return {
        'name': trial.name,
        'frames': [trial.first, trial.first + trial.n_frames],
        'positions': trial.n_positions,
        'filled_frames': list(trial.filled),
        'turns': [
            {
                'frames': [turn.start, turn.stop],
                'peak_frame': turn.peak,
                'bend_deg': round(math.degrees(turn.bend), 3),
            }
            for turn in turns
        ],
    }


def _components(found: WormAnalysis) -> list[dict[str, Any]]:
    return [
        _rounded(asdict(sine))
        | {
            'k_std_resampled': round(float(found.spread.component_k[:, k].std(ddof=1)), 6),
            'shape': _listed(found.components.shapes[k]),
        }
        for k, sine in enumerate(found.sines)
    ]


def _pairs(found: WormAnalysis) -> list[dict[str, Any]]:
    return [
        _rounded(asdict(pair))
        | {
            'components': [k + 1 for k in pair.components],
            'quality': round(pair.quality, 6),
            'travels': pair.travels,
        }
        for pair in found.pairs
    ]


def _waves(found: WormAnalysis) -> dict[str, Any]:
    waves, pairs = found.waves, found.spread.pair
    low, high = np.quantile(pairs, (0.025, 0.975), axis=0)
    return {
        'k_t': round(waves.k_t, 6),
        'k_f': round(waves.k_f, 6),
        'k_t_std': round(float(pairs[:, 0].std(ddof=1)), 6),
        'k_f_std': round(float(pairs[:, 1].std(ddof=1)), 6),
        'k_t_interval_95': _listed([low[0], high[0]]),
        'k_f_interval_95': _listed([low[1], high[1]]),
        'distinct': waves.distinct,
        'explained': round(waves.explained, 6),
        'trials': [_trial(found, k) for k in range(len(found.trials))],
    }


def _trial(found: WormAnalysis, index: int) -> dict[str, Any]:
    trial, waves = found.trials[index], found.waves
    turning, forward = waves.turning[index], waves.forward[index]
    posture = centred(trial, found.mean_posture)
    k_t, k_f = best_pair(posture.T @ posture)
    lag = np.sum(turning.signal * forward.signal.conj())
    strength = float(np.sum(turning.amplitude * forward.amplitude))
    residual = waves.residual[index]
    return {
        'name': trial.name,
        'frames': [trial.first, trial.first + trial.n_frames],
        'own_k_t': round(k_t, 6),
        'own_k_f': round(k_f, 6),
        'turning': _wave(turning),
        'forward': _wave(forward),
        'psi': round(float(np.angle(lag)), 6),
        'psi_locking': round(float(abs(lag)) / strength, 6),
        'residual_rms': round(float(np.sqrt((residual**2).mean())), 6),
        'residual_rms_by_frame': _listed(np.sqrt((residual**2).mean(axis=1))),
        'scores': _listed(found.components.scores[index]),
    }


def _wave(wave: Wave) -> dict[str, Any]:
    amplitude = wave.amplitude
    return {
        'amplitude_mean': round(float(amplitude.mean()), 6),
        'amplitude_rms': round(float(np.sqrt((amplitude**2).mean())), 6),
        'amplitude_max': round(float(amplitude.max()), 6),
        'frequency_hz': round(wave.frequency, 6),
        'head_to_tail_share': round(wave.backward_share, 6),
        'amplitude': _listed(amplitude),
        'phase': _listed(wave.phase),
    }


def _gait(result: GaitResult) -> dict[str, Any]:
    made = result.made
    entry, cycle = made.entry, made.cycle
    return {
        'name': entry.name,
        'description': entry.description,
        'file': result.path.name,
        'robot': entry.robot,
        'angle_deg': {
            'quasi_static': _degrees(entry.calibration.largest_angle),
            'pybullet': None if result.played is None else _degrees(result.played),
            'unscaled': _degrees(made.unscaled),
        },
        'factor': round(made.factor, 6),
        'likeness': round(made.likeness, 6),
        'theta_max_deg': _degrees(entry.theta_max),
        'clearance_m': round(made.clearance, 6),
        'cycle': {
            'recording': cycle.trial,
            'frames': [cycle.start, cycle.stop],
            'mean_bend_deg': _degrees(cycle.bend),
        },
        'parameters': entry.gait.to_mapping(),
    }


def _degrees(angle: float) -> float:
    return round(math.degrees(angle), 4)
