"""The short way through serialised joint states against the long one."""

from __future__ import annotations

import math
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes import raw_joint_states
from omega_turn_ros.nodes.joint_message import JointReader
from omega_turn_ros.nodes.raw_joint_states import RawStateReader

SEEDED = settings(derandomize=True, deadline=None, max_examples=300)
NAMES = ('joint_1', 'j2', 'ellbogen_ß')

number = st.one_of(
    st.floats(-4.0, 4.0), st.sampled_from([0.0, -0.0, math.nan, math.inf, 1e308, 5e-324])
)
numbers = st.one_of(
    st.lists(st.floats(-4.0, 4.0), min_size=3, max_size=3), st.lists(number, max_size=5)
)
names = st.one_of(
    st.just(list(NAMES)),
    st.permutations(NAMES),
    st.lists(st.sampled_from([*NAMES, 'wheel', '', 'x' * 40]), max_size=5),
)


@st.composite
def messages(draw: Any) -> JointState:
    message = JointState(name=list(draw(names)))
    message.position, message.velocity, message.effort = (draw(numbers) for _ in range(3))
    message.header.frame_id = draw(st.sampled_from(['', 'base', 'süd', 'a frame of many letters']))
    message.header.stamp.sec = draw(st.integers(-(2**31), 2**31 - 1))
    message.header.stamp.nanosec = draw(st.integers(0, 2**32 - 1))
    return message


def outcome(read: Any, data: bytes) -> Any:
    try:
        seconds, nanoseconds, positions, effort = read(data)
    except BadInputError as error:
        return str(error)
    return seconds, nanoseconds, positions.tobytes(), effort


def long_way(reader: JointReader) -> Any:
    def read(data: bytes) -> Any:
        message = deserialize_message(data, JointState)
        stamp = message.header.stamp
        efforts = [abs(e) for e in message.effort if not math.isnan(e)]
        positions = reader.read(message, 'position')
        return stamp.sec, stamp.nanosec, positions, max(efforts, default=0.0)

    return read


def serialised(**fields: Any) -> bytes:
    message = JointState(name=list(NAMES), position=[0.1, -0.2, 0.3], **fields)
    return bytes(serialize_message(message))


@SEEDED
@given(
    st.lists(messages(), min_size=1, max_size=3),
    st.lists(st.integers(0, 2), max_size=8),
    st.booleans(),
    numbers,
)
def test_every_sequence_of_messages_reads_as_the_messages_do(
    several: list[JointState], repeats: list[int], ignore_unknown: bool, later: list[float]
) -> None:
    short = RawStateReader(JointReader(NAMES, ignore_unknown))
    long = long_way(JointReader(NAMES, ignore_unknown))
    for k in [*range(len(several)), *repeats]:
        message = several[k % len(several)]
        data = bytes(serialize_message(message))
        assert outcome(short.read, data) == outcome(long, data)
        message.position = later  # the robot moves on
        message.header.stamp.sec //= 2


@SEEDED
@given(st.integers(0, 400), st.binary(min_size=1, max_size=4), st.integers(0, 40))
def test_bytes_that_changed_on_the_way_read_as_their_message_or_are_refused(
    place: int, change: bytes, cut: int
) -> None:
    good = serialised(velocity=[1.0] * 3, effort=[2.0])
    place %= len(good)
    bad = (good[:place] + change + good[place + len(change) :])[: len(good) - cut]
    short = RawStateReader(JointReader(NAMES))
    short.read(good)
    try:
        expected = outcome(long_way(JointReader(NAMES)), bad)
    except RuntimeError:
        with pytest.raises(BadInputError, match='message'):
            short.read(bad)
    else:
        assert outcome(short.read, bad) == expected


def test_big_endian_messages_are_read_too() -> None:
    big = b'\0\0\0\0' + struct.pack('>iIIxxxxI', 7, 8, 1, 3)
    for name in NAMES:
        big += b'\0' * (-len(big) % 4) + struct.pack('>I', len(name.encode()) + 1)
        big += name.encode() + b'\0'
    big += b'\0' * (-len(big) % 4) + struct.pack('>I', 3)
    big += b'\0' * ((4 - len(big)) % 8) + struct.pack('>3dII', 0.1, -0.2, 0.3, 0, 0)
    reader = RawStateReader(JointReader(NAMES))
    for _ in range(2):
        seconds, nanoseconds, positions, effort = reader.read(big)
        assert (seconds, nanoseconds, positions.tolist(), effort) == (7, 8, [0.1, -0.2, 0.3], 0)


def test_a_robot_that_repeats_itself_is_read_the_short_way(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for once, again in (
        ({}, {}),
        ({'effort': [0.0] * 3}, {'effort': [5.0] * 3}),
        ({'velocity': [1.0]}, {'velocity': [math.nan]}),
    ):
        reader = RawStateReader(JointReader(NAMES))
        with monkeypatch.context() as patch:
            reader.read(serialised(**once))
            patch.delattr(raw_joint_states, 'deserialize_message')
            assert reader.read(serialised(**again)).positions.tolist() == [0.1, -0.2, 0.3]


def test_readings_are_not_changed_by_later_ones() -> None:
    reader = RawStateReader(JointReader(NAMES))
    first = [reader.read(serialised()).positions for _ in range(2)]
    assert all(np.array_equal(positions, [0.1, -0.2, 0.3]) for positions in first)
    assert all(positions.flags.owndata for positions in first)
