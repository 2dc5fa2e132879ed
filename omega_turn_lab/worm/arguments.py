"""The arguments of `omega_turn worm`. Heavy imports wait until it runs."""

from __future__ import annotations

import argparse
import math
from pathlib import Path


def add_worm(parser: argparse.ArgumentParser) -> None:
    """Add them to a parser and let it run the command."""
    parser.add_argument('files', type=Path, nargs='+', metavar='FILE', help='.npy, .csv or .mat')
    _add_reading(parser)
    parser.add_argument('--find-turns', action='store_true', help='analyse only the turns found')
    parser.add_argument(
        '--bend-deg', type=float, default=180.0, help='a turn bends the body at least so far'
    )
    parser.add_argument('--components', type=int, default=4, help='to keep, 2..12')
    parser.add_argument(
        '--mean-posture',
        choices=('remove', 'keep'),
        default='remove',
        help='components about the mean posture of each recording, or about the straight body',
    )
    parser.add_argument('--to-gait', action='store_true', help='make a gait for a robot too')
    parser.add_argument('--robot', default='limbless16', help='name in config/robots, or a path')
    parser.add_argument('--gait-name', default='worm', help='of the gait file')
    parser.add_argument('--harmonics', type=int, default=1, help='of the series of the gait')
    parser.add_argument(
        '--pybullet',
        action=argparse.BooleanOptionalAction,
        default=True,
        help='play the gait in PyBullet too',
    )
    parser.add_argument('--seed', type=int, default=0)
    parser.add_argument('--out', type=Path, default=Path('out'), help='folder for the files')
    parser.set_defaults(run=_run)


def _add_reading(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--fps', type=float, required=True, help='frames per second')
    parser.add_argument(
        '--kind',
        choices=('angle', 'curvature', 'tangent'),
        default='angle',
        help='joint angles [rad], curvature, or tangent angles of the segments [rad]',
    )
    parser.add_argument('--degrees', action='store_true', help='angles are in degrees')
    parser.add_argument(
        '--worm-length',
        type=float,
        default=1.0,
        help='in the unit whose inverse the curvature has; 1: curvature is in BL^-1',
    )
    parser.add_argument('--tail-first', action='store_true', help='the first column is the tail')
    parser.add_argument(
        '--transposed', action='store_true', help='positions down and frames across'
    )
    parser.add_argument(
        '--skip-columns', type=int, default=0, help='leading columns, such as the time'
    )
    parser.add_argument('--variable', default='', help='of .mat files with several tables')
    parser.add_argument(
        '--max-gap', type=float, default=0.25, help='longest gap to interpolate over [s]'
    )
    parser.add_argument(
        '--from',
        type=int,
        action='append',
        default=[],
        dest='starts',
        metavar='FRAME',
        help='first frame, from 0; once for all files or once for each',
    )
    parser.add_argument(
        '--to',
        type=int,
        action='append',
        default=[],
        dest='stops',
        metavar='FRAME',
        help='the frame after the last; likewise',
    )


def _run(options: argparse.Namespace) -> int:
    from omega_turn_lab.worm.command import run_worm
    from omega_turn_lab.worm.options import WormOptions
    from omega_turn_ros.worm.kymograph import Reading

    reading = Reading(
        fps=options.fps,
        kind=options.kind,
        degrees=options.degrees,
        worm_length=options.worm_length,
        tail_first=options.tail_first,
        max_gap=options.max_gap,
    )
    return run_worm(
        WormOptions(
            files=tuple(options.files),
            reading=reading,
            out=options.out,
            starts=tuple(options.starts),
            stops=tuple(options.stops),
            transposed=options.transposed,
            skip_columns=options.skip_columns,
            variable=options.variable,
            turns_only=options.find_turns,
            bend=math.radians(options.bend_deg),
            components=options.components,
            mean_posture=options.mean_posture,
            to_gait=options.to_gait,
            robot=options.robot,
            gait_name=options.gait_name,
            harmonics=options.harmonics,
            pybullet=options.pybullet,
            seed=options.seed,
        )
    )
