"""Parameters of the bridge, and the physics settings they describe. No node here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from omega_turn_ros.nodes.parameters import ParameterSpec as Spec
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.terrain_config import TerrainConfig, load_terrain

BRIDGE_PARAMETERS = (
    Spec(
        'robot',
        'limbless16',
        'Robot: a name in config/robots or a path to a .yaml file.',
        read_only=True,
    ),
    Spec(
        'terrain',
        'flat',
        'Ground: a name in config/terrains or a path to a .yaml file.',
        read_only=True,
    ),
    Spec(
        'peg_spacing', 0.0, "Between pegs [BL]; 0: the terrain's.", 'BL', 0.0, 10.0, read_only=True
    ),
    Spec(
        'peg_friction',
        -1.0,
        "Coefficient between body and peg; -1: the terrain's.",
        '',
        -1.0,
        5.0,
        read_only=True,
    ),
    Spec(
        'rock_size', 0.0, "Of rocks, mean [BL]; 0: the terrain's.", 'BL', 0.0, 10.0, read_only=True
    ),
    Spec(
        'resistance_ratio',
        0.0,
        "Of grains, sideways over lengthways; 0: the terrain's.",
        '',
        0.0,
        10.0,
        read_only=True,
    ),
    Spec(
        'real_time_factor', 1.0, 'Simulated over real time; 0 is as fast as it can.', '', 0, 1000
    ),
    Spec(
        'rate', 100.0, 'Sensor readings per simulated second.', 'Hz', 1.0, 1000.0, read_only=True
    ),
    Spec(
        'physics_rate', 200.0, 'Solver steps per simulated second.', 'Hz', 50, 5000, read_only=True
    ),
    Spec('solver_iterations', 20, 'Of the constraint solver.', '', 1, 1000, read_only=True),
    Spec('gui', False, "Show PyBullet's window.", read_only=True),
    Spec(
        'friction',
        0.5,
        'Friction coefficient of the ground; of grains, resistance lengthways over weight.',
        '',
        0.0,
        5.0,
        read_only=True,
    ),
    Spec(
        'static_friction',
        0.0,
        'Of a foot at rest, as on carpet, for robots with legs; 0: as `friction`.',
        '',
        0.0,
        5.0,
        read_only=True,
    ),
    Spec(
        'effort_limit', 0.0, "Largest motor torque; 0: robot's.", 'N m', 0.0, 1e3, read_only=True
    ),
    Spec(
        'pitch_effort_limit',
        0.0,
        'Of pitch motors; weak ones follow uneven ground; 0: as the others.',
        'N m',
        0.0,
        1e3,
        read_only=True,
    ),
    Spec(
        'velocity_limit', 0.0, "Largest motor speed; 0: robot's.", 'rad/s', 0.0, 50, read_only=True
    ),
    Spec('servo_frequency', 5.0, 'Bandwidth of the motors.', 'Hz', 0.5, 100.0, read_only=True),
    Spec('position_noise', 0.0, 'Standard deviation of positions.', 'rad', 0.0, 1, read_only=True),
    Spec('effort_noise', 0.0, 'Standard deviation of efforts.', 'N m', 0.0, 1e3, read_only=True),
    Spec('seed', 0, 'Of the noise and of random terrains.', '', 0, 2**31 - 1, read_only=True),
    Spec('command_timeout', 0.5, 'Commands older than this: posture is held.', 's', 0.0, 60.0),
    Spec('publish_clock', True, 'Publish simulated time on /clock.', read_only=True),
    Spec('start_paused', False, 'Wait for the resume service.', read_only=True),
    Spec('odom_frame', 'odom', 'World frame of odom.', read_only=True),
    Spec('body_frame', 'virtual_chassis', 'Mean body frame of odom.', read_only=True),
    Spec(
        'lock_step',
        False,
        'Step only when the command for the last reading has come: reproducible runs.',
        read_only=True,
    ),
    Spec(
        'lock_step_timeout', 2.0, 'Without a command, lock step goes on after this.', 's', 0.1, 60
    ),
)


def make_config(values: Mapping[str, Any]) -> SimulationConfig:
    """Physics settings the parameters describe.

    Raises:
        BadInputError: the terrain is unknown, or settings contradict each other.
    """
    return SimulationConfig(
        time_step=1.0 / values['physics_rate'],
        solver_iterations=values['solver_iterations'],
        friction=values['friction'],
        static_friction=values['static_friction'],
        effort_limit=values['effort_limit'],
        pitch_effort_limit=values['pitch_effort_limit'],
        velocity_limit=values['velocity_limit'],
        servo_frequency=values['servo_frequency'],
        position_noise=values['position_noise'],
        effort_noise=values['effort_noise'],
        seed=values['seed'],
        terrain=make_terrain(values),
        gui=values['gui'],
    )


def make_terrain(values: Mapping[str, Any]) -> TerrainConfig:
    """Ground the parameters describe: a file, and what departs from it.

    Raises:
        BadInputError: no such file, or a field out of range.
    """
    own = {
        'spacing_bl': values['peg_spacing'] or None,
        'peg_friction': values['peg_friction'] if values['peg_friction'] >= 0.0 else None,
        'rock_size_bl': values['rock_size'] or None,
        'resistance_ratio': values['resistance_ratio'] or None,
    }
    given = {name: value for name, value in own.items() if value is not None}
    return replace(load_terrain(values['terrain']), **given)
