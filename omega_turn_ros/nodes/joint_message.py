"""Checked reading of JointState messages, and fast writing of them."""

from __future__ import annotations

from array import array

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import JointState

from omega_turn_ros.errors import BadInputError

Array = NDArray[np.float64]


class JointReader:
    """Brings the arrays of a JointState into one fixed joint order.

    Names may come in any order. A name that is missing, unknown or doubled, an array of another
    length than the names, and any NaN or Inf refuse the message whole.

    Args:
        names: joints (or waves) in the wanted order.
        ignore_unknown: let other names pass, unread.

    Attributes:
        order: place in the last message read of each name, shape (n_names,).
    """

    def __init__(self, names: tuple[str, ...], ignore_unknown: bool = False) -> None:
        self._names = names
        self._ignore_unknown = ignore_unknown
        self._seen: list[str] | None = None
        self.order: NDArray[np.intp] = np.zeros(0, np.intp)

    def read(self, message: JointState, field: str) -> Array:
        """Return one array of the message in the reader's order, shape (n_names,).

        Args:
            message: the message.
            field: 'position', 'velocity' or 'effort'.

        Raises:
            BadInputError: see the class.
        """
        names = message.name
        if names != self._seen:
            self.order = self._find_order(names)
            self._seen = list(names)
        data = getattr(message, field)
        if len(data) != len(names):
            raise BadInputError(
                field, f'{len(data)} numbers', f'{len(names)} numbers, one per name'
            )
        values: Array = np.array(data, float)[self.order]
        if not np.isfinite(values).all():
            bad = int(np.flatnonzero(~np.isfinite(values))[0])
            name, value = self._names[bad], float(values[bad])
            raise BadInputError(f'{field} of {name}', value, 'a finite number')
        return values

    def _find_order(self, names: list[str]) -> NDArray[np.intp]:
        place = {name: i for i, name in enumerate(names)}
        if len(place) != len(names):
            doubled = next(name for name in names if names.count(name) > 1)
            raise BadInputError('name', doubled, 'every joint once')
        for name in self._names:
            if name not in place:
                raise BadInputError('name', names, f'a list with {name}')
        if not self._ignore_unknown and len(names) != len(self._names):
            unknown = next(name for name in names if name not in self._names)
            raise BadInputError('name', unknown, f'only {", ".join(self._names)}')
        return np.array([place[name] for name in self._names], np.intp)


class JointWriter:
    """Fills one JointState again and again. The arrays are passed as buffers, not as lists.

    Args:
        names: joints (or waves) in the order of the arrays.
        frame_id: of the header.
    """

    def __init__(self, names: tuple[str, ...], frame_id: str = '') -> None:
        self.message = JointState(name=list(names))
        self.message.header.frame_id = frame_id

    def fill(
        self, stamp: object, position: Array, velocity: Array, effort: Array | None = None
    ) -> JointState:
        """Return the message with new contents; valid until the next call."""
        message = self.message
        message.header.stamp = stamp
        message.position = array('d', position.tobytes())
        message.velocity = array('d', velocity.tobytes())
        if effort is not None:
            message.effort = array('d', effort.tobytes())
        return message
