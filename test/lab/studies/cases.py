"""Cheap cases for sweeps, importable by worker processes."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import ClassVar

from omega_turn_lab.studies.tasks import Result
from omega_turn_ros.errors import BadInputError


@dataclass(frozen=True)
class Square:
    """The square of a number; a third of it to see every digit."""

    code: ClassVar[tuple[str, ...]] = ('omega_turn_ros.errors',)
    value: int

    def run(self) -> Result:
        return {'square': self.value**2, 'third': self.value / 3.0}


@dataclass(frozen=True)
class Hopeless:
    """A case that cannot be computed."""

    code: ClassVar[tuple[str, ...]] = ('omega_turn_ros.errors',)
    value: int

    def run(self) -> Result:
        raise BadInputError('value', self.value, 'a value that can be computed')


@dataclass(frozen=True)
class WhoAmI:
    """The process that runs the case, and the threads it allows a numerical library."""

    code: ClassVar[tuple[str, ...]] = ('omega_turn_ros.errors',)
    value: int

    def run(self) -> Result:
        return {'pid': os.getpid(), 'threads': os.environ.get('OMP_NUM_THREADS')}
