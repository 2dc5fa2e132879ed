"""Resident memory of the three nodes over one long turn: memory_soak.py [SECONDS [RATE]]."""

from __future__ import annotations

import math
import sys
import time

from processes import Processes, megabytes, wait_for  # isort: skip  (prepares ROS)
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

from omega_turn_ros.nodes.time import nanoseconds_of

DOMAIN = 86
SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 10_000.0
RATE = float(sys.argv[2]) if len(sys.argv) > 2 else 100.0  # [Hz] of all topics
REPORTS = 10


def main() -> None:
    context = Context()
    rclpy.init(context=context, domain_id=DOMAIN)
    node = rclpy.create_node('soak', context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    clock = [0]
    turn = node.create_publisher(Float64, 'turn_angle', 10)

    def look() -> None:
        executor.spin_once(timeout_sec=0.5)
        time.sleep(0.5)

    node.create_subscription(
        Clock, '/clock', lambda m: clock.__setitem__(0, nanoseconds_of(m.clock)), 1
    )
    with Processes(DOMAIN) as processes:
        nodes = {
            'bridge': processes.node('pybullet_bridge', real_time_factor=0.0, rate=RATE),
            'gait': processes.node(
                'gait_node', use_sim_time=True, heading_feedback='odom', rate=RATE
            ),
            'admittance': processes.node('admittance_node', use_sim_time=True),
        }
        wait_for(lambda: clock[0] > 0 and turn.get_subscription_count() > 0, 60, 'nodes', look)
        turn.publish(Float64(data=math.radians(90.0) * SECONDS / 10.0))
        start = time.monotonic()
        print('simulated s  ' + '  '.join(f'{name:>10s}' for name in nodes) + '   [MB]')
        for k in range(REPORTS + 1):
            while clock[0] * 1e-9 < 20.0 + k * SECONDS / REPORTS:
                look()
            sizes = '  '.join(f'{megabytes(n):10.1f}' for n in nodes.values())
            print(f'{clock[0] * 1e-9:11.0f}  {sizes}', flush=True)
        print(f'{SECONDS / (time.monotonic() - start):.1f} x real time')
    node.destroy_node()
    context.try_shutdown()


if __name__ == '__main__':
    main()
