"""Straight moves through joint space with a minimum-jerk time law."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PEAK_SPEED = 1.875  # of the minimum-jerk law, relative to its mean speed
SHORTEST = 0.1  # [s]


@dataclass(frozen=True, slots=True)
class Move:
    """A move under way.

    Attributes:
        start: [rad], shape (n_joints,).
        end: [rad], shape (n_joints,).
        duration: [s].
        heading_change: predicted turn of the mean body axis over the whole move [rad].
        elapsed: [s].
        waypoint: angles where the robot halts on the way [rad], shape (n_joints,); None: straight.
        waypoint_time: when it is there [s].
    """

    start: Array
    end: Array
    duration: float
    heading_change: float
    elapsed: float = 0.0
    waypoint: Array | None = None
    waypoint_time: float = 0.0

    @property
    def done(self) -> bool:
        """Whether the end has been reached."""
        return self.elapsed >= self.duration

    @property
    def fraction(self) -> float:
        """Share of the way covered, 0..1: 10 s^3 - 15 s^4 + 6 s^5."""
        return _minimum_jerk(min(self.elapsed / self.duration, 1.0))

    @property
    def position(self) -> Array:
        """Joint angles now [rad], shape (n_joints,)."""
        if self.done:
            return self.end
        if self.waypoint is None:
            result: Array = self.start + self.fraction * (self.end - self.start)
        elif self.elapsed < self.waypoint_time:
            share = _minimum_jerk(self.elapsed / self.waypoint_time)
            result = self.start + share * (self.waypoint - self.start)
        else:
            left = (self.elapsed - self.waypoint_time) / (self.duration - self.waypoint_time)
            result = self.waypoint + _minimum_jerk(left) * (self.end - self.waypoint)
        return result

    def advanced(self, dt: float) -> tuple[Move, float]:
        """Return the move dt [s] later and the heading change predicted meanwhile [rad]."""
        later = replace(self, elapsed=min(self.elapsed + dt, self.duration))
        return later, self.heading_change * (later.fraction - self.fraction)


def move_through(
    start: Array, waypoint: Array, end: Array, velocity: float, heading_change: float
) -> Move:
    """Plan two moves one after the other; the robot halts at the waypoint."""
    first, second = (
        move_between(a, b, velocity, 0.0) for a, b in ((start, waypoint), (waypoint, end))
    )
    duration = first.duration + second.duration
    return Move(start, end, duration, heading_change, 0.0, waypoint, first.duration)


def _minimum_jerk(s: float) -> float:
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s)


def move_between(start: Array, end: Array, velocity: float, heading_change: float) -> Move:
    """Plan a move whose fastest joint peaks at `velocity` [rad/s]."""
    distance = float(np.abs(end - start).max())
    return Move(start, end, max(PEAK_SPEED * distance / velocity, SHORTEST), heading_change)
