"""Recording topics to an MCAP file for Foxglove and PlotJuggler."""

from __future__ import annotations

import contextlib
import re
import struct
import sys
import threading
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from mcap.well_known import MessageEncoding, Profile, SchemaEncoding
from mcap.writer import Writer
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.qos import QoSProfile

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.health import steady_clock
from omega_turn_ros.nodes.inbox import Inbox

LOOK_EVERY = 0.1  # [s]
QUEUE = 1000  # messages a topic may pile up between two looks
SEPARATOR = '=' * 80  # between the definitions that make one 'ros2msg' schema
INTEGERS = {f'{sign}int{bits}' for sign in ('', 'u') for bits in (8, 16, 32, 64)}
BUILT_IN_TYPES = INTEGERS | {'bool', 'byte', 'char', 'float32', 'float64', 'string', 'wstring'}


class BagRecorder:
    """Writes topics, byte for byte as they arrive, to one MCAP file.

    Messages keep their CDR encoding and are never decoded; the schemas are the .msg definitions
    themselves, so Foxglove and PlotJuggler need nothing else. Log and publish time are the stamp
    of a stamped message, else of the stamped one before it. Topics are looked at ten times a
    second, so recording does not slow down the run it watches.

    Args:
        node: whose executor and clock are used; it stays the caller's.
        path: the file, replaced if it exists; missing folders are made.
        topics: (topic, message class, QoS) each. A transient local QoS also gets what a latched
            publisher sent before.

    Raises:
        BadInputError: a topic named twice, a class that is no message, or a definition not found.
    """

    def __init__(
        self,
        node: Node,
        path: Path | str,
        topics: Sequence[tuple[str, type[Any], QoSProfile | int]],
    ) -> None:
        self.path = Path(path)
        names = [node.resolve_topic_name(topic) for topic, _, _ in topics]
        for name, count in Counter(names).items():
            if count > 1:
                raise BadInputError('topics', name, 'each topic once')
        types = [message_type_name(message) for _, message, _ in topics]
        schemas = {name: schema_text(name) for name in types}
        self._node = node
        self._lock = threading.Lock()  # an executor may run callbacks while another thread closes
        self._counts = dict.fromkeys(names, 0)
        self._sources: list[tuple[Inbox[Any], int, bool]] = []
        self._latest: int | None = None
        self._waiting: list[tuple[int, int, bytes, int | None]] = []
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._stream = self.path.open('wb')
        self._writer: Any = Writer(self._stream)  # mcap leaves parts of it untyped
        self._open = True
        try:
            channels = self._start_file(names, types, schemas)
            self._sources = [
                (Inbox(node, message, name, _deep(qos), raw=True), channel, _is_stamped(message))
                for name, channel, (_, message, qos) in zip(names, channels, topics)
            ]
            self._timer = node.create_timer(LOOK_EVERY, self._drain, clock=steady_clock())
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> BagRecorder:
        """Return the recorder itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Finish the file."""
        self.close()

    @property
    def counts(self) -> dict[str, int]:
        """Messages received so far, by fully resolved topic name."""
        return dict(self._counts)

    def close(self) -> None:
        """Finish the file and end the subscriptions; further calls do nothing."""
        with self._lock:
            if not self._open:
                return
        with contextlib.suppress(InvalidHandle):  # the node went first: keep what was written
            self._drain()
        with self._lock:
            self._open = False
            try:
                self._write_waiting(self._node.get_clock().now().nanoseconds)
                self._writer.finish()
            finally:
                self._stream.close()

    def _start_file(
        self, names: Sequence[str], types: Sequence[str], schemas: dict[str, str]
    ) -> list[int]:
        """Write header, schemas and channels; return the channel of each topic."""
        self._writer.start(profile=Profile.ROS2, library='omega_turn_lab')
        schema_ids = {
            name: self._writer.register_schema(name, SchemaEncoding.ROS2, text.encode())
            for name, text in schemas.items()
        }
        return [
            self._writer.register_channel(name, MessageEncoding.CDR, schema_ids[kind])
            for name, kind in zip(names, types)
        ]

    def _drain(self) -> None:
        """Write what has arrived since the last look."""
        with self._lock:
            if not self._open:
                return
            for inbox, channel, stamped in self._sources:
                for data in inbox.drain():
                    if stamped:
                        self._latest = _stamp_in(data)
                    self._counts[inbox.topic] += 1
                    count = self._counts[inbox.topic]
                    self._waiting.append((channel, count, data, self._latest))
            if self._latest is not None:
                self._write_waiting(self._latest)

    def _write_waiting(self, now: int) -> None:
        """Write the queue; what came before any stamp is dated `now` [ns]."""
        for channel, count, data, time in self._waiting:
            when = now if time is None else time
            self._writer.add_message(channel, when, data, when, count)
        self._waiting.clear()


def _deep(qos: QoSProfile | int) -> QoSProfile:
    """The same QoS with a queue that outlasts the time between two looks."""
    if isinstance(qos, int):
        return QoSProfile(depth=max(qos, QUEUE))
    return QoSProfile(depth=QUEUE, reliability=qos.reliability, durability=qos.durability)


def _is_stamped(message: type[Any]) -> bool:
    """Whether the first field is a time or a header, which begins with one."""
    first = next(iter(message.get_fields_and_field_types().values()), '')
    return first in ('std_msgs/Header', 'builtin_interfaces/Time')


def _stamp_in(data: bytes) -> int:
    """Nanoseconds of the stamp that leads a CDR message, behind its 4 bytes of encapsulation."""
    order = '<' if data[1] & 1 else '>'
    seconds, nanoseconds = struct.unpack_from(f'{order}iI', data, 4)
    return max(seconds * 10**9 + nanoseconds, 0)


def message_type_name(message: type[Any]) -> str:
    """Return the ROS name of a message class, e.g. `sensor_msgs/msg/JointState`.

    Raises:
        BadInputError: the class is no ROS 2 message.
    """
    package, _, kind = message.__module__.partition('.')
    if not hasattr(message, 'get_fields_and_field_types') or not kind.startswith('msg.'):
        raise BadInputError('topics', message, 'a message class such as std_msgs.msg.Float64')
    return f'{package}/msg/{message.__name__}'


def schema_text(type_name: str) -> str:
    """Concatenate the definition of a message and all it contains, in MCAP's 'ros2msg' format.

    Args:
        type_name: e.g. `sensor_msgs/msg/JointState`.

    Raises:
        BadInputError: one of the definitions is not found.
    """
    package, _, name = type_name.split('/')
    definitions: dict[tuple[str, str], str] = {}
    waiting = [(package, name)]
    while waiting:
        key = waiting.pop(0)
        if key not in definitions:
            definitions[key] = _definition_file(*key).read_text(encoding='utf-8')
            waiting += _dependencies(key[0], definitions[key])
    first, *others = definitions.items()
    parts = [first[1]]
    parts += [f'{SEPARATOR}\nMSG: {pkg}/{msg}\n{text}' for (pkg, msg), text in others]
    return '\n'.join(parts)


def _dependencies(package: str, definition: str) -> list[tuple[str, str]]:
    """(package, name) of each message that a .msg definition contains, in its order."""
    found = []
    for line in definition.splitlines():
        field = line.partition('#')[0].split()
        if not field:
            continue
        base = re.split(r'[\[<]', field[0])[0]  # without array and string bounds
        if base not in BUILT_IN_TYPES:
            owner, _, name = base.rpartition('/')
            found.append((owner or package, name))
    return found


def _definition_file(package: str, name: str) -> Path:
    """The .msg file, from the ament index of a ROS installation or else this environment."""
    folders = [*_ament_share(package), Path(sys.prefix, 'share', package)]
    files = [folder / 'msg' / f'{name}.msg' for folder in folders]
    for file in files:
        if file.is_file():
            return file
    looked = ' or '.join(str(file) for file in files)
    raise BadInputError('message type', f'{package}/msg/{name}', f'a definition at {looked}')


def _ament_share(package: str) -> list[Path]:
    """Share folder of a package according to the ament index; empty where that knows nothing."""
    try:
        from ament_index_python.packages import get_package_share_directory

        return [Path(get_package_share_directory(package, print_warning=False))]
    except ImportError:
        return []  # not a ROS environment
    except (LookupError, OSError):
        return []  # package not indexed, or AMENT_PREFIX_PATH unset as in a plain venv
