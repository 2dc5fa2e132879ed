"""What a simulation is told, and what it sees."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_sim_bridge.terrain_config import TerrainConfig

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SimulationConfig:
    """Physics settings.

    Attributes:
        time_step: one solver step [s].
        solver_iterations: of the constraint solver, per step.
        friction: kinetic friction coefficient between feet and ground; of grains, resistance to
            sliding lengthways over the weight.
        static_friction: coefficient of a foot at rest, as on carpet, see `stiction`; 0 is the
            kinetic one. For robots with legs.
        contact_stiffness: of each foot [N/m]. Compliant feet share the weight evenly; rigid
            contact is statically indeterminate and lets friction act at random places.
        contact_damping: of each foot [N s/m].
        effort_limit: largest motor torque [N m]; 0 takes the robot's own.
        pitch_effort_limit: the same of pitch motors; 0 takes `effort_limit`. Weak ones let a robot
            that turns in the plane follow uneven ground.
        velocity_limit: largest motor speed [rad/s]; 0 takes the robot's own.
        servo_frequency: bandwidth of the motors' own position control [Hz].
        position_noise: standard deviation of the joint position readings [rad].
        effort_noise: standard deviation of the effort readings [N m].
        seed: of the noise and of random terrains.
        terrain: the ground and what lies on it.
        gui: show PyBullet's window.
    """

    time_step: float = 1.0 / 200.0
    solver_iterations: int = 20
    friction: float = 0.5
    static_friction: float = 0.0
    contact_stiffness: float = 5e3
    contact_damping: float = 100.0
    effort_limit: float = 0.0
    pitch_effort_limit: float = 0.0
    velocity_limit: float = 0.0
    servo_frequency: float = 5.0
    position_noise: float = 0.0
    effort_noise: float = 0.0
    seed: int = 0
    terrain: TerrainConfig = field(default_factory=TerrainConfig)
    gui: bool = False

    def __post_init__(self) -> None:
        """Refuse settings the engine would accept silently."""
        positive = ('time_step', 'solver_iterations', 'contact_stiffness', 'servo_frequency')
        not_negative = (
            'friction',
            'static_friction',
            'contact_damping',
            'effort_limit',
            'pitch_effort_limit',
            'velocity_limit',
            'position_noise',
            'effort_noise',
        )
        for name in (*positive, *not_negative):
            value = getattr(self, name)
            if not math.isfinite(value) or value < 0 or (name in positive and value == 0):
                expected = 'a finite number > 0' if name in positive else 'a finite number >= 0'
                raise BadInputError(name, value, expected)
        if 0.0 < self.static_friction < self.friction:
            expected = f'0, or at least the kinetic friction {self.friction:g}'
            raise BadInputError('static_friction', self.static_friction, expected)


@dataclass(frozen=True, slots=True)
class Observation:
    """What sensors and the simulator's eye see at one instant.

    Attributes:
        time: simulated time since the start [s], from an integer step count.
        positions: measured joint positions, head to tail [rad], shape (n_joints,).
        velocities: joint velocities [rad/s], shape (n_joints,).
        efforts: torque of each motor on the body behind its joint, + drives the joint towards
            positive angles, mean over the steps since the last observation [N m], shape
            (n_joints,).
        pose: mean body frame in the world: x [m], y [m], heading [rad, continuous], shape (3,).
        twist: its velocity in its own axes [m/s, m/s, rad/s], shape (3,).
        roll: of the mean body frame [rad]: 0 lying as it was put, +-pi upside down; measured on
            uneven ground only.
    """

    time: float
    positions: Array
    velocities: Array
    efforts: Array
    pose: Array
    twist: Array
    roll: float = 0.0
