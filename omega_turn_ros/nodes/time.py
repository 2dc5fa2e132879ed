"""Small conversions between ROS time and seconds."""

from __future__ import annotations

from builtin_interfaces.msg import Time


def nanoseconds_of(stamp: Time) -> int:
    """Nanoseconds of a message stamp."""
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def stamp_of(nanoseconds: int) -> Time:
    """Message stamp of a time in nanoseconds."""
    return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


class StepTimer:
    """Time steps between stamps, clamped so that no clock jump reaches an integrator.

    A backward jump gives 0, a forward jump at most `longest`.

    Args:
        longest: largest step [s].
        first: step reported for the first stamp [s].
    """

    def __init__(self, longest: float, first: float = 0.0) -> None:
        self._longest, self._first = longest, first
        self._last: int | None = None
        self.jumps = 0

    def step(self, nanoseconds: int) -> float:
        """Return the clamped time since the last stamp [s]."""
        last, self._last = self._last, nanoseconds
        if last is None:
            return self._first
        dt = (nanoseconds - last) * 1e-9
        if dt < 0.0 or dt > max(1.0, 10.0 * self._longest):
            self.jumps += 1
        return min(max(dt, 0.0), self._longest)
