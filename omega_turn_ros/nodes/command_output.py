"""Joint commands in the message type the robot's driver listens to."""

from __future__ import annotations

from array import array

import numpy as np
from builtin_interfaces.msg import Duration, Time
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from omega_turn_ros.nodes.joint_message import JointWriter
from omega_turn_ros.nodes.qos import COMMAND

Array = NDArray[np.float64]


class CommandOutput:
    """Publishes commands as JointState, JointTrajectory or Float64MultiArray.

    Topics: `joint_commands`, `joint_trajectory` (for a joint_trajectory_controller) or
    `position_commands` (for a forward_command_controller).

    Args:
        node: the publishing node.
        interface: 'joint_state', 'joint_trajectory' or 'position_array'.
        joint_names: in command order.
        period: time from one command to the next [s]; a trajectory point is due then.
    """

    def __init__(
        self, node: Node, interface: str, joint_names: tuple[str, ...], period: float
    ) -> None:
        self._interface = interface
        self._writer = JointWriter(joint_names)
        if interface == 'joint_trajectory':
            self._publisher = node.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)
            nanoseconds = round(period * 1e9)
            due = Duration(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
            self._point = JointTrajectoryPoint(time_from_start=due)
            self._trajectory = JointTrajectory(joint_names=list(joint_names), points=[self._point])
        elif interface == 'position_array':
            self._publisher = node.create_publisher(
                Float64MultiArray, 'position_commands', COMMAND
            )
        else:
            self._publisher = node.create_publisher(JointState, 'joint_commands', COMMAND)

    def publish(self, stamp: Time, positions: Array, velocities: Array) -> None:
        """Publish one command.

        Args:
            stamp: ROS time of the command.
            positions: [rad], shape (n_joints,).
            velocities: [rad/s], shape (n_joints,).
        """
        if self._interface == 'joint_trajectory':
            self._trajectory.header.stamp = stamp
            self._point.positions = array('d', positions.tobytes())
            self._point.velocities = array('d', velocities.tobytes())
            self._publisher.publish(self._trajectory)
        elif self._interface == 'position_array':
            self._publisher.publish(Float64MultiArray(data=array('d', positions.tobytes())))
        else:
            self._publisher.publish(self._writer.fill(stamp, positions, velocities))
