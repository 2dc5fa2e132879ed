"""The command line. Heavy imports wait until a command needs them."""

from __future__ import annotations

import argparse
import math
import re
import signal
import sys
from pathlib import Path

from omega_turn_lab.studies import NAMES as STUDIES
from omega_turn_lab.worm.arguments import add_worm
from omega_turn_ros import __version__
from omega_turn_ros.errors import BadInputError, OmegaTurnError

INTERRUPTED = 130  # exit code
LARGEST_SEED = 4_000_000  # searches take a thousand seeds each, 32 bits in all


def main(arguments: list[str] | None = None) -> int:
    """Run `omega_turn`; return the exit code: 0 done, 1 failed, 2 bad input, 130 interrupted."""
    options = _parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends as Ctrl-C does
    try:
        code = int(options.run(options))
    except KeyboardInterrupt:
        print('interrupted', file=sys.stderr)
        code = INTERRUPTED
    except OmegaTurnError as error:
        print(f'error: {error}', file=sys.stderr)
        code = 2 if isinstance(error, ValueError) else 1
    if code == INTERRUPTED:
        # Terminals and launch may signal twice; the second must not break into the exit.
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='omega_turn', description='Omega turns for limbless robots.'
    )
    parser.add_argument('--version', action='version', version=__version__)
    commands = parser.add_subparsers(required=True, metavar='COMMAND')
    _add_demo(commands.add_parser('demo', help='turn a simulated robot, all nodes in one process'))
    _add_turn(commands.add_parser('turn', help='command nodes that already run'))
    _add_design(commands.add_parser('design', help='design gaits for a robot'))
    _add_reproduce(commands.add_parser('reproduce', help="redo the paper's tables and figures"))
    add_worm(commands.add_parser('worm', help='waves and gaits from recordings of worms'))
    return parser


def _add_demo(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--turn-deg', type=_angle, default=90.0, help='+ = counter-clockwise')
    parser.add_argument('--out', type=Path, default=Path('out'), help='folder for the files')
    parser.add_argument(
        '--gait', default='', help="name in config/gaits, or a path; default: the robot's"
    )
    parser.add_argument('--robot', default='limbless16', help='name in config/robots, or a path')
    parser.add_argument('--period', type=float, default=10.0, help='of a gait cycle [s]')
    parser.add_argument('--heading-feedback', choices=('odom', 'none'), default='odom')
    parser.add_argument('--compliance', choices=('on', 'off'), default='on')
    parser.add_argument('--friction', type=float, default=0.5, help='of the ground')
    parser.add_argument('--terrain', default='flat', help='name in config/terrains, or a path')
    parser.add_argument(
        '--spacing', type=float, default=None, help="between pegs [BL]; default: the terrain's"
    )
    parser.add_argument('--seed', type=int, default=0)
    parser.add_argument('--gui', action='store_true', help="show PyBullet's window")
    parser.set_defaults(run=_run_demo)


def _add_turn(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--deg', type=_angle, required=True, help='+ = counter-clockwise')
    parser.add_argument('--namespace', default='', help='of the gait node')
    parser.add_argument(
        '--domain-id', type=_domain, default=None, help='default: ROS_DOMAIN_ID or 0'
    )
    parser.add_argument('--timeout', type=_seconds, default=10.0, help='for the gait node [s]')
    parser.add_argument(
        '--ros-args', nargs=argparse.REMAINDER, default=[], help='as of any node; goes last'
    )
    parser.set_defaults(run=_run_turn)


def _add_design(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--robot', default='limbless16', help='name in config/robots, or a path')
    parser.add_argument('--all', action='store_true', help='design the whole library')
    parser.add_argument('--k-f', type=float, help='waves of the forward wave, default 1.5')
    parser.add_argument('--k-t', type=float, help='waves of the turning wave, default 1')
    parser.add_argument(
        '--theta-max-deg',
        type=_angle,
        default=None,
        help="joint limit [deg]; default: 90, or the robot's own if that is less",
    )
    parser.add_argument(
        '--method',
        help='direct (turn per cycle, the default), speed (turn per second), hierarchical (the '
        "paper's way), fourier_1 or fourier_2 (richer)",
    )
    parser.add_argument('--name', help='of the gait file; made of the rest if absent')
    parser.add_argument('--seed', type=_seed, default=0)
    parser.add_argument('--out', type=Path, default=Path('gaits'), help='folder to write')
    parser.set_defaults(run=_run_design)


def _add_reproduce(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'name', choices=(*STUDIES, 'all'), metavar='NAME', help=f'{", ".join(STUDIES)} or all'
    )
    parser.add_argument('--out', type=Path, default=Path('out'), help='folder for the files')
    parser.add_argument('--seed', type=_seed, default=0, help='of every search')
    parser.add_argument('--jobs', type=int, default=-1, help='processes; -1: one per core')
    parser.add_argument('--dask', metavar='ADDRESS', help='use the workers of this scheduler')
    parser.add_argument(
        '--pybullet',
        action=argparse.BooleanOptionalAction,
        default=True,
        help='play the gaits in PyBullet too',
    )
    parser.add_argument('--fresh', action='store_true', help='compute finished cases again')
    parser.set_defaults(run=_run_reproduce)


def _angle(text: str) -> float:
    value = _number(text, 'a number [deg]')
    if abs(value) >= 1e6:
        raise argparse.ArgumentTypeError(f'{text}: expected less than 1e6 deg')
    return value


def _seconds(text: str) -> float:
    expected = 'a time > 0 [s]'
    value = _number(text, expected)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f'{text}: expected {expected}')
    return value


def _number(text: str, expected: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isnan(value):
        raise argparse.ArgumentTypeError(f'{text}: expected {expected}')
    return value


def _seed(text: str) -> int:
    if not text.isdecimal() or int(text) > LARGEST_SEED:
        raise argparse.ArgumentTypeError(f'{text}: expected an integer in 0..{LARGEST_SEED}')
    return int(text)


def _domain(text: str) -> int:
    if not text.isdecimal() or int(text) > 232:
        raise argparse.ArgumentTypeError(f'{text}: expected 0..232')
    return int(text)


def _run_demo(options: argparse.Namespace) -> int:
    from omega_turn_lab.demo import DemoOptions, run_demo
    from omega_turn_ros.gaits.library import default_gait
    from omega_turn_ros.robot import load_robot

    return run_demo(
        DemoOptions(
            turn_deg=options.turn_deg,
            out=options.out,
            gait=options.gait or default_gait(load_robot(options.robot)),
            robot=options.robot,
            period=options.period,
            heading_feedback=options.heading_feedback,
            compliance=options.compliance == 'on',
            friction=options.friction,
            terrain=options.terrain,
            spacing=options.spacing,
            seed=options.seed,
            gui=options.gui,
        )
    )


def _run_turn(options: argparse.Namespace) -> int:
    from omega_turn_lab.turn import run_turn

    return run_turn(
        options.deg, options.namespace, options.domain_id, options.timeout, options.ros_args
    )


def _run_design(options: argparse.Namespace) -> int:
    from omega_turn_lab.design import run_design
    from omega_turn_ros.design.catalogue import Recipe, recipes_for
    from omega_turn_ros.robot import load_robot

    robot = load_robot(options.robot)
    if options.all:
        for option in ('k_f', 'k_t', 'theta_max_deg', 'method', 'name'):
            given = getattr(options, option)
            if given is not None:
                flag = '--' + option.replace('_', '-')
                raise BadInputError(flag, given, 'no such option beside --all')
        return run_design(robot, recipes_for(robot), options.seed, options.out)
    k_f = 1.5 if options.k_f is None else options.k_f
    k_t = 1.0 if options.k_t is None else options.k_t
    limit = options.theta_max_deg
    if limit is None:
        limit = min(90.0, math.degrees(robot.position_limit))
    method = options.method or 'direct'
    name = options.name or f'k{k_f:g}_{k_t:g}_{limit:g}deg_{method}'.replace('.', 'p')
    if not re.fullmatch(r'[A-Za-z0-9_-]+', name):
        raise BadInputError('--name', name, 'letters, digits, _ and -')
    text = f'k_f = {k_f:g}, k_t = {k_t:g}, joint limit {limit:g} deg, {method}'
    recipe = Recipe(name, text, k_f, k_t, limit, method)
    return run_design(robot, (recipe,), options.seed, options.out)


def _run_reproduce(options: argparse.Namespace) -> int:
    from omega_turn_lab.studies.run import ReproduceOptions, run_reproduce

    return run_reproduce(
        ReproduceOptions(
            name=options.name,
            out=options.out,
            seed=options.seed,
            jobs=options.jobs,
            dask=options.dask,
            pybullet=options.pybullet,
            fresh=options.fresh,
        )
    )


if __name__ == '__main__':
    sys.exit(main())
