"""PyBullet without the line that it prints when it is imported."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

NOISE = b'pybullet build time:'


@contextmanager
def _without_noise() -> Iterator[None]:
    """Hold back what C code writes to stderr, then let all but the noise through."""
    number = 2  # where C writes, whatever sys.stderr is
    sys.stderr.flush()
    with tempfile.TemporaryFile() as held:
        kept = os.dup(number)
        os.dup2(held.fileno(), number)
        try:
            yield
        finally:
            os.dup2(kept, number)
            os.close(kept)
            held.seek(0)
            for line in held:
                if not line.startswith(NOISE):
                    os.write(number, line)


with _without_noise():
    import pybullet

__all__ = ['pybullet']
