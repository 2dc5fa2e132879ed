"""The gait library: named gaits with their calibration, one YAML file each in config/gaits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.calibration import Calibration, calibration_from_mapping
from omega_turn_ros.gaits.fourier_gait import FourierGait
from omega_turn_ros.gaits.gait import Gait
from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.gaits.sidewinding import Sidewinding
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.resources import config_names, fields_apart, read_config
from omega_turn_ros.robot import LeggedRobot, Robot

KINDS: dict[str, type[TwoWaveGait] | type[FourierGait] | type[Sidewinding] | type[LeggedGait]] = {
    'two_wave': TwoWaveGait,
    'fourier': FourierGait,
    'sidewinding': Sidewinding,
    'legged': LeggedGait,
}


@dataclass(frozen=True, slots=True)
class LibraryGait:
    """A gait that can be planned with.

    Attributes:
        name: file stem in config/gaits.
        description: one line for people.
        robot: name of the robot it is calibrated for.
        theta_max: largest joint angle over the cycle at scale 1 [rad].
        gait: what is played. Scale +1 turns counter-clockwise.
        calibration: angle over scale and phase.
        advance: way forward per cycle at scale 0 [m]; 0 of a gait that only turns.
    """

    name: str
    description: str
    robot: str
    theta_max: float
    gait: Gait
    calibration: Calibration
    advance: float = 0.0

    @property
    def waves(self) -> WaveGait:
        """The gait as two waves, which can yield.

        Raises:
            BadInputError: it is of another kind.
        """
        if not isinstance(self.gait, WaveGait):
            raise BadInputError('gait', self.name, 'a gait of two waves, whose amplitudes yield')
        return self.gait


def gait_names() -> list[str]:
    """Names of the shipped gaits."""
    return config_names('gaits')


def default_gait(robot: Robot) -> str:
    """Name of the shipped gait that a robot turns with unless told otherwise."""
    return 'legged' if isinstance(robot, LeggedRobot) else 'omega'


def load_gait(name: str) -> LibraryGait:
    """Read a gait from `config/gaits/<name>.yaml` or from a path ending in `.yaml`.

    Raises:
        BadInputError: the file is missing, or a field is missing, unknown or out of range.
    """
    data = read_config('gaits', name)
    expected = {'name', 'description', 'kind', 'robot', 'theta_max', 'parameters', 'calibration'}
    if set(data) - {'advance'} != expected:
        raise BadInputError('gait', name, f'a gait file ({fields_apart(data, expected)})')
    if data['kind'] not in KINDS:
        raise BadInputError('gait kind', data['kind'], f'one of {sorted(KINDS)}')
    theta_max = data['theta_max']
    if not isinstance(theta_max, (int, float)) or not 0.0 < theta_max <= math.pi:
        raise BadInputError('gait theta_max', theta_max, 'an angle in 0..pi [rad]')
    advance = data.get('advance', 0.0)
    if not isinstance(advance, (int, float)) or not 0.0 <= advance < math.inf:
        raise BadInputError('gait advance', advance, 'a way >= 0 [m]')
    return LibraryGait(
        str(data['name']),
        str(data['description']),
        str(data['robot']),
        float(theta_max),
        KINDS[data['kind']].from_mapping(data['parameters']),
        calibration_from_mapping(data['calibration']),
        float(advance),
    )


def gait_to_mapping(entry: LibraryGait) -> dict[str, Any]:
    """Return what `load_gait` reads back."""
    advance = {'advance': round(entry.advance, 6)} if entry.advance else {}
    return {
        'name': entry.name,
        'description': entry.description,
        'kind': next(kind for kind, cls in KINDS.items() if isinstance(entry.gait, cls)),
        'robot': entry.robot,
        'theta_max': round(entry.theta_max, 9),
        **advance,
        'parameters': entry.gait.to_mapping(),
        'calibration': entry.calibration.to_mapping(),
    }
