"""A kymograph: how a body bends over time, checked and told in joint angles.

Conventions: rows are frames, columns body positions from head to tail, numbered i = 1..N as in
eq:template. Each position stands for 1/N of the body, so a joint angle is theta_i = kappa_i L / N
for a curvature kappa_i of a body of length L, and a spatial frequency counts waves over N
positions. The sign is the recording's: + is whichever side it calls +.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]

KINDS = ('angle', 'curvature', 'tangent')
FEWEST_FRAMES = 16
FEWEST_POSITIONS = 6  # two waves are four numbers per frame; something must be left over
MOST_TRANSPOSED = 200  # more positions than that, and more than frames: the table lies on its side


@dataclass(frozen=True, slots=True)
class Reading:
    """How to read a recording.

    Attributes:
        fps: frames per second.
        kind: 'angle' between body segments, 'curvature', or 'tangent' angle of the segments
            themselves (their differences are the joint angles).
        degrees: angles are in degrees; in radians if not.
        worm_length: body length in the unit whose inverse the curvature has; 1 if that is BL^-1.
        tail_first: the first column is the tail.
        max_gap: longest gap filled by interpolation in time [s].
    """

    fps: float
    kind: str = 'angle'
    degrees: bool = False
    worm_length: float = 1.0
    tail_first: bool = False
    max_gap: float = 0.25

    def __post_init__(self) -> None:
        """Refuse what no recording can have."""
        if not math.isfinite(self.fps) or self.fps <= 0.0:
            raise BadInputError('fps', self.fps, 'a finite number > 0 [1/s]')
        if self.kind not in KINDS:
            raise BadInputError('kind', self.kind, f'one of {KINDS}')
        if not math.isfinite(self.worm_length) or self.worm_length <= 0.0:
            raise BadInputError('worm_length', self.worm_length, 'a finite length > 0')
        if self.worm_length != 1.0 and self.kind != 'curvature':
            raise BadInputError('worm_length', self.worm_length, '1: only curvature has units')
        if self.degrees and self.kind == 'curvature':
            raise BadInputError('degrees', self.degrees, 'angles, not curvature')
        if not math.isfinite(self.max_gap) or self.max_gap < 0.0:
            raise BadInputError('max_gap', self.max_gap, 'a finite time >= 0 [s]')


@dataclass(frozen=True, slots=True)
class Kymograph:
    """One trial; every value is finite.

    Attributes:
        name: of the recording.
        angles: joint angles, head to tail [rad], shape (T, N).
        fps: frames per second.
        first: number of its first frame in the recording, counted from 0.
        filled: numbers of the frames that were interpolated, in the recording.
    """

    name: str
    angles: Array
    fps: float
    first: int = 0
    filled: tuple[int, ...] = ()

    @property
    def n_frames(self) -> int:
        """T."""
        return self.angles.shape[0]

    @property
    def n_positions(self) -> int:
        """N."""
        return self.angles.shape[1]

    @property
    def time(self) -> Array:
        """Time of each frame since the start of the recording [s], shape (T,)."""
        return (self.first + np.arange(self.n_frames)) / self.fps

    @property
    def curvature(self) -> Array:
        """Curvature [BL^-1], shape (T, N)."""
        return self.angles * self.n_positions

    def cut(self, start: int, stop: int) -> Kymograph:
        """Return frames `start` to `stop` - 1, numbered as in the recording."""
        rows = slice(start - self.first, stop - self.first)
        filled = tuple(k for k in self.filled if start <= k < stop)
        return Kymograph(self.name, self.angles[rows], self.fps, start, filled)

    def resampled(self, positions: int) -> Kymograph:
        """Return the same curvature at another number of body positions, linear in between."""
        if positions == self.n_positions:
            return self
        old = (np.arange(self.n_positions) + 0.5) / self.n_positions
        new = (np.arange(positions) + 0.5) / positions
        rows = [np.interp(new, old, row) for row in self.curvature]
        angles = np.array(rows) / positions
        return Kymograph(self.name, angles, self.fps, self.first, self.filled)


def make_kymograph(
    name: str, table: ArrayLike, reading: Reading, start: int = 0, stop: int | None = None
) -> Kymograph:
    """Check a table and turn it into joint angles.

    Frames with missing values (NaN) are interpolated in time, position by position, where a gap
    is no longer than `reading.max_gap`.

    Args:
        name: of the recording, for messages.
        table: shape (T, columns), see `Reading`.
        reading: what the numbers are.
        start: first frame to use, counted from 0; what lies before is not even checked.
        stop: the frame after the last one to use; None for all.

    Raises:
        BadInputError: too few frames or positions, an infinite value, a gap that is too long or
            at either end (each named by frame), or a body that never moves.
    """
    values = np.asarray(table, float)
    last = values.shape[0] if stop is None else stop
    if not 0 <= start < last <= values.shape[0]:
        expected = f'0 <= from < to <= {values.shape[0]}, the frames of {name}'
        raise BadInputError('frames', (start, last), expected)
    values = values[start:last]
    _check_size(name, values, reading)
    infinite = np.argwhere(np.isinf(values))
    if infinite.size:
        row, column = infinite[0]
        field = f'{name} frame {start + row}, position {column + 1}'
        raise BadInputError(field, values[row, column], 'finite numbers, NaN where missing')
    angles = _joint_angles(values, reading)
    angles, filled = _fill(name, angles, start, int(reading.max_gap * reading.fps + 1e-9))
    if not np.ptp(angles, axis=0).max() > 1e-9:
        raise BadInputError(name, 'the same posture in all frames', 'a body that moves')
    return Kymograph(name, angles, reading.fps, start, filled)


def _check_size(name: str, values: Array, reading: Reading) -> None:
    frames, columns = values.shape
    positions = columns - (reading.kind == 'tangent')
    if columns > max(frames, MOST_TRANSPOSED):
        expected = 'frames down and positions across (turn it round with --transposed)'
        raise BadInputError(name, f'{frames} rows x {columns} columns', expected)
    if frames < FEWEST_FRAMES:
        raise BadInputError(name, f'{frames} frames', f'at least {FEWEST_FRAMES}')
    if positions < FEWEST_POSITIONS:
        raise BadInputError(name, f'{positions} body positions', f'at least {FEWEST_POSITIONS}')
    steps = np.diff(values[:, 0])
    if np.all(steps > 0.0) and np.ptp(steps) < 1e-3 * steps.mean():
        expected = 'body positions only (leave out a time or frame column with --skip-columns 1)'
        raise BadInputError(f'{name} column 1', 'evenly rising numbers', expected)


def _joint_angles(values: Array, reading: Reading) -> Array:
    """Joint angles, head first [rad]."""
    angles = np.radians(values) if reading.degrees else values
    if reading.kind == 'tangent':
        step = np.diff(angles, axis=1)
        angles = (step + np.pi) % (2.0 * np.pi) - np.pi
    elif reading.kind == 'curvature':
        angles = angles * reading.worm_length / values.shape[1]
    return angles[:, ::-1] if reading.tail_first else angles


def _fill(name: str, angles: Array, start: int, most: int) -> tuple[Array, tuple[int, ...]]:
    """Interpolate short gaps; return the angles and the numbers of the frames."""
    missing = np.isnan(angles).any(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], missing, [False]])))
    for begin, end in zip(edges[::2], edges[1::2]):
        if begin == 0 or end == missing.size:
            expected = 'values in the first and the last frame (cut with --from and --to)'
            raise BadInputError(f'{name} frame {start + begin}', 'no values', expected)
        if end - begin > most:
            expected = f'gaps of at most {most} frames (cut with --from and --to; see --max-gap)'
            raise BadInputError(
                f'{name} frame {start + begin}', f'{end - begin} frames without values', expected
            )
    filled = angles.copy()
    frames = np.arange(missing.size)
    for column in filled.T:
        gaps = np.isnan(column)
        if gaps.any():
            column[gaps] = np.interp(frames[gaps], frames[~gaps], column[~gaps])
    return filled, tuple(int(k) + start for k in np.flatnonzero(missing))
