"""Floors: bare rclpy nodes that do the messaging of ours and nothing else.

bare_nodes.py publisher            100 Hz timer, one 16-joint JointState
bare_nodes.py listener             the same, and a callback on joint_states
bare_nodes.py relay IN OUT         republishes a JointState
"""

from __future__ import annotations

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import JointState

import omega_turn_lab.ros_environment  # noqa: F401  (first: it may restart the interpreter)

JOINTS = [f'joint_{i}' for i in range(1, 17)]


def publisher(listen: bool) -> rclpy.node.Node:
    node = rclpy.create_node('bare')
    out = node.create_publisher(JointState, 'bare_commands', 10)

    def tick() -> None:
        message = JointState(name=JOINTS, position=[0.1] * 16, velocity=[0.2] * 16)
        message.header.stamp = node.get_clock().now().to_msg()
        out.publish(message)

    node.create_timer(0.01, tick)
    if listen:
        node.create_subscription(JointState, 'joint_states', lambda message: None, 10)
    return node


def relay(source: str, target: str) -> rclpy.node.Node:
    node = rclpy.create_node(f'relay_{target}')
    out = node.create_publisher(JointState, target, 10)
    node.create_subscription(JointState, source, out.publish, 10)
    return node


def main() -> None:
    rclpy.init()
    kind, *topics = sys.argv[1:]
    node = relay(*topics) if kind == 'relay' else publisher(kind == 'listener')
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
