"""The admittance node: joint efforts in, amplitude offsets of the two waves out."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from numpy.typing import NDArray
from rclpy.context import Context
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from omega_turn_ros.compliance.admittance import AdmittanceConfig, stored_energy
from omega_turn_ros.compliance.controller import ComplianceConfig, ComplianceController
from omega_turn_ros.compliance.external_torque import TorqueConfig
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.nodes.health import PUBLISH_EVERY, Freshness, Health, steady_clock
from omega_turn_ros.nodes.inbox import Inbox
from omega_turn_ros.nodes.joint_message import JointReader, JointWriter
from omega_turn_ros.nodes.parameters import DECLARE_GIVEN, NodeParameters
from omega_turn_ros.nodes.parameters import ParameterSpec as Spec
from omega_turn_ros.nodes.qos import STATE, STATE_INPUT
from omega_turn_ros.nodes.runner import run_node
from omega_turn_ros.nodes.time import StepTimer, nanoseconds_of, stamp_of
from omega_turn_ros.robot import Robot, load_robot

Array = NDArray[np.float64]

WAVES = ('forward', 'turning')
TARED = 50  # readings at rest in a row whose mean effort a tare takes for zero
AT_REST = 0.05  # [rad/s] joints slower than this rest, for all that noise says
WATCHDOG_PERIOD = 0.05  # [s] between offsets published while efforts are missing

ADMITTANCE_PARAMETERS = (
    Spec(
        'robot',
        'limbless16',
        'Robot: a name in config/robots or a path to a .yaml file.',
        read_only=True,
    ),
    Spec('gait', 'omega', 'Gait whose waves yield: a name in config/gaits or a path.'),
    Spec('mass', [1.0, 1.0], 'M of (forward, turning) wave.', 'N m s^2/rad', 1e-4, 1e6),
    Spec('damping', [8.0, 8.0], 'B of (forward, turning) wave.', 'N m s/rad', 0.0, 1e6),
    Spec('stiffness', [8.0, 8.0], 'K of (forward, turning) wave.', 'N m/rad', 1e-3, 1e8),
    Spec('offset_limit', 0.5, 'Largest amplitude offset.', 'rad', 1e-3, 1.5),
    Spec('rate_limit', 1.0, 'Largest rate of the offsets.', 'rad/s', 1e-3, 10.0),
    Spec(
        'relax_rate', 0.5, 'Offsets return to 0 at this rate without efforts.', 'rad/s', 0.01, 10
    ),
    Spec(
        'torque_scale',
        [-8.0, -8.0],
        'Factors on J tau_ext of (forward, turning) wave: < 0 pushes back, > 0 yields, 0 keeps.',
        '',
        -100.0,
        100.0,
    ),
    Spec('effort_sign', 0, "+1/-1: effort > 0 drives to + / - angles; 0: robot's.", '', -1, 1),
    Spec('friction', 0.5, 'Friction of open ground; its torque is subtracted.', '', 0.0, 5.0),
    Spec('filter_time', 0.1, 'Low-pass time constant of the external torque.', 's', 0.0, 10.0),
    Spec('dead_band', 1.0, 'External torques up to this count as 0.', 'N m', 0.0, 100.0),
    Spec('effort_timeout', 0.2, 'Efforts older than this: offsets relax.', 's', 0.02, 60.0),
    Spec('ignore_unknown_joints', False, 'Accept joint_states with joints of others.'),
    Spec(
        'lock_step',
        False,
        'Wait for wave_phases of the instant before: reproducible runs with the bridge.',
        read_only=True,
    ),
)


def make_compliance(values: Mapping[str, Any], robot: Robot) -> ComplianceController:
    """Build the controller the parameters describe.

    Raises:
        BadInputError: a value or the gait is refused.
    """
    gait = load_gait(values['gait']).waves
    law = AdmittanceConfig(
        tuple(values['mass']),
        tuple(values['damping']),
        tuple(values['stiffness']),
        values['offset_limit'],
        values['rate_limit'],
    )
    torque = TorqueConfig(
        values['effort_sign'] or robot.effort_sign,
        values['friction'],
        values['filter_time'],
        values['dead_band'],
    )
    config = ComplianceConfig(
        gait.k_f, gait.k_t, tuple(values['torque_scale']), values['relax_rate'], law, torque
    )
    return ComplianceController(PlanarChain.of_robot(robot), config)


class AdmittanceNode(Node):
    """Steps the admittance law on each `joint_states`, publishes `wave_amplitudes`.

    Args:
        context: rclpy context; None for the default one.
        options: passed on to `rclpy.node.Node`.

    Raises:
        BadInputError: a parameter is refused.
    """

    def __init__(self, context: Context | None = None, **options: Any) -> None:
        super().__init__('admittance_node', context=context, **DECLARE_GIVEN, **options)
        self._settings = NodeParameters(self, ADMITTANCE_PARAMETERS, self._accept, self._apply)
        self._robot = load_robot(self._settings['robot'])
        self._yaw = self._robot.yaw_indices
        self._health = Health(self)
        self._efforts_seen, self._phases_seen = Freshness(), Freshness()
        self._apply(self._settings.values)
        self._state = self._controller.initial_state()
        self._time = StepTimer(0.025, 0.01)
        self._relax_time = StepTimer(2.0 * WATCHDOG_PERIOD)
        self._phases: tuple[float, float] | None = None
        self._phases_stamp, self._playing = -1, False
        self._answered = -1
        self._relaxing = False
        self._at_rest: deque[Array] = deque(maxlen=TARED)
        self._jumps = 0
        lock_step = self._settings['lock_step']
        qos = STATE if lock_step else STATE_INPUT
        self._lock_step = lock_step
        self._joint_states = Inbox(self, JointState, 'joint_states', qos, self._on_joint_states)
        on_phases = self._on_joint_states if lock_step else None
        self._wave_phases = Inbox(self, JointState, 'wave_phases', qos, on_phases)
        self._amplitudes = self.create_publisher(JointState, 'wave_amplitudes', STATE)
        self._writer = JointWriter(WAVES)
        self.create_service(Trigger, '~/tare', self._on_tare)
        self._pending: JointState | None = None
        steady = steady_clock()
        self.create_timer(WATCHDOG_PERIOD, self._on_watchdog, clock=steady)
        self.create_timer(PUBLISH_EVERY, self._publish_health, clock=steady)
        self._health.ready(f'{self._robot.name}, gait {self._settings["gait"]}')

    def _accept(self, values: Mapping[str, Any]) -> None:
        make_compliance(values, load_robot(values['robot']))

    def _apply(self, values: Mapping[str, Any]) -> None:
        self._controller = make_compliance(values, self._robot)
        self._reader = JointReader(self._robot.joint_names, values['ignore_unknown_joints'])
        self._wave_reader = JointReader(WAVES)
        # In lock step stamps tell what belongs together; the wall clock has no say.
        timeout = 0.0 if values['lock_step'] else values['effort_timeout']
        self._efforts_seen.timeout = self._phases_seen.timeout = timeout

    def _on_joint_states(self) -> None:
        for message in self._joint_states.drain():
            overtaken = self._pending is not None and message.header != self._pending.header
            if overtaken:
                self._phases = None  # the robot goes on without a gait node: wait for none
            self._pending = message
        for message in self._wave_phases.drain():
            try:
                forward, turning = self._wave_reader.read(message, 'position').tolist()
                rates = self._wave_reader.read(message, 'velocity')
            except BadInputError as error:
                self._health.refuse('wave_phases', str(error))
            else:
                self._phases, self._playing = (forward, turning), bool(rates.any())
                self._phases_stamp = nanoseconds_of(message.header.stamp)
                self._phases_seen.mark()
        if self._pending is not None and self._complete(self._pending):
            message, self._pending = self._pending, None
            self._advance(message)

    def _complete(self, message: JointState) -> bool:
        """Whether this instant can be stepped; in lock step the phases before it must be here."""
        if not self._lock_step or self._answered < 0 or self._phases is None:
            return True
        stamp = nanoseconds_of(message.header.stamp)
        return self._answered in (stamp, self._phases_stamp)

    def _advance(self, message: JointState) -> None:
        stamp = nanoseconds_of(message.header.stamp)
        if stamp == self._answered:
            self._publish(message.header.stamp)
            return
        try:
            angles, rates, efforts = (
                self._reader.read(message, field)[self._yaw]
                for field in ('position', 'velocity', 'effort')
            )
        except BadInputError as error:
            self._health.refuse('joint_states', str(error))
            return
        self._answered = stamp
        if not self._efforts_seen.fresh:
            self._at_rest.clear()
        self._efforts_seen.mark()
        if self._relaxing:
            self._relaxing = False
            self.get_logger().info('efforts are back')
        dt = self._time.step(stamp)
        phases = self._phases if self._playing and self._phases_seen.fresh else None
        if phases is not None:
            self._state = self._controller.step(self._state, angles, rates, efforts, phases, dt)
        else:
            self._state = self._controller.relax(self._state, dt)
        self._note_rest(efforts, phases is None and np.abs(rates).max() < AT_REST)
        self._publish(message.header.stamp)

    def _note_rest(self, efforts: Array, resting: bool) -> None:
        if resting and self._time.jumps == self._jumps:
            self._at_rest.append(efforts)
        else:
            self._at_rest.clear()
        self._jumps = self._time.jumps

    def _publish(self, stamp: Time) -> None:
        law = self._state.admittance
        self._amplitudes.publish(
            self._writer.fill(stamp, np.array(law.offset), np.array(law.rate))
        )

    def _on_tare(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        readings = len(self._at_rest) if self._efforts_seen.fresh else 0
        response.success = readings == TARED
        if response.success:
            self._state = self._controller.tare(self._state, np.array(self._at_rest))
            largest = float(np.abs(self._state.zero).max())
            response.message = f'efforts at rest count as 0 now: {largest:.3g} N m at most'
            self.get_logger().info(response.message)
        else:
            response.message = f'{TARED} efforts at rest in a row are needed, not {readings}'
        return response

    def _on_watchdog(self) -> None:
        """While efforts are missing, bring the offsets home on the steady clock."""
        dt = self._relax_time.step(steady_clock().now().nanoseconds)
        if not self._efforts_seen.fresh and any(self._state.admittance.offset):
            self._relaxing = True
            age = self._efforts_seen.age
            self._health.warn('stale', f'no efforts for {age:.1f} s: amplitude offsets relax to 0')
            self._state = self._controller.relax(self._state, dt)
            self._publish(self.get_clock().now().to_msg())

    def _publish_health(self) -> None:
        law, config = self._state.admittance, self._controller.config
        problems = [] if self._efforts_seen.fresh else ['efforts stale']
        if any(math.isclose(abs(d), config.law.offset_limit) for d in law.offset):
            problems.append('amplitude offset at its bound')
        facts = {
            'offset forward, turning [rad]': law.offset,
            'largest tare [N m]': float(np.abs(self._state.zero).max()),
            'largest external torque [N m]': float(np.abs(self._state.external).max()),
            'stored energy [J]': stored_energy(law, config.law),
            'waves playing': self._phases_seen.fresh,
            'clock jumps': self._time.jumps,
        }
        answered = stamp_of(self._answered) if self._lock_step and self._answered >= 0 else None
        self._health.publish(problems, facts, answered)


def main(args: list[str] | None = None) -> int:
    """Run the admittance node until SIGINT or SIGTERM; return the exit code."""
    return run_node(AdmittanceNode, args)
