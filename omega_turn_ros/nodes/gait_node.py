"""The gait node: a turn angle in, joint commands of the two-wave template out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.controller_state import ControllerState, Inputs, Mode, Output
from omega_turn_ros.gaits.drive import Drive
from omega_turn_ros.nodes.command_output import CommandOutput
from omega_turn_ros.nodes.gait_parameters import GAIT_PARAMETERS, make_controller
from omega_turn_ros.nodes.health import PUBLISH_EVERY, Freshness, Health, steady_clock
from omega_turn_ros.nodes.inbox import Inbox
from omega_turn_ros.nodes.joint_message import JointReader, JointWriter
from omega_turn_ros.nodes.messages import (
    JAMMED,
    ON_BACK,
    STATES_STALE,
    heading_of,
    read_offsets,
    text_of_end,
    text_of_request,
    uprightness_of,
)
from omega_turn_ros.nodes.pacing import answer_now
from omega_turn_ros.nodes.parameters import DECLARE_GIVEN, NodeParameters
from omega_turn_ros.nodes.qos import COMMAND, REMAINING, REQUEST, STATE, STATE_INPUT
from omega_turn_ros.nodes.raw_joint_states import RawStateReader
from omega_turn_ros.nodes.runner import run_node
from omega_turn_ros.nodes.time import StepTimer, nanoseconds_of
from omega_turn_ros.robot import load_robot

WAVES = ('forward', 'turning')
REMAINING_EVERY = 10  # commands between two turn_remaining


class GaitNode(Node):
    """Takes `turn_angle`, publishes `joint_commands`, `wave_phases` and `turn_remaining`.

    Args:
        context: rclpy context; None for the default one.
        paced: whoever made the node calls `tick` each `tick_period`, where it has one.
        options: passed on to `rclpy.node.Node`.

    Attributes:
        tick_period: [s]; None where messages, /clock (`use_sim_time` at start) or a timer drive.

    Raises:
        BadInputError: a parameter is refused.
    """

    def __init__(
        self, context: Context | None = None, paced: bool = False, **options: Any
    ) -> None:
        super().__init__('gait_node', context=context, **DECLARE_GIVEN, **options)
        self._state = ControllerState()
        self._settings = NodeParameters(self, GAIT_PARAMETERS, self._accept, self._apply)
        self._robot = load_robot(self._settings['robot'])
        self._health = Health(self)
        self._states_seen, self._odom_seen, self._amplitudes_seen = (Freshness() for _ in range(3))
        self._asked, self._driven = Freshness(), Freshness()
        self._unread: tuple[Inbox[Any], ...] = ()
        self._apply(self._settings.values)
        self._period = 1.0 / self._settings['rate']
        self._time = StepTimer(2.5 * self._period, self._period)
        self._inputs = Inputs()
        self._heading: float | None = None
        self._answered = -1
        self._absent: set[str] = set()
        self._last_stamp = Time()
        self._output: Output | None = None
        self._reported: float | None = None
        self._ticks = 0
        self._make_topics()
        self.create_timer(PUBLISH_EVERY, self._publish_health, clock=steady_clock())
        driven = self._lock_step or self.get_parameter('use_sim_time').value
        self.tick_period = self._period if paced and not driven else None
        if not self._lock_step and self.tick_period is None:
            self.create_timer(self._period, self.tick)
        self._report_remaining()
        gait, feedback = self._controller.gait.name, self._settings['heading_feedback']
        self._health.ready(f'{self._robot.name}, gait {gait}, heading feedback {feedback}')

    @property
    def cycles_done(self) -> int:
        """Cycles completed in the present or last turn."""
        return int(self._state.cycles)

    def _make_topics(self) -> None:
        self._lock_step = self._settings['lock_step']
        on_question = self._on_question if self._lock_step else None
        on_state = self._on_lock_step if self._lock_step else None
        on_request = self._read_requests if self._lock_step else None
        state_qos = STATE if self._lock_step else STATE_INPUT
        self._turn_angle = Inbox(self, Float64, 'turn_angle', REQUEST, on_request)
        self._cmd_vel = Inbox(self, Twist, 'cmd_vel', REQUEST)
        self._joint_states: Inbox[Any] = Inbox(
            self, JointState, 'joint_states', state_qos, on_question, raw=True
        )
        self._odom = Inbox(self, Odometry, 'odom', state_qos, on_state)
        self._amplitudes = Inbox(self, JointState, 'wave_amplitudes', state_qos, on_state)
        self._unread = (self._odom, self._amplitudes)  # where they are not used
        self._stamps = {'joint_states': -1, 'odom': -1, 'wave_amplitudes': -1}
        self._commands = CommandOutput(
            self, self._settings['command_interface'], self._robot.joint_names, self._period
        )
        self._phases = self.create_publisher(JointState, 'wave_phases', COMMAND)
        self._phase_writer = JointWriter(WAVES)
        self._remaining = self.create_publisher(Float64, 'turn_remaining', REMAINING)
        self._stop = self.create_service(Trigger, '~/stop', self._on_stop)
        self.create_service(Trigger, '~/reset', self._on_reset)

    def _accept(self, values: Mapping[str, Any]) -> None:
        limit = make_controller(values, load_robot(values['robot'])).limits.position
        reached = 0.0 if self._state.command is None else np.abs(self._state.command).max()
        if reached > limit:
            expected = f'at least {reached:.4g} rad, where the robot is'
            raise BadInputError('parameter position_limit', limit, expected)
        if self._state.goal is not None and values['gait'] != self._settings['gait']:
            raise BadInputError('parameter gait', values['gait'], 'no change during a turn')

    def _apply(self, values: Mapping[str, Any]) -> None:
        self._controller = make_controller(values, self._robot)
        gait = self._controller.gait
        self._compliant = values['use_compliance'] and gait.gait.complies
        self._uses_odom = values['heading_feedback'] == 'odom'
        for inbox in self._unread:
            inbox.drain()  # what waits there may be old
        if gait.robot != self._robot.name:
            text = f'gait {gait.name} is calibrated for robot {gait.robot}, not this one'
            self._health.warn('gait', f'{text}: predicted angles are off')
        reader = JointReader(self._robot.joint_names, values['ignore_unknown_joints'])
        self._joint_reader = RawStateReader(reader)
        self._wave_reader = JointReader(WAVES)
        for seen, timeout in (
            (self._states_seen, 'state_timeout'),
            (self._odom_seen, 'odom_timeout'),
            (self._driven, 'cmd_vel_timeout'),
            (self._amplitudes_seen, 'amplitude_timeout'),
        ):
            # In lock step stamps tell what belongs together; the wall clock has no say.
            seen.timeout = 0.0 if values['lock_step'] else values[timeout]

    def tick(self) -> None:
        """Read what has come, take one step and publish the command."""
        now = self.get_clock().now()
        answer_now(self._stop)
        self._read_requests()
        self._read_drive()
        self._read_inputs()
        self._advance(self._time.step(now.nanoseconds), now.to_msg())

    def _on_question(self) -> None:
        """A reading is the robot's question: answer it, and again when it asks again."""
        answered = self._answered
        self._on_lock_step()
        if self._stamps['joint_states'] == answered:
            self._publish_output(self._last_stamp)

    def _on_lock_step(self) -> None:
        """Step once every input of one instant has arrived."""
        asked = self._stamps['joint_states']
        missing = self._missing()
        self._read_inputs()
        stamp = self._stamps['joint_states']
        if asked not in (stamp, self._answered):
            self._absent |= missing  # the robot went on unanswered: wait for these no more
        if stamp == self._answered or self._missing() - self._absent:
            return
        self._answered = stamp
        self._read_drive()
        self._advance(self._time.step(stamp), self._last_stamp)

    def _missing(self) -> set[str]:
        """Inputs of the present instant that are still to come."""
        needed = {'odom'} if self._uses_odom else set()
        if self._compliant:
            needed.add('wave_amplitudes')
        return {n for n in needed if self._stamps[n] != self._stamps['joint_states']}

    def _read_requests(self) -> None:
        for message in self._turn_angle.drain():
            try:
                self._state = self._controller.request_turn(self._state, message.data)
            except BadInputError as error:
                self._health.refuse('turn_angle', str(error))
            else:
                self._asked.mark()
                self._health.note(f'turn {message.data == 0.0}', text_of_request(message.data))
                self._report_remaining()

    def _read_drive(self) -> None:
        for message in self._cmd_vel.drain():
            try:
                drive = Drive(message.linear.x, message.angular.z)
                self._state = self._controller.request_drive(self._state, drive)
            except BadInputError as error:
                self._health.refuse('cmd_vel', str(error))
            else:
                self._driven.mark()
                if drive.linear > 0.0 and not self._controller.gait.advance:
                    name = self._controller.gait.name
                    self._health.warn('speed', f'gait {name} only turns: linear.x is left out')
        if not self._driven.fresh and self._state.drive != Drive():
            self._state = self._controller.request_drive(self._state, Drive())
            self._health.warn('cmd_vel', 'no cmd_vel: the robot holds where it is')

    def _read_inputs(self) -> None:
        positions, heading, offsets = self._inputs.positions, self._heading, self._inputs.offsets
        effort, upright = self._inputs.effort, self._inputs.upright
        for data in self._joint_states.drain():
            try:
                reading = self._joint_reader.read(data)
            except BadInputError as error:
                self._health.refuse('joint_states', str(error))
            else:
                positions, effort = reading.positions, reading.effort
                self._stamps['joint_states'] = reading.seconds * 10**9 + reading.nanoseconds
                if self._lock_step:
                    self._last_stamp = Time(sec=reading.seconds, nanosec=reading.nanoseconds)
                self._states_seen.mark()
        for message in self._odom.drain() if self._uses_odom else ():
            try:
                heading, upright = heading_of(message), uprightness_of(message)
            except BadInputError as error:
                self._health.refuse('odom', str(error))
            else:
                self._stamps['odom'] = nanoseconds_of(message.header.stamp)
                self._absent.discard('odom')
                self._odom_seen.mark()
        for message in self._amplitudes.drain() if self._compliant else ():
            try:
                offsets = read_offsets(
                    message, self._wave_reader, self._controller.config.offset_limit
                )
            except BadInputError as error:
                self._health.refuse('wave_amplitudes', str(error))
            else:
                self._stamps['wave_amplitudes'] = nanoseconds_of(message.header.stamp)
                self._absent.discard('wave_amplitudes')
                self._amplitudes_seen.mark()
        self._heading = heading
        heard = self._amplitudes_seen.fresh and 'wave_amplitudes' not in self._absent
        compliant = self._compliant and heard
        self._inputs = Inputs(
            positions,
            self._states_seen.fresh,
            heading,
            offsets if compliant else (0.0, 0.0),
            effort,
            upright if self._uses_odom else 1.0,
        )

    def _advance(self, dt: float, stamp: Time) -> None:
        goal = self._state.goal
        self._state, self._output = self._controller.step(self._state, self._inputs, dt)
        self._heading = None  # a measurement counts once; until the next one the model predicts
        self._publish_output(stamp)
        self._ticks += 1
        if goal is not None and self._state.goal is None:
            self._say_ended(goal, self._state.shortfall)
        elif self._ticks % REMAINING_EVERY == 0:
            self._report_remaining()

    def _publish_output(self, stamp: Time) -> None:
        output = self._output
        if output is None:
            return
        # Phases first: in lock step the admittance node must have them before the next states.
        if self._phases.get_subscription_count() > 0:
            phases = np.array([output.phase_forward, output.phase_turning])
            rates = np.array([output.phase_rate, output.phase_rate])
            self._phases.publish(self._phase_writer.fill(stamp, phases, rates))
        self._commands.publish(stamp, output.positions, output.velocities)

    def _say_ended(self, goal: float, shortfall: float) -> None:
        self._remaining.publish(Float64(data=shortfall))  # a client judges the turn by it
        self._report_remaining()
        self.get_logger().info(text_of_end(goal, shortfall))

    def _report_remaining(self) -> None:
        remaining = self._state.remaining
        if remaining != self._reported:
            self._reported = remaining
            self._remaining.publish(Float64(data=remaining))

    def _on_stop(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._report_remaining()  # what the stop leaves
        self._state = self._controller.stop(self._state)
        self._report_remaining()
        self.get_logger().warning('stopped; commands are refused until reset')
        response.success, response.message = True, 'stopped: posture held until reset'
        return response

    def _on_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._state = self._controller.reset(self._state)
        response.success, response.message = True, f'{self._state.mode.value}: ready for a turn'
        return response

    def _drop_unstarted(self) -> None:
        """Drop a turn without any joint_states for too long, or it would start unexpectedly."""
        limit = self._settings['start_timeout']
        if self._state.goal is None or not limit < self._asked.age < self._states_seen.age:
            return
        self._state = self._controller.reset(self._controller.stop(self._state))
        self._health.refuse('turn_angle', f'no good joint_states within {limit:g} s')
        self._report_remaining()

    def _publish_health(self) -> None:
        self._drop_unstarted()
        state, values = self._state, self._settings.values
        problems = []
        if state.mode is Mode.STOPPED:
            problems.append('stopped: call reset')
        if not self._states_seen.fresh:
            problems.append(STATES_STALE)
            if state.goal is not None:
                self._health.warn('stale', 'no joint_states: the turn waits')
        if values['heading_feedback'] == 'odom' and not self._odom_seen.fresh:
            problems.append('odom stale: heading predicted')
            if state.goal is not None:
                self._health.warn('odom', 'no odom: heading is predicted')
        if state.upright < 0.0:
            problems.append(ON_BACK)
        if state.jam.jammed and state.goal is not None:
            problems.append(JAMMED)
            self._health.warn(
                'jam', f'{JAMMED}: the last cycle got nowhere, with motors straining'
            )
        if abs(state.shortfall) > 2.0 * values['heading_tolerance']:
            problems.append('last turn ended short')
        facts = {
            'mode': state.mode.value,
            'remaining [rad]': state.remaining,
            'progress [rad]': state.heading.progress,
            'cycles': state.cycles,
            'scale': state.scale,
            'ground ratio': state.ground.usual,
            'shortfall [rad]': state.shortfall,
            'drive [m/s, rad/s]': (state.drive.linear, state.drive.angular),
            'commands limited': state.limited,
            'cycles in a jam': state.jam.cycles,
            'heading jumps left out': state.heading.jumps,
            'clock jumps': self._time.jumps,
            'amplitude offsets [rad]': state.offsets,
        }
        self._health.publish(problems, facts, self._last_stamp if self._lock_step else None)


def main(args: list[str] | None = None) -> int:
    """Run the gait node until SIGINT or SIGTERM; return the exit code."""
    return run_node(lambda: GaitNode(paced=True), args)
