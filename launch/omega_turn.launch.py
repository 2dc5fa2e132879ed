"""Bring up gait node, admittance node and, unless it is real, the robot."""

import os

from launch.actions import (
    DeclareLaunchArgument,
    ExecuteProcess,
    GroupAction,
    LogInfo,
    OpaqueFunction,
    SetEnvironmentVariable,
)
from launch.conditions import IfCondition
from launch.substitutions import (
    LaunchConfiguration,
    PathJoinSubstitution,
)
from launch_ros.actions import Node, SetRemap
from launch_ros.substitutions import FindPackageShare

from launch import LaunchDescription

PACKAGE = 'omega_turn_ros'
OWN_DOMAIN = '73'

ARGUMENTS = (
    ('namespace', '', 'Namespace of all nodes and topics; two robots share a graph this way.'),
    ('turn_deg', '0.0', 'Turn commanded once everything runs [deg]; 0 waits for turn_angle.'),
    ('use_sim', 'true', 'true: PyBullet stands in for the robot; false: your hardware driver.'),
    ('gui', 'false', "Show PyBullet's window."),
    ('real_time_factor', '1.0', 'Speed of the simulation; 0 is as fast as it can.'),
    ('compliance', 'true', 'Run the admittance node and let the amplitudes yield.'),
    ('heading_feedback', 'odom', 'odom: re-plan after each cycle; none: trust the prediction.'),
    ('log_level', 'info', 'debug, info, warn or error.'),
)


def generate_launch_description() -> LaunchDescription:
    default_params = PathJoinSubstitution([FindPackageShare(PACKAGE), 'config', 'omega_turn.yaml'])
    arguments = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, default, text in ARGUMENTS
    ]
    arguments += [
        DeclareLaunchArgument(
            'params_file', default_value=default_params, description='ROS parameters of all nodes.'
        ),
        DeclareLaunchArgument(
            'use_sim_time',
            default_value=LaunchConfiguration('use_sim'),
            description='Nodes follow /clock; by default exactly when the robot is simulated.',
        ),
        DeclareLaunchArgument(
            'domain_id',
            default_value=os.environ.get('ROS_DOMAIN_ID', OWN_DOMAIN),
            description='DDS domain: ROS_DOMAIN_ID where set, else one of our own.',
        ),
    ]
    return LaunchDescription([*arguments, *_isolation(), OpaqueFunction(function=_bring_up)])


def _isolation() -> list:
    """Keep discovery on this machine and a domain of our own, unless the user chose otherwise."""
    reach = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    domain = LaunchConfiguration('domain_id')
    return [
        SetEnvironmentVariable('ROS_AUTOMATIC_DISCOVERY_RANGE', reach),
        SetEnvironmentVariable('ROS_DOMAIN_ID', domain),
        LogInfo(
            msg=[
                'discovery range ', reach, ', domain ', domain,
                '; in other terminals: export ROS_DOMAIN_ID=', domain,
                ' ROS_AUTOMATIC_DISCOVERY_RANGE=', reach,
            ]
        ),
    ]  # fmt: skip


def _bring_up(context) -> list:
    namespace = LaunchConfiguration('namespace').perform(context).strip('/')
    # Each robot has a clock of its own, or two simulators would drive one /clock.
    clock = [SetRemap('/clock', f'/{namespace}/clock')] if namespace else []
    return [GroupAction([*clock, *_nodes(namespace), *_first_turn(context, namespace)])]


def _nodes(namespace: str) -> list:
    config = LaunchConfiguration
    parameters = [config('params_file'), {'use_sim_time': config('use_sim_time')}]
    shared = {
        'package': PACKAGE,
        'namespace': namespace,
        'output': 'screen',
        'arguments': ['--ros-args', '--log-level', config('log_level')],
    }
    return [
        Node(
            executable='pybullet_bridge',
            condition=IfCondition(config('use_sim')),
            parameters=[
                config('params_file'),
                {'gui': config('gui'), 'real_time_factor': config('real_time_factor')},
            ],
            **shared,
        ),
        Node(
            executable='gait_node',
            parameters=[
                *parameters,
                {
                    'heading_feedback': config('heading_feedback'),
                    'use_compliance': config('compliance'),
                },
            ],
            **shared,
        ),
        Node(
            executable='admittance_node',
            condition=IfCondition(config('compliance')),
            parameters=parameters,
            **shared,
        ),
    ]


def _first_turn(context, namespace: str) -> list:
    degrees = LaunchConfiguration('turn_deg')
    if float(degrees.perform(context)) == 0.0:
        return []
    command = ['ros2', 'run', PACKAGE, 'omega_turn', 'turn', '--deg', degrees]
    if namespace:
        command += ['--namespace', namespace]
    return [ExecuteProcess(cmd=[*command, '--timeout', '30'], output='screen')]
