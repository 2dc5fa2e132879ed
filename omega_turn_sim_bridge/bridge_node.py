"""The PyBullet bridge: the robot's topics, served by physics instead of hardware."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.health import PUBLISH_EVERY, Freshness, Health, steady_clock
from omega_turn_ros.nodes.inbox import Inbox
from omega_turn_ros.nodes.joint_message import JointReader, JointWriter
from omega_turn_ros.nodes.parameters import DECLARE_GIVEN, NodeParameters
from omega_turn_ros.nodes.qos import COMMAND, STATE
from omega_turn_ros.nodes.runner import run_node
from omega_turn_ros.nodes.time import nanoseconds_of, stamp_of
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.body_frame import orientation_of
from omega_turn_sim_bridge.bridge_parameters import BRIDGE_PARAMETERS, make_config
from omega_turn_sim_bridge.simulation import Simulation
from omega_turn_sim_bridge.simulation_config import Observation

IDLE_PERIOD = 0.0005  # [s] between steps when running as fast as possible
ASK_AGAIN = 0.2  # [s] wall time after which lock step repeats its question


class PyBulletBridge(Node):
    """Takes `joint_commands`; publishes `joint_states`, `odom` and `/clock`.

    Args:
        context: rclpy context; None for the default one.
        options: passed on to `rclpy.node.Node`.

    Raises:
        BadInputError: a parameter is refused.
    """

    def __init__(self, context: Context | None = None, **options: Any) -> None:
        super().__init__('pybullet_bridge', context=context, **DECLARE_GIVEN, **options)
        self._settings = NodeParameters(self, BRIDGE_PARAMETERS, self._accept, self._apply)
        values = self._settings
        self._robot = load_robot(values['robot'])
        self._health = Health(self)
        self._command_seen = Freshness(values['command_timeout'])
        self._simulation = Simulation(self._robot, make_config(values.values))
        self._steps_per_reading = round(values['physics_rate'] / values['rate'])
        self._reading_period = self._steps_per_reading / values['physics_rate']
        self._start_time = self._start_nanoseconds()
        self._paused = values['start_paused']
        self._holding = False
        self._waited = 0.0
        self._asked = -1
        self._make_topics()
        self._observation = self._simulation.observe()
        self._steady = steady_clock()
        self._timer = self.create_timer(self._wall_period(), self._on_timer, clock=self._steady)
        self.create_timer(PUBLISH_EVERY, self._publish_health, clock=self._steady)
        self._wall = self._steady.now().nanoseconds
        self._rate_from = (self._wall, self._simulation.time)
        self._publish()
        self._health.ready(f'{self._robot.name}, terrain {values["terrain"]}')

    @property
    def simulation(self) -> Simulation:
        """The physics behind the topics."""
        return self._simulation

    def destroy_node(self) -> None:
        """Close the physics with the node."""
        self._simulation.close()
        super().destroy_node()

    def _start_nanoseconds(self) -> int:
        """Stamps count from 0 where the bridge is the clock, else from now."""
        if self._settings['publish_clock']:
            return 0
        return int(self.get_clock().now().nanoseconds)

    def _make_topics(self) -> None:
        names = self._robot.joint_names
        self._reader = JointReader(names)
        on_command = self._on_command if self._settings['lock_step'] else None
        self._commands = Inbox(self, JointState, 'joint_commands', COMMAND, on_command)
        self._states = self.create_publisher(JointState, 'joint_states', STATE)
        self._writer = JointWriter(names, self._settings['body_frame'])
        self._odom = self.create_publisher(Odometry, 'odom', STATE)
        self._odometry = Odometry(child_frame_id=self._settings['body_frame'])
        self._odometry.header.frame_id = self._settings['odom_frame']
        self._clock_publisher = None
        if self._settings['publish_clock']:
            self._clock_publisher = self.create_publisher(Clock, '/clock', STATE)
        self.create_service(Trigger, '~/reset', self._on_reset)
        self.create_service(Trigger, '~/pause', self._on_pause)
        self.create_service(Trigger, '~/resume', self._on_resume)

    def _accept(self, values: Mapping[str, Any]) -> None:
        ratio = values['physics_rate'] / values['rate']
        if abs(ratio - round(ratio)) > 1e-9 or ratio < 1.0:
            expected = f'a multiple of rate = {values["rate"]:g} Hz'
            raise BadInputError('parameter physics_rate', values['physics_rate'], expected)
        make_config(values)

    def _apply(self, values: Mapping[str, Any]) -> None:
        self._command_seen.timeout = values['command_timeout']
        self._timer.timer_period_ns = round(self._wall_period() * 1e9)

    def _wall_period(self) -> float:
        factor = self._settings['real_time_factor']
        if self._settings['lock_step']:
            return ASK_AGAIN
        return self._reading_period / factor if factor else IDLE_PERIOD

    def _on_timer(self) -> None:
        if self._paused:
            return
        if not self._settings['lock_step']:
            self._read_commands()
            self._step()
            return
        self._waited += ASK_AGAIN
        if self._waited < self._settings['lock_step_timeout']:
            self._publish()
            return
        self._health.warn('lock_step', 'lock step: no command for this reading, going on')
        self._step()

    def _on_command(self) -> None:
        if self._read_commands() and not self._paused:
            self._step()

    def _read_commands(self) -> bool:
        """Take over the newest command; tell whether it answers the last reading."""
        answered = False
        for message in self._commands.drain():
            try:
                positions = self._reader.read(message, 'position')
            except BadInputError as error:
                self._health.refuse('joint_commands', str(error))
                continue
            self._simulation.command(positions)
            self._command_seen.mark()
            self._holding = False
            answered = nanoseconds_of(message.header.stamp) == self._asked
        return answered

    def _step(self) -> None:
        if not self._command_seen.fresh and not self._holding:
            self._simulation.hold_posture()
            self._holding = True
        self._simulation.step(self._steps_per_reading)
        self._observation = self._simulation.observe()
        self._waited = 0.0
        self._publish()

    def _publish(self) -> None:
        seen = self._observation
        self._asked = self._start_time + round(seen.time * 1e9)
        stamp = stamp_of(self._asked)
        if self._clock_publisher is not None:
            self._clock_publisher.publish(Clock(clock=stamp))
        self._fill_odometry(seen)
        self._odometry.header.stamp = stamp
        self._odom.publish(self._odometry)
        # In the robot's own effort convention, as a driver would report it.
        efforts = self._robot.effort_sign * seen.efforts
        self._states.publish(self._writer.fill(stamp, seen.positions, seen.velocities, efforts))

    def _fill_odometry(self, seen: Observation) -> None:
        pose, twist = self._odometry.pose.pose, self._odometry.twist.twist
        x, y, heading = (float(v) for v in seen.pose)
        pose.position.x, pose.position.y = x, y
        o = pose.orientation
        o.x, o.y, o.z, o.w = orientation_of(heading, seen.roll)
        vx, vy, turn = (float(v) for v in seen.twist)
        c, s = math.cos(seen.roll), math.sin(seen.roll)
        twist.linear.x, twist.linear.y, twist.linear.z = vx, c * vy, -s * vy
        twist.angular.y, twist.angular.z = s * turn, c * turn  # in the rolled child frame

    def _on_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._simulation.reset()
        self._observation = self._simulation.observe()
        response.success, response.message = True, 'robot straight at the origin'
        return response

    def _on_pause(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._paused = True
        response.success, response.message = True, f'paused at {self._simulation.time:.3f} s'
        return response

    def _on_resume(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._paused = False
        self._publish()
        response.success, response.message = True, f'running from {self._simulation.time:.3f} s'
        return response

    def _publish_health(self) -> None:
        wall, simulated = self._steady.now().nanoseconds, self._simulation.time
        elapsed = max((wall - self._rate_from[0]) * 1e-9, 1e-9)
        factor = (simulated - self._rate_from[1]) / elapsed
        self._rate_from = (wall, simulated)
        problems = [] if self._command_seen.fresh else ['no commands: posture held']
        if self._paused:
            problems.append('paused')
        facts = {
            'simulated time [s]': simulated,
            'real time factor': factor,
            'heading [rad]': float(self._observation.pose[2]),
            'largest effort [N m]': float(np.abs(self._observation.efforts).max()),
        }
        self._health.publish(problems, facts, stamp_of(self._asked))


def main(args: list[str] | None = None) -> int:
    """Run the bridge until SIGINT or SIGTERM; return the exit code."""
    return run_node(PyBulletBridge, args)
