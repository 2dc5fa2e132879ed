"""What a run leaves behind: an MCAP file for Foxglove and PlotJuggler, and arrays for pictures."""

from __future__ import annotations

import re
import sys
import threading
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from mcap.well_known import MessageEncoding, Profile, SchemaEncoding
from mcap.writer import Writer
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

Array = NDArray[np.float64]

SEPARATOR = '=' * 80  # between the definitions that make one 'ros2msg' schema
INTEGERS = {f'{sign}int{bits}' for sign in ('', 'u') for bits in (8, 16, 32, 64)}
BUILT_IN_TYPES = INTEGERS | {'bool', 'byte', 'char', 'float32', 'float64', 'string', 'wstring'}


@dataclass(frozen=True, slots=True)
class RunRecord:
    """One run, sampled at T instants; every value is finite.

    Attributes:
        time: simulated or robot time, never decreasing [s], shape (T,).
        pose: mean body frame in the world: x [m], y [m], heading [rad, continuous], shape (T, 3).
        joint_positions: measured, head to tail [rad], shape (T, n_joints).
        joint_commands: what the gait asked for, head to tail [rad], shape (T, n_joints).
        remaining: angle still to turn [rad], shape (T,).
    """

    time: Array
    pose: Array
    joint_positions: Array
    joint_commands: Array
    remaining: Array

    def __post_init__(self) -> None:
        """Refuse arrays that do not belong together."""
        samples = np.shape(self.time)[:1]
        joints = np.shape(self.joint_positions)[1:2]
        if np.ndim(self.time) != 1 or samples[0] < 2:
            raise BadInputError('time', np.shape(self.time), 'shape (T,), T >= 2')
        expected = {
            'time': samples,
            'pose': (*samples, 3),
            'joint_positions': (*samples, *(joints or ('n_joints',))),
            'joint_commands': (*samples, *(joints or ('n_joints',))),
            'remaining': samples,
        }
        for field, shape in expected.items():
            value = getattr(self, field)
            if np.shape(value) != shape:
                raise BadInputError(field, np.shape(value), f'shape {shape}')
            if not np.isfinite(value).all():
                raise BadInputError(field, value[~np.isfinite(value)][0], 'finite numbers')
        if np.any(np.diff(self.time) < 0.0) or self.time[-1] <= self.time[0]:
            raise BadInputError('time', self.time, 'times that never decrease and do pass [s]')


class BagRecorder:
    """Writes topics, byte for byte as they arrive, to one MCAP file.

    Messages keep their CDR encoding and are never decoded; the schemas are the .msg definitions
    themselves, so Foxglove and PlotJuggler need nothing else. Log and publish time are the receipt
    in the node's clock, hence simulated time where the node uses it.

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
        self._subscriptions: list[Any] = []
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._stream = self.path.open('wb')
        self._writer: Any = Writer(self._stream)  # mcap leaves parts of it untyped
        self._open = True
        try:
            channels = self._start_file(names, types, schemas)
            for name, channel, (_, message, qos) in zip(names, channels, topics):
                callback = self._callback(name, channel)
                self._subscriptions.append(
                    node.create_subscription(message, name, callback, qos, raw=True)
                )
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
        """Messages written so far, by fully resolved topic name."""
        return dict(self._counts)

    def close(self) -> None:
        """Finish the file and end the subscriptions; further calls do nothing."""
        with self._lock:
            if not self._open:
                return
            self._open = False
            try:
                self._writer.finish()
            finally:
                self._stream.close()
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)

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

    def _callback(self, topic: str, channel: int) -> Callable[[bytes], None]:
        def write(data: bytes) -> None:
            now = self._node.get_clock().now().nanoseconds
            with self._lock:
                if not self._open:
                    return
                self._counts[topic] += 1
                self._writer.add_message(channel, now, data, now, self._counts[topic])

        return write


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
