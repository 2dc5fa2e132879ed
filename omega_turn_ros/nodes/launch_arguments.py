"""Arguments of the launch file: text in, checked values out. Knows nothing of ROS.

All are checked before the first node starts: launch does not take back what it has started.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.names import check_namespace
from omega_turn_ros.resources import config_root

OWN_DOMAIN = '73'
LARGEST_DOMAIN = 232  # beyond, DDS has no ports
LARGEST_TURN_DEG = 1e6
LARGEST_FACTOR = 1000.0  # as in the bridge
FEEDBACK = ('none', 'odom')
LOG_LEVELS = ('debug', 'info', 'warn', 'error', 'fatal')
BOOLEANS = {
    **dict.fromkeys(('true', 'on', 'yes', '1'), True),
    **dict.fromkeys(('false', 'off', 'no', '0'), False),
}


@dataclass(frozen=True, slots=True)
class LaunchArgument:
    """One argument.

    Attributes:
        name: as in `name:=value`.
        default: text taken when it is not given.
        description: one sentence for `--show-args`.
        read: called with name and text; returns the value or raises BadInputError.
    """

    name: str
    default: str
    description: str
    read: Callable[[str, str], Any]


@dataclass(frozen=True, slots=True)
class LaunchSettings:
    """What to start, from checked arguments.

    Attributes:
        namespace: without outer slashes, '' for none.
        turn_deg: first turn [deg]; 0.0 for none.
        use_sim: start the bridge.
        admittance: start the admittance node.
        params_file: ROS parameters of all nodes.
        domain_id: DDS domain.
        log_level: of all nodes.
        parameters: node -> values that go before those of `params_file`.
    """

    namespace: str
    turn_deg: float
    use_sim: bool
    admittance: bool
    params_file: Path
    domain_id: int
    log_level: str
    parameters: Mapping[str, Mapping[str, Any]]


def launch_arguments(environment: Mapping[str, str]) -> tuple[LaunchArgument, ...]:
    """All arguments; ROS_DOMAIN_ID of the environment is the default of `domain_id`."""
    given = '(default: as in params_file)'
    onoff = 'on or off'
    domain = environment.get('ROS_DOMAIN_ID') or OWN_DOMAIN
    params_file = str(config_root() / 'omega_turn.yaml')
    return (
        LaunchArgument(
            'namespace',
            '',
            'Namespace of all nodes and topics; two robots share a graph this way.',
            _namespace,
        ),
        LaunchArgument(
            'turn_deg',
            '0.0',
            'Turn commanded once everything runs [deg]; 0 waits for turn_angle.',
            _turn,
        ),
        LaunchArgument(
            'use_sim',
            'true',
            f'{onoff}: PyBullet stands in for the robot, or your hardware driver.',
            _boolean,
        ),
        LaunchArgument('gui', '', f"{onoff}: show PyBullet's window {given}.", _or_none(_boolean)),
        LaunchArgument(
            'real_time_factor',
            '',
            f'Speed of the simulation; 0 is as fast as it can {given}.',
            _or_none(_factor),
        ),
        LaunchArgument(
            'compliance',
            '',
            f'{onoff}: the amplitudes yield; off leaves the admittance node out {given}.',
            _or_none(_boolean),
        ),
        LaunchArgument(
            'heading_feedback',
            '',
            f'odom: re-plan after each cycle; none: trust the prediction {given}.',
            _or_none(_one_of(FEEDBACK)),
        ),
        LaunchArgument(
            'log_level', 'info', f'One of {", ".join(LOG_LEVELS)}.', _one_of(LOG_LEVELS)
        ),
        LaunchArgument('params_file', params_file, 'ROS parameters of all nodes.', _params_file),
        LaunchArgument(
            'use_sim_time',
            '',
            f'{onoff}: nodes follow /clock (default: on with use_sim, else as in params_file).',
            _or_none(_boolean),
        ),
        LaunchArgument(
            'domain_id',
            domain,
            'DDS domain: ROS_DOMAIN_ID where set, else one of our own.',
            _domain,
        ),
    )


def read_arguments(
    arguments: tuple[LaunchArgument, ...], given: Mapping[str, str]
) -> LaunchSettings:
    """Check every argument and say what they ask for.

    Args:
        arguments: from `launch_arguments`.
        given: name -> text; absent names take their default.

    Raises:
        BadInputError: the first that is refused, by its name.
    """
    value = {a.name: a.read(a.name, given.get(a.name, a.default).strip()) for a in arguments}
    follow_clock = value['use_sim_time']
    if follow_clock is None and value['use_sim']:
        follow_clock = True
    clock = _those_given(use_sim_time=follow_clock)
    gait = _those_given(
        heading_feedback=value['heading_feedback'], use_compliance=value['compliance']
    )
    bridge = _those_given(gui=value['gui'], real_time_factor=value['real_time_factor'])
    return LaunchSettings(
        namespace=value['namespace'],
        turn_deg=value['turn_deg'],
        use_sim=value['use_sim'],
        admittance=value['compliance'] is not False,
        params_file=value['params_file'],
        domain_id=value['domain_id'],
        log_level=value['log_level'],
        parameters={
            'gait_node': {**clock, **gait},
            'admittance_node': clock,
            'pybullet_bridge': bridge,
        },
    )


def _those_given(**values: Any) -> dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}


def _or_none(read: Callable[[str, str], Any]) -> Callable[[str, str], Any]:
    return lambda name, text: read(name, text) if text else None


def _one_of(choices: tuple[str, ...]) -> Callable[[str, str], str]:
    def read(name: str, text: str) -> str:
        if text.lower() not in choices:
            raise BadInputError(name, text, f'one of {", ".join(choices)}')
        return text.lower()

    return read


def _namespace(name: str, text: str) -> str:
    return check_namespace(text)


def _boolean(name: str, text: str) -> bool:
    if text.lower() not in BOOLEANS:
        raise BadInputError(name, text, 'on or off, true or false, yes or no, 1 or 0')
    return BOOLEANS[text.lower()]


def _number(name: str, text: str, low: float, high: float, expected: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high:  # also catches NaN
        raise BadInputError(name, text, expected)
    return value


def _turn(name: str, text: str) -> float:
    expected = f'a number within +-{LARGEST_TURN_DEG:g} [deg]'
    return _number(name, text, -LARGEST_TURN_DEG, LARGEST_TURN_DEG, expected)


def _factor(name: str, text: str) -> float:
    return _number(name, text, 0.0, LARGEST_FACTOR, f'a number in [0, {LARGEST_FACTOR:g}]')


def _domain(name: str, text: str) -> int:
    if not (text.isascii() and text.isdecimal()) or int(text) > LARGEST_DOMAIN:
        raise BadInputError(name, text, f'an integer in [0, {LARGEST_DOMAIN}]')
    return int(text)


def _params_file(name: str, text: str) -> Path:
    path = Path(text).expanduser()
    if not path.is_file():
        raise BadInputError(name, text, 'a file of ROS parameters')
    try:
        data = yaml.safe_load(path.read_text(encoding='utf-8'))
    except (OSError, yaml.YAMLError, UnicodeDecodeError) as error:
        why = ' '.join(str(error).split())
        raise BadInputError(name, text, f'valid YAML ({why})') from error
    if not _holds_parameters(data):
        raise BadInputError(name, text, 'ROS parameters: node names with ros__parameters below')
    return path


def _holds_parameters(data: object) -> bool:
    """Whether every branch of a parameter file ends in a mapping `ros__parameters`."""
    if not isinstance(data, dict) or not data:
        return False
    if 'ros__parameters' in data:
        return isinstance(data['ros__parameters'], dict)
    return all(_holds_parameters(below) for below in data.values())
