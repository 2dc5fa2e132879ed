"""Parameters of the gait node, and the controller they make."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from omega_turn_ros.design.rest import heading_to_rest
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.controller import GaitController
from omega_turn_ros.gaits.controller_state import ControllerConfig
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.nodes.parameters import ParameterSpec as Spec
from omega_turn_ros.robot import Robot

INTERFACES = ('joint_state', 'joint_trajectory', 'position_array')
FEEDBACK = ('none', 'odom')

GAIT_PARAMETERS = (
    Spec(
        'robot',
        'limbless16',
        'Robot: a name in config/robots or a path to a .yaml file.',
        read_only=True,
    ),
    Spec('gait', 'omega', 'Gait: a name in config/gaits or a path; changes between turns only.'),
    Spec('rate', 100.0, 'Commands per second.', 'Hz', 1.0, 1000.0, read_only=True),
    Spec('period', 10.0, 'Duration of one gait cycle.', 's', 0.5, 600.0),
    Spec('heading_feedback', 'none', 'Re-plan after each cycle from odom.', choices=FEEDBACK),
    Spec(
        'heading_tolerance',
        math.radians(1.0),
        'With feedback, a turn ends within this of its goal.',
        'rad',
        1e-3,
        0.5,
    ),
    Spec('max_corrections', 10, 'With feedback, extra cycles per turn.', '', 0, 1000),
    Spec('move_velocity', 1.0, 'Peak joint speed when ramping in and out.', 'rad/s', 0.01, 20.0),
    Spec('phase_ramp_time', 0.5, 'A cycle reaches full rate in this time.', 's', 0.05, 10.0),
    Spec('position_limit', 0.0, "Joint limit, both ways; 0 takes the robot's.", 'rad', 0.0, 3.15),
    Spec('velocity_limit', 0.0, "Joint speed limit; 0 takes the robot's.", 'rad/s', 0.0, 50.0),
    Spec('step_limit', 0.1, 'Largest step between two commands.', 'rad', 1e-4, 1.0),
    Spec('use_compliance', True, 'Let wave_amplitudes change the amplitudes.'),
    Spec('offset_limit', 0.5, 'Largest amplitude offset accepted.', 'rad', 1e-3, 1.5),
    Spec('offset_rate', 1.0, 'Largest rate of amplitude offsets.', 'rad/s', 1e-3, 10.0),
    Spec('state_timeout', 0.5, 'joint_states older than this pause the turn.', 's', 0.02, 60.0),
    Spec(
        'start_timeout',
        30.0,
        'A turn that has had no joint_states after this is dropped.',
        's',
        0.1,
        3600.0,
    ),
    Spec('cmd_vel_timeout', 0.5, 'cmd_vel older than this counts as 0.', 's', 0.02, 60.0),
    Spec('odom_timeout', 0.5, 'odom older than this: heading is predicted.', 's', 0.02, 60.0),
    Spec(
        'amplitude_timeout',
        0.5,
        'wave_amplitudes older than this count as 0.',
        's',
        0.02,
        60.0,
    ),
    Spec(
        'command_interface',
        'joint_state',
        'Message type of the commands.',
        choices=INTERFACES,
        read_only=True,
    ),
    Spec('ignore_unknown_joints', False, 'Accept joint_states with joints of others.'),
    Spec(
        'lock_step',
        False,
        'Step on each joint_states instead of a timer: reproducible runs with the bridge.',
        read_only=True,
    ),
)


def make_controller(values: Mapping[str, Any], robot: Robot) -> GaitController:
    """Build the controller the parameters describe.

    Raises:
        BadInputError: the gait is unknown, or does not fit the robot, its limits, period or rate.
    """
    limits = JointLimits(
        values['position_limit'] or robot.position_limit,
        values['velocity_limit'] or robot.velocity_limit,
        values['step_limit'],
    )
    config = ControllerConfig(
        period=values['period'],
        # Slow enough for the step limit, too: a move that is cut short leaves the body bent.
        move_velocity=min(values['move_velocity'], 0.9 * values['step_limit'] * values['rate']),
        phase_ramp_time=values['phase_ramp_time'],
        heading_feedback=values['heading_feedback'] == 'odom',
        heading_tolerance=values['heading_tolerance'],
        max_corrections=values['max_corrections'],
        offset_limit=values['offset_limit'],
        offset_rate=values['offset_rate'],
    )
    gait = load_gait(values['gait'])
    slowest = 2.0 * math.pi * gait.calibration.peak_rate / values['period'] / values['rate']
    if limits.step < slowest:
        expected = f'at least {slowest:.3g} rad, the gait at {values["rate"]:g} Hz'
        raise BadInputError('parameter step_limit', limits.step, expected)
    return GaitController(robot, gait, config, limits, heading_to_rest(robot, gait.gait))
