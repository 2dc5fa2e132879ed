"""How far a turn is: a bar on a terminal, a line every few seconds elsewhere."""

from __future__ import annotations

import sys
import time

from tqdm import tqdm

LINE_EVERY = 5.0  # [s]; a log keeps no bar, it may not even show it before its end
BAR = '{desc} {percentage:3.0f}%|{bar}| {n:.1f}/{total:.1f} deg [{elapsed}]'


class TurnProgress:
    """Writes to stderr.

    Args:
        total: size of the turn [deg].
    """

    def __init__(self, total: float) -> None:
        self._total = total
        self._shown = time.monotonic()
        on_terminal = sys.stderr.isatty()
        self._bar = tqdm(
            total=total, desc='turning', bar_format=BAR, mininterval=0.2, disable=not on_terminal
        )

    def show(self, left: float, jammed: bool) -> None:
        """Show that so much is left [deg], and whether the robot gets nowhere."""
        what = 'jammed' if jammed else 'turning'
        done = min(max(self._total - left, 0.0), self._total)
        if not self._bar.disable:
            self._bar.n = done
            self._bar.set_description(what, refresh=False)
            self._bar.update(0)
        elif time.monotonic() - self._shown >= LINE_EVERY:
            self._shown = time.monotonic()
            text = f'{what} {100.0 * done / self._total:3.0f}%'
            print(f'{text}, {done:.1f}/{self._total:.1f} deg', file=sys.stderr, flush=True)

    def close(self) -> None:
        """Leave the bar as it is."""
        self._bar.close()
