"""What a ground is to the bridge: one frozen value, from code, parameters or YAML."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.force_laws import GranularResistance
from omega_turn_ros.resources import read_config

KINDS = ('flat', 'granular', 'pegboard', 'rocks')
SMALLEST_STONE = 0.05  # over the pile's extent; smaller ones are thousands


@dataclass(frozen=True, slots=True)
class TerrainConfig:
    """A ground and what lies on it. Lengths in body lengths [BL] follow the robot.

    Attributes:
        kind: 'flat'; 'granular', a bed of grains that resists by the direction of slip;
            'pegboard', upright pegs in a hexagonal lattice; or 'rocks', a pile of convex rocks
            that has come to rest.
        extent_bl: obstacles reach this far around the start [BL].
        spacing_bl: between the axes of neighbouring pegs [BL].
        peg_radius: [m].
        peg_height: [m].
        peg_friction: coefficient between body and peg.
        clearance: least gap between straight robot and pegs at the start [m].
        rock_size_bl: mean diameter of the rocks [BL].
        rock_fill: mean diameter of the stones in the gaps between rocks, over that of the rocks;
            0 leaves the gaps open down to the ground.
        rock_friction: coefficient between body and rock.
        resistance_ratio: of grains, to sliding sideways over to sliding lengthways.
    """

    kind: str = 'flat'
    extent_bl: float = 1.5
    spacing_bl: float = 0.3
    peg_radius: float = 0.02
    peg_height: float = 0.1
    peg_friction: float = 0.2
    clearance: float = 0.01
    rock_size_bl: float = 0.3
    rock_fill: float = 0.4
    rock_friction: float = 0.5
    resistance_ratio: float = 1.5

    def __post_init__(self) -> None:
        """Refuse what makes no ground."""
        if self.kind not in KINDS:
            raise BadInputError('terrain kind', self.kind, f'one of {KINDS}')
        lengths = ('extent_bl', 'spacing_bl', 'peg_radius', 'peg_height', 'rock_size_bl')
        for field in (*lengths, 'peg_friction', 'clearance', 'rock_fill', 'rock_friction'):
            value = getattr(self, field)
            number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not number or not math.isfinite(value) or value < 0.0:
                raise BadInputError(f'terrain {field}', value, 'a finite number >= 0')
            if value == 0.0 and field in lengths:
                raise BadInputError(f'terrain {field}', value, 'a length > 0')
        if self.kind == 'rocks':
            self._check_rocks()
        ratio, largest = self.resistance_ratio, GranularResistance().ratio
        number = isinstance(ratio, (int, float)) and not isinstance(ratio, bool)
        if not number or not 1.0 <= ratio <= largest:
            raise BadInputError('terrain resistance_ratio', ratio, f'a ratio in 1..{largest:.3g}')

    def _check_rocks(self) -> None:
        """Refuse a pen that holds no rock, or thousands."""
        size, smallest = self.rock_size_bl, SMALLEST_STONE * self.extent_bl
        if not smallest <= size <= self.extent_bl:
            expected = f'{smallest:.3g}..{self.extent_bl:g}, by extent_bl'
            raise BadInputError('terrain rock_size_bl', size, expected)
        if self.rock_fill and not smallest <= self.rock_fill * size <= size:
            expected = f'0, or {smallest / size:.3g}..1, by extent_bl and rock_size_bl'
            raise BadInputError('terrain rock_fill', self.rock_fill, expected)


def load_terrain(name: str) -> TerrainConfig:
    """Read a ground from `config/terrains/<name>.yaml` or from a path ending in `.yaml`.

    Raises:
        BadInputError: the file is missing, or a field is unknown or out of range.
    """
    data: dict[str, Any] = read_config('terrains', name)
    known = sorted(field.name for field in fields(TerrainConfig))
    for key in data:
        if key not in known:
            raise BadInputError(f'terrain field {key}', data[key], f'one of {known}')
    return TerrainConfig(**data)
