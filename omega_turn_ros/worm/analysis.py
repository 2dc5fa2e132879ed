"""The whole analysis of one or several trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.worm.components import (
    Components,
    centred,
    common_positions,
    principal_components,
)
from omega_turn_ros.worm.kymograph import Kymograph
from omega_turn_ros.worm.pairing import WavePair, pair_components, typical_frequency
from omega_turn_ros.worm.resampling import Spread, resample
from omega_turn_ros.worm.sines import SineFit, fit_sine
from omega_turn_ros.worm.template import TwoWaves, fit_two_waves

MOST_COMPONENTS = 12  # all ways to pair them are tried


@dataclass(frozen=True, slots=True)
class WormAnalysis:
    """What a recording is made of.

    Attributes:
        trials: the recordings, all with equal N.
        mean_posture: 'remove' or 'keep'.
        components: principal components.
        sines: sine and cosine fitted to each component.
        pairs: components that make waves together.
        waves: the two-wave template.
        spread: of the spatial frequencies.
        frequency: of the undulation [Hz].
    """

    trials: tuple[Kymograph, ...]
    mean_posture: str
    components: Components
    sines: tuple[SineFit, ...]
    pairs: tuple[WavePair, ...]
    waves: TwoWaves
    spread: Spread
    frequency: float


def analyse(
    trials: Sequence[Kymograph],
    count: int = 4,
    mean_posture: str = 'remove',
    seed: int = 0,
) -> WormAnalysis:
    """Find components, waves and their uncertainty in pooled trials.

    Args:
        trials: recordings of equal frame rate; with unequal numbers of body positions all are
            brought to the smallest.
        count: how many components to keep.
        mean_posture: see `centred`.
        seed: of the resampling.

    Raises:
        BadInputError: an argument is out of range, or frame rates differ.
    """
    if not 2 <= count <= MOST_COMPONENTS:
        raise BadInputError('components', count, f'2..{MOST_COMPONENTS}')
    equal = common_positions(trials)
    rates = sorted({trial.fps for trial in equal})
    if len(rates) > 1:
        raise BadInputError('fps', rates, 'the same for all trials')
    postures = [centred(trial, mean_posture) for trial in equal]
    components = principal_components(postures, count)
    sines = tuple(fit_sine(shape) for shape in components.shapes)
    pairs = pair_components(components, rates[0])
    waves = fit_two_waves(postures, [trial.angles for trial in equal], rates[0])
    frequency = typical_frequency(components.scores, rates[0])
    found = (waves.k_t, waves.k_f)
    spread = resample(postures, components.shapes, found, rates[0] / frequency, seed)
    return WormAnalysis(
        tuple(equal), mean_posture, components, sines, tuple(pairs), waves, spread, frequency
    )
