"""Heading error of commanded turns: three processes, and this one publishing a Float64."""

from __future__ import annotations

import argparse
import math
import time

from processes import Processes, wait_for  # isort: skip  (prepares ROS)
import rclpy
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import Float64

from omega_turn_ros.nodes.messages import heading_of
from omega_turn_ros.nodes.qos import LATCHED

DOMAIN = 85


class User:
    """Publishes turns; follows odom and turn_remaining."""

    def __init__(self) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=DOMAIN)
        self.node = rclpy.create_node('user', context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.turn = self.node.create_publisher(Float64, 'turn_angle', 10)
        self.remaining: float | None = None
        self.heading: float | None = None
        self.turned = 0.0
        self.node.create_subscription(Float64, 'turn_remaining', self.on_remaining, LATCHED)
        self.node.create_subscription(Odometry, 'odom', self.on_odom, 50)

    def on_remaining(self, message: Float64) -> None:
        self.remaining = message.data

    def on_odom(self, message: Odometry) -> None:
        heading = heading_of(message)
        if self.heading is not None:
            self.turned += math.remainder(heading - self.heading, math.tau)
        self.heading = heading

    def is_connected(self) -> bool:
        heard = self.heading is not None and self.remaining is not None
        return heard and self.turn.get_subscription_count() > 0

    def spin(self) -> None:
        self.executor.spin_once(timeout_sec=0.1)

    def late_value(self) -> float:
        """What a subscriber that comes after the end gets."""
        seen: list[float] = []
        late = self.node.create_subscription(
            Float64, 'turn_remaining', lambda m: seen.append(m.data), LATCHED
        )
        wait_for(lambda: seen, 30, 'the latched value', self.spin)
        self.node.destroy_subscription(late)
        return seen[-1]


def measure(degrees: float, feedback: str, speed: float) -> None:
    user = User()
    with Processes(DOMAIN) as processes:
        processes.node('pybullet_bridge', real_time_factor=speed)
        processes.node('gait_node', heading_feedback=feedback, use_sim_time=True)
        processes.node('admittance_node', use_sim_time=True)
        wait_for(user.is_connected, 60, 'the nodes', user.spin)
        user.turned = 0.0
        user.turn.publish(Float64(data=math.radians(degrees)))
        wait_for(lambda: user.remaining != 0.0, 30, 'acceptance', user.spin)
        wait_for(lambda: user.remaining == 0.0, 600, 'the end', user.spin)
        late = user.late_value()
        end = time.monotonic() + 1.0
        while time.monotonic() < end:
            user.spin()
    achieved = math.degrees(user.turned)
    error = achieved - degrees
    print(
        f'{feedback:>5s} {degrees:+6.0f} deg: achieved {achieved:+8.2f}, error {error:+6.2f} deg '
        f'({error / degrees:+6.1%}), turn_remaining {user.remaining!r}, late subscriber {late!r}',
        flush=True,
    )
    user.node.destroy_node()
    user.context.try_shutdown()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        '--degrees', type=float, nargs='*', default=[30, -30, 90, -90, 180, -180, 300]
    )
    parser.add_argument('--speed', type=float, default=4.0, help='real-time factor asked for')
    options = parser.parse_args()
    for feedback in ('odom', 'none'):
        for degrees in options.degrees:
            measure(degrees, feedback, options.speed)


if __name__ == '__main__':
    main()
