"""The recorder on a real ROS graph, its file read back by an independent decoder."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rclpy
from builtin_interfaces.msg import Time
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from omega_turn_lab.recording import BagRecorder, schema_text
from omega_turn_lab.run_record import RunRecord
from omega_turn_ros.errors import BadInputError

DOMAIN = 97
PATIENCE = 20.0  # [s] a test waits for a message before it fails
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Graph:
    """A publishing and a recording node in one executor of their own context."""

    def __init__(self) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=DOMAIN)
        self.talker = Node('talker', context=self.context, namespace='robot')
        self.listener = Node('listener', context=self.context, namespace='robot')
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.talker)
        self.executor.add_node(self.listener)

    def spin_until(self, done: Callable[[], object]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not done():
            assert time.monotonic() < deadline, 'nothing arrived'
            self.executor.spin_once(timeout_sec=0.05)

    def close(self) -> None:
        self.executor.shutdown()
        self.talker.destroy_node()
        self.listener.destroy_node()
        self.context.shutdown()


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    made = Graph()
    yield made
    made.close()


def read_back(path: Path) -> dict[str, list[tuple[Any, Any]]]:
    """(log record, decoded message) by topic."""
    found: dict[str, list[tuple[Any, Any]]] = {}
    with path.open('rb') as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append((message, decoded))
    return found


def shows(node: Node, nanoseconds: int) -> bool:
    return bool(node.get_clock().now().nanoseconds == nanoseconds)


def holds(recorder: BagRecorder, count: int) -> bool:
    return sum(recorder.counts.values()) == count


def test_the_file_gives_back_every_value_that_was_published(graph: Graph, tmp_path: Path) -> None:
    path = tmp_path / 'new' / 'run.mcap'
    publisher = graph.talker.create_publisher(JointState, 'joint_states', 10)
    odom_publisher = graph.talker.create_publisher(Odometry, 'odom', 10)
    topics = [('joint_states', JointState, 10), ('odom', Odometry, 10)]
    sent = JointState(name=['joint_1', 'ü'], position=[0.25, -1e-300], effort=[5.0])
    sent.header.stamp = Time(sec=7, nanosec=123456789)
    odom = Odometry(child_frame_id='body')
    odom.pose.pose.position.x = -1.5
    odom.pose.covariance[35] = 4.0
    odom.twist.twist.angular.z = 0.75
    with BagRecorder(graph.listener, path, topics) as recorder:
        graph.spin_until(
            lambda: publisher.get_subscription_count() and odom_publisher.get_subscription_count()
        )
        publisher.publish(sent)
        odom_publisher.publish(odom)
        graph.spin_until(lambda: holds(recorder, 2))
        assert recorder.counts == {'/robot/joint_states': 1, '/robot/odom': 1}
    found = read_back(path)
    [(_, joints)] = found['/robot/joint_states']
    assert joints.name == ['joint_1', 'ü']
    assert list(joints.position) == [0.25, -1e-300]
    assert (list(joints.velocity), list(joints.effort)) == ([], [5.0])
    assert (joints.header.stamp.sec, joints.header.stamp.nanosec) == (7, 123456789)
    [(_, body)] = found['/robot/odom']
    assert (body.child_frame_id, body.pose.pose.position.x) == ('body', -1.5)
    assert (body.pose.covariance[35], body.twist.twist.angular.z) == (4.0, 0.75)


def test_a_latched_message_sent_before_the_recorder_came_is_recorded(
    graph: Graph, tmp_path: Path
) -> None:
    publisher = graph.talker.create_publisher(Float64, 'turn_remaining', LATCHED)
    publisher.publish(Float64(data=1.25))
    path = tmp_path / 'run.mcap'
    with BagRecorder(graph.listener, path, [('turn_remaining', Float64, LATCHED)]) as recorder:
        graph.spin_until(lambda: recorder.counts['/robot/turn_remaining'] == 1)
    [(_, message)] = read_back(path)['/robot/turn_remaining']
    assert message.data == 1.25


def test_log_time_is_the_stamp_and_unstamped_messages_take_the_one_before(
    graph: Graph, tmp_path: Path
) -> None:
    states = graph.talker.create_publisher(JointState, 'joint_states', LATCHED)
    angle = graph.talker.create_publisher(Float64, 'turn_angle', LATCHED)
    topics = [('joint_states', JointState, LATCHED), ('turn_angle', Float64, LATCHED)]
    with BagRecorder(graph.listener, tmp_path / 'run.mcap', topics) as recorder:
        graph.spin_until(
            lambda: states.get_subscription_count() and angle.get_subscription_count()
        )
        angle.publish(Float64(data=1.0))
        for count, second in ((3, 3), (5, 5)):
            message = JointState()
            message.header.stamp = Time(sec=second, nanosec=1)
            states.publish(message)
            angle.publish(Float64(data=float(second)))
            graph.spin_until(partial(holds, recorder, count))
    found = read_back(tmp_path / 'run.mcap')
    times = [3_000_000_001, 5_000_000_001]
    assert [record.log_time for record, _ in found['/robot/joint_states']] == times
    by_value = {m.data: record.log_time for record, m in found['/robot/turn_angle']}
    assert by_value == {1.0: times[0], 3.0: times[0], 5.0: times[1]}


def test_the_file_speaks_the_dialect_foxglove_and_plotjuggler_read(
    graph: Graph, tmp_path: Path
) -> None:
    path = tmp_path / 'run.mcap'
    topics = [('a', Float64, 10), ('b', Float64, 10), ('odom', Odometry, 10)]
    BagRecorder(graph.listener, path, topics).close()
    with path.open('rb') as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == 'ros2'
        summary = reader.get_summary()
    assert summary is not None
    assert {schema.name for schema in summary.schemas.values()} == {
        'std_msgs/msg/Float64',
        'nav_msgs/msg/Odometry',
    }
    assert {schema.encoding for schema in summary.schemas.values()} == {'ros2msg'}
    assert {channel.message_encoding for channel in summary.channels.values()} == {'cdr'}
    topics_found = sorted(channel.topic for channel in summary.channels.values())
    assert topics_found == ['/robot/a', '/robot/b', '/robot/odom']


def test_a_schema_carries_every_definition_it_needs_once() -> None:
    lines = schema_text('nav_msgs/msg/Odometry').splitlines()
    heads = [line for line in lines if line.startswith('MSG: ')]
    assert sorted(heads) == sorted(
        f'MSG: {name}'
        for name in (
            'std_msgs/Header',
            'builtin_interfaces/Time',
            'geometry_msgs/PoseWithCovariance',
            'geometry_msgs/Pose',
            'geometry_msgs/Point',
            'geometry_msgs/Quaternion',
            'geometry_msgs/TwistWithCovariance',
            'geometry_msgs/Twist',
            'geometry_msgs/Vector3',
        )
    )
    assert all(lines[lines.index(head) - 1] == '=' * 80 for head in heads)


def test_nothing_is_recorded_after_close_and_closing_twice_is_harmless(
    graph: Graph, tmp_path: Path
) -> None:
    publisher = graph.talker.create_publisher(Float64, 'value', 10)
    path = tmp_path / 'run.mcap'
    recorder = BagRecorder(graph.listener, path, [('value', Float64, 10)])
    graph.spin_until(lambda: publisher.get_subscription_count() == 1)
    publisher.publish(Float64(data=1.0))
    graph.spin_until(lambda: holds(recorder, 1))
    recorder.close()
    recorder.close()
    size = path.stat().st_size
    publisher.publish(Float64(data=2.0))
    for _ in range(5):
        graph.executor.spin_once(timeout_sec=0.02)
    assert holds(recorder, 1)
    assert path.stat().st_size == size


def test_the_file_is_whole_even_when_the_node_is_gone_first(graph: Graph, tmp_path: Path) -> None:
    path = tmp_path / 'run.mcap'
    recorder = BagRecorder(graph.listener, path, [('value', Float64, 10)])
    graph.executor.remove_node(graph.listener)
    graph.listener.destroy_node()
    recorder.close()
    assert read_back(path) == {}


def test_a_missing_definition_is_named_with_the_places_searched() -> None:
    with pytest.raises(BadInputError, match=r'no_such_pkg/msg/Thing.*no_such_pkg/msg/Thing\.msg'):
        schema_text('no_such_pkg/msg/Thing')


def test_wrong_topics_are_refused_before_a_file_is_made(graph: Graph, tmp_path: Path) -> None:
    path = tmp_path / 'run.mcap'
    with pytest.raises(BadInputError, match='message class'):
        BagRecorder(graph.listener, path, [('value', dict, 10)])
    with pytest.raises(BadInputError, match='each topic once'):
        BagRecorder(graph.listener, path, [('a', Float64, 10), ('/robot/a', Float64, 10)])
    assert not path.exists()


def run_arrays() -> dict[str, Any]:
    return {
        'time': np.array([0.0, 0.5, 1.0]),
        'pose': np.zeros((3, 3)),
        'joint_positions': np.zeros((3, 16)),
        'joint_commands': np.zeros((3, 16)),
        'remaining': np.zeros(3),
    }


def test_a_run_record_takes_arrays_that_belong_together() -> None:
    assert RunRecord(**run_arrays()).joint_positions.shape == (3, 16)


@pytest.mark.parametrize(
    ('field', 'value'),
    [
        ('time', np.zeros((3, 1))),
        ('time', np.array([0.0, 2.0, 1.0])),
        ('time', np.zeros(3)),
        ('pose', np.zeros((3, 2))),
        ('joint_positions', np.zeros(3)),
        ('joint_commands', np.zeros((3, 15))),
        ('joint_commands', np.full((3, 16), np.nan)),
        ('remaining', np.zeros(4)),
    ],
)
def test_a_run_record_refuses_what_does_not_fit_by_name(field: str, value: Any) -> None:
    with pytest.raises(BadInputError, match=f'^{field}: '):
        RunRecord(**{**run_arrays(), field: value})
