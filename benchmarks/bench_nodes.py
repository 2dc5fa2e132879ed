"""CPU per command and effort-to-command latency, beside bare rclpy nodes in the same run.

The robot is a fake of 100 joint_states per second in this process.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

from processes import Processes, cpu_seconds, wait_for  # isort: skip  (prepares ROS)
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from omega_turn_ros.nodes.time import nanoseconds_of

DOMAIN = 88
BARE = str(Path(__file__).with_name('bare_nodes.py'))
JOINTS = [f'joint_{i}' for i in range(1, 17)]
SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0


class FakeRobot:
    """Publishes joint_states, notes when messages arrive."""

    def __init__(self) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=DOMAIN)
        self.node = rclpy.create_node('fake_robot', context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.states = self.node.create_publisher(JointState, 'joint_states', 10)
        self.turn = self.node.create_publisher(Float64, 'turn_angle', 10)
        self.counts: dict[str, int] = {}
        self.arrivals: dict[str, list[tuple[int, int]]] = {}
        self.position = [0.0] * 16

    def listen(self, topic: str) -> None:
        self.counts[topic], self.arrivals[topic] = 0, []

        def arrived(message: JointState) -> None:
            self.counts[topic] += 1
            now = time.monotonic_ns()
            self.arrivals[topic].append((nanoseconds_of(message.header.stamp), now))
            if topic == 'joint_commands':
                self.position = list(message.position)

        self.node.create_subscription(JointState, topic, arrived, 10)

    def publish_state(self) -> int:
        now = time.monotonic_ns()
        message = JointState(name=JOINTS, position=self.position)
        message.velocity, message.effort = [0.0] * 16, [0.5] * 16
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(now, 10**9)
        self.states.publish(message)
        return now

    def run(self, seconds: float, states: bool = True) -> None:
        """Publish states at 100 Hz and serve callbacks."""
        due = time.monotonic()
        end = due + seconds
        while due < end:
            if states:
                self.publish_state()
            due += 0.01
            while (left := due - time.monotonic()) > 0:
                self.executor.spin_once(timeout_sec=left)


def measure_cpu(robot: FakeRobot) -> None:
    with Processes(DOMAIN) as processes:
        nodes = {
            'gait_node, turning': processes.node('gait_node', use_compliance=False),
            'bare publisher': processes.script(BARE, 'publisher'),
            'bare publisher and listener': processes.script(BARE, 'listener'),
        }
        wait_for(
            lambda: min(robot.counts['joint_commands'], robot.counts['bare_commands']) > 10,
            60,
            'commands',
            lambda: robot.run(0.1),
        )
        robot.turn.publish(Float64(data=100.0))
        robot.run(2.0)
        start = {name: cpu_seconds(node) for name, node in nodes.items()}
        commands = robot.counts['joint_commands']
        robot.run(SECONDS)
        commands = robot.counts['joint_commands'] - commands
        used = {name: cpu_seconds(node) - start[name] for name, node in nodes.items()}
    floor = used['bare publisher']
    print(f'CPU over {SECONDS:g} s, {commands} commands:')
    for name, seconds in used.items():
        per = 1e3 * seconds / (SECONDS * 100.0)
        print(f'  {name:28s} {per:6.3f} ms per command, {seconds / floor:5.2f} x bare publisher')


def measure_latency(robot: FakeRobot) -> None:
    with Processes(DOMAIN) as processes:
        processes.node('gait_node')
        processes.node('admittance_node')
        processes.script(BARE, 'relay', 'joint_states', 'hop')
        processes.script(BARE, 'relay', 'hop', 'hops')
        for topic in robot.counts:
            robot.counts[topic] = 0
        wanted = ('hops', 'wave_amplitudes', 'joint_commands')
        wait_for(
            lambda: min(robot.counts[t] for t in wanted) > 10,
            60,
            'all nodes',
            lambda: robot.run(0.1),
        )
        robot.turn.publish(Float64(data=100.0))
        robot.run(1.0)
        for arrivals in robot.arrivals.values():
            arrivals.clear()
        robot.run(SECONDS)
    hops = sorted(now - stamp for stamp, now in robot.arrivals['hops'])
    law = sorted(now - stamp for stamp, now in robot.arrivals['wave_amplitudes'])
    commands = [now for _, now in robot.arrivals['joint_commands']]
    whole = []
    for stamp, now in robot.arrivals['wave_amplitudes']:
        later = next((c for c in commands if c > now), None)
        if later is not None:
            whole.append(later - stamp)
    floor = statistics.median(hops)
    print('latency, median and 95 % [ms]:')
    for name, values in (
        ('two bare rclpy hops', hops),
        ('effort to wave_amplitudes', law),
        ('effort to joint_commands', sorted(whole)),
    ):
        median, high = statistics.median(values), values[int(0.95 * len(values))]
        print(f'  {name:28s} {median * 1e-6:6.2f} {high * 1e-6:6.2f}')
    budget = 1.5 * floor * 1e-6 + 10.0
    print(f'  budget for the last: 1.5 x two hops + one control period = {budget:.2f} ms')


def main() -> None:
    robot = FakeRobot()
    for topic in ('joint_commands', 'bare_commands'):
        robot.listen(topic)
    measure_cpu(robot)
    for topic in ('hops', 'wave_amplitudes'):
        robot.listen(topic)
    measure_latency(robot)


if __name__ == '__main__':
    main()
