"""Bring up gait node, admittance node and, unless it is real, the robot."""

import os

from launch.actions import (
    DeclareLaunchArgument,
    GroupAction,
    LogInfo,
    OpaqueFunction,
    SetEnvironmentVariable,
)
from launch_ros.actions import Node, SetRemap

from launch import LaunchDescription
from omega_turn_ros.nodes.launch_arguments import launch_arguments, read_arguments

PACKAGE = 'omega_turn_ros'
PATIENCE = '30'  # [s] for the gait node and the robot before the first turn is given up


def generate_launch_description() -> LaunchDescription:
    arguments = launch_arguments(os.environ)
    declared = [
        DeclareLaunchArgument(a.name, default_value=a.default, description=a.description)
        for a in arguments
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=_bring_up, args=[arguments])])


def _bring_up(context, arguments) -> list:
    # Before any action: launch would not end the nodes that another's argument has left behind.
    settings = read_arguments(arguments, context.launch_configurations)
    # Each robot has a clock of its own, or two simulators would drive one /clock.
    namespace = settings.namespace
    clock = [SetRemap('/clock', f'/{namespace}/clock')] if namespace else []
    return [*_isolation(settings), GroupAction([*clock, *_nodes(settings)])]


def _isolation(settings) -> list:
    """Keep discovery on this machine and a domain of our own, unless the user chose otherwise."""
    reach = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    domain = str(settings.domain_id)
    return [
        SetEnvironmentVariable('ROS_AUTOMATIC_DISCOVERY_RANGE', reach),
        SetEnvironmentVariable('ROS_DOMAIN_ID', domain),
        LogInfo(
            msg=f'discovery range {reach}, domain {domain}; in other terminals: '
            f'export ROS_DOMAIN_ID={domain} ROS_AUTOMATIC_DISCOVERY_RANGE={reach}'
        ),
    ]


def _nodes(settings) -> list:
    names = ['gait_node']
    if settings.use_sim:
        names.insert(0, 'pybullet_bridge')
    if settings.admittance:
        names.append('admittance_node')
    shared = {'package': PACKAGE, 'namespace': settings.namespace, 'output': 'screen'}
    nodes = [
        Node(
            executable=name,
            # Named, what is given here goes before any pattern of the file, say /**.
            name=name,
            parameters=[str(settings.params_file), *filter(None, [settings.parameters[name]])],
            ros_arguments=['--log-level', settings.log_level],
            on_exit=_end_unless_killed,
            **shared,
        )
        for name in names
    ]
    if settings.turn_deg:
        command = ['turn', f'--deg={settings.turn_deg}', '--timeout', PATIENCE]
        nodes.append(Node(executable='omega_turn', arguments=command, **shared))
    return nodes


def _end_unless_killed(event, context) -> None:
    """End the launch with exit code 1 when a node gave up; the others outlive one killed."""
    if event.returncode > 0 and not context.is_shutdown:
        raise RuntimeError(f'{event.process_name} ended with exit code {event.returncode}')
