"""The folder a command writes to."""

from __future__ import annotations

import os
from pathlib import Path

from omega_turn_ros.errors import BadInputError


def make_folder(path: Path) -> None:
    """Make a folder where there is none yet.

    Raises:
        BadInputError: that is not possible, or nothing can be written there.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInputError('out', str(path), f'a folder to write to ({error})') from error
    if not os.access(path, os.W_OK):
        raise BadInputError('out', str(path), 'a folder to write to')
