"""Principal components of postures, pooled over trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.worm.kymograph import Kymograph

Array = NDArray[np.float64]

MEAN_POSTURES = ('remove', 'keep')


@dataclass(frozen=True, slots=True)
class Components:
    """Principal components of all frames of all trials.

    Attributes:
        shapes: orthonormal, the strongest first, shape (M, N). Their largest entry is positive.
        variance: share of the variance explained by each of all N, falling, shape (N,).
        scores: weight of each component in each frame, one array per trial [rad], shape (T, M).
    """

    shapes: Array
    variance: Array
    scores: tuple[Array, ...]

    @property
    def explained(self) -> float:
        """Share of the variance that the components kept explain together."""
        return float(self.variance[: self.shapes.shape[0]].sum())


def common_positions(trials: Sequence[Kymograph]) -> list[Kymograph]:
    """Bring all trials to the smallest number of body positions among them.

    Raises:
        BadInputError: there is no trial.
    """
    if not trials:
        raise BadInputError('trials', 0, 'at least one')
    fewest = min(trial.n_positions for trial in trials)
    return [trial.resampled(fewest) for trial in trials]


def centred(trial: Kymograph, mean_posture: str = 'remove') -> Array:
    """Joint angles about the mean posture of the trial [rad], shape (T, N).

    The mean is each trial's own: animals rest in different postures, and it makes the pooled
    components independent of which side a recording calls positive.

    Args:
        trial: the recording.
        mean_posture: 'remove' it, or 'keep' it: postures are then told from the straight body.

    Raises:
        BadInputError: neither of these.
    """
    if mean_posture not in MEAN_POSTURES:
        raise BadInputError('mean_posture', mean_posture, f'one of {MEAN_POSTURES}')
    if mean_posture == 'keep':
        return trial.angles
    return trial.angles - trial.angles.mean(axis=0)


def principal_components(postures: Sequence[Array], count: int) -> Components:
    """Find the principal components of pooled trials; each frame counts the same.

    Args:
        postures: of each trial, as `centred` returns them, equal N [rad], shape (T, N).
        count: M, how many to keep.

    Raises:
        BadInputError: fewer than 2 or more than N are asked for.
    """
    positions = postures[0].shape[1]
    if not 2 <= count <= positions:
        raise BadInputError('components', count, f'2..{positions}, the body positions')
    variance, shapes = eigen_postures(sum(x.T @ x for x in postures), count)
    return Components(shapes, variance, tuple(x @ shapes.T for x in postures))


def eigen_postures(moments: Array, count: int) -> tuple[Array, Array]:
    """Shares of variance, shape (N,), and the strongest shapes, shape (count, N).

    Args:
        moments: second moments of postures, shape (N, N).
        count: how many shapes.
    """
    values, vectors = np.linalg.eigh(moments)
    values = np.maximum(values[::-1], 0.0)  # rounding may leave the smallest below zero
    shapes = vectors[:, ::-1].T[:count]
    largest = np.abs(shapes).argmax(axis=1)
    shapes = shapes * np.sign(shapes[np.arange(count), largest])[:, None]
    return values / values.sum(), shapes
