"""What `omega_turn worm` is told."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from omega_turn_ros.worm.kymograph import Reading


@dataclass(frozen=True, slots=True)
class WormOptions:
    """What `omega_turn worm` is told.

    Attributes:
        files: one recording each.
        reading: what their numbers are.
        out: folder for the files.
        starts: first frame of each recording, or one for all.
        stops: the frame after the last of each, or one for all; none: to the end.
        transposed: the tables have positions down and frames across.
        skip_columns: leading columns that are no body positions.
        variable: of .mat files.
        turns_only: analyse the turns found, not all frames.
        bend: see `find_turns` [rad].
        components: how many to keep.
        mean_posture: 'remove' or 'keep'.
        to_gait: make a gait too.
        robot: whose gait it is.
        gait_name: its name.
        harmonics: of its series.
        pybullet: play it in PyBullet too.
        seed: of the resampling and of the search.
    """

    files: tuple[Path, ...]
    reading: Reading
    out: Path = Path('out')
    starts: tuple[int, ...] = ()
    stops: tuple[int, ...] = ()
    transposed: bool = False
    skip_columns: int = 0
    variable: str = ''
    turns_only: bool = False
    bend: float = math.pi
    components: int = 4
    mean_posture: str = 'remove'
    to_gait: bool = False
    robot: str = 'limbless16'
    gait_name: str = 'worm'
    harmonics: int = 1
    pybullet: bool = True
    seed: int = 0
