"""Joint positions straight from serialised JointStates, without a Python message for each."""

from __future__ import annotations

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.joint_message import JointReader

Array = NDArray[np.float64]

CDR_HEADER = 4  # [bytes] encoding; alignment counts from behind it
LITTLE_ENDIAN = b'\x00\x01\x00\x00'
STAMP = struct.Struct('<iI')
COUNT = struct.Struct('<I')  # before each string and array


class Reading(NamedTuple):
    """What the control step wants of a JointState.

    Attributes:
        seconds: of the stamp.
        nanoseconds: of the stamp.
        positions: [rad], shape (n_joints,), in the reader's order.
        effort: largest |effort| in the message [N m], NaN aside; 0 where there is none.
    """

    seconds: int
    nanoseconds: int
    positions: Array
    effort: float


class RawStateReader:
    """Reads serialised JointStates exactly as `JointReader` reads their messages.

    A robot repeats itself: frame, names and array sizes stay, stamp and numbers change. Making a
    Python message of all that costs several times what the numbers are worth. So where a message
    agrees with one that was read and checked before in all but stamp and numbers, these are taken
    from its bytes. Every other message, and every number that is not finite, goes the whole way.

    Args:
        reader: checks and orders the joints.
    """

    def __init__(self, reader: JointReader) -> None:
        self._reader = reader
        self._layout: _Layout | None = None

    def read(self, data: bytes) -> Reading:
        """Return stamp, positions and the largest effort.

        Raises:
            BadInputError: the bytes are no JointState, or as `JointReader.read`.
        """
        layout = self._layout
        if layout is not None and layout.fits(data):
            positions: Array = layout.positions(data)[layout.order]
            if np.isfinite(positions).all():
                seconds, nanoseconds = STAMP.unpack_from(data, CDR_HEADER)
                return Reading(seconds, nanoseconds, positions, largest(layout.efforts(data)))
        try:
            message = deserialize_message(data, JointState)
        except RuntimeError as error:  # RMWError, which rclpy keeps to itself
            raise BadInputError('message', f'{len(data)} bytes', 'a JointState') from error
        positions = self._reader.read(message, 'position')
        self._layout = _Layout(message, self._reader.order)
        stamp = message.header.stamp
        return Reading(stamp.sec, stamp.nanosec, positions, largest(np.array(message.effort)))


def largest(efforts: Array) -> float:
    """Return the largest |effort|, NaN aside; 0 of none."""
    return float(np.fmax.reduce(np.abs(efforts), initial=0.0))


class _Layout:
    """Where the numbers of a serialised JointState are, and the bytes that must not change.

    Args:
        message: that was read and checked.
        order: of its joints.
    """

    def __init__(self, message: JointState, order: NDArray[np.intp]) -> None:
        self.order, self._count = order, len(message.position)
        self._wanted, self._mask = bytearray(), bytearray()
        self._expect(LITTLE_ENDIAN)
        self._skip(STAMP.size)
        self._expect_text(message.header.frame_id)
        self._expect(COUNT.pack(len(message.name)))
        for name in message.name:
            self._expect_text(name)
        ends = []
        for numbers in (message.position, message.velocity, message.effort):
            self._expect(COUNT.pack(len(numbers)))
            if numbers:
                self._skip(8 * len(numbers), 8)
            ends.append(len(self._mask))
        self._start = ends[0] - 8 * self._count
        self._efforts = len(message.effort)
        self._efforts_start = ends[2] - 8 * self._efforts
        # Long integers: what writers leave in the gaps of alignment is garbage and must not count.
        self._mask_bits = int.from_bytes(self._mask, 'little')
        self._wanted_bits = int.from_bytes(self._wanted, 'little')

    def fits(self, data: bytes) -> bool:
        """Whether the bytes differ from those of the layout in stamp and numbers only."""
        bits = int.from_bytes(data, 'little')
        return len(data) >= len(self._mask) and bits & self._mask_bits == self._wanted_bits

    def positions(self, data: bytes) -> Array:
        """Joint positions in the message's order [rad]."""
        return np.frombuffer(data, '<f8', self._count, self._start)

    def efforts(self, data: bytes) -> Array:
        """Joint efforts in the message's order [N m], empty where it has none."""
        return np.frombuffer(data, '<f8', self._efforts, self._efforts_start)

    def _skip(self, size: int, alignment: int = 1) -> None:
        size += (CDR_HEADER - len(self._mask)) % alignment
        self._wanted += bytes(size)
        self._mask += bytes(size)

    def _expect(self, piece: bytes) -> None:
        self._skip(0, 4)
        self._wanted += piece
        self._mask += b'\xff' * len(piece)

    def _expect_text(self, text: str) -> None:
        piece = text.encode() + b'\0'
        self._expect(COUNT.pack(len(piece)))
        self._expect(piece)
