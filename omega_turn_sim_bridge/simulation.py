"""PyBullet behind four verbs: reset, step, observe, close. Knows no ROS."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError, SimulationError
from omega_turn_ros.robot import STANDARD_GRAVITY, LeggedRobot, Robot
from omega_turn_sim_bridge.body_frame import mean_roll, projected_heading
from omega_turn_sim_bridge.client import open_client
from omega_turn_sim_bridge.engine import pybullet
from omega_turn_sim_bridge.granular import GranularGround
from omega_turn_sim_bridge.legged import legged_urdf
from omega_turn_sim_bridge.robot import ride_height, urdf_from_robot
from omega_turn_sim_bridge.simulation_config import Observation, SimulationConfig
from omega_turn_sim_bridge.stiction import Stiction
from omega_turn_sim_bridge.terrain import build_ground

Array = NDArray[np.float64]

# Positions in the tuples PyBullet returns.
JOINT_POSITION, JOINT_VELOCITY, JOINT_MOTOR_TORQUE = 0, 1, 3
LINK_COM_POSITION, LINK_COM_TURN, LINK_COM_VELOCITY = 0, 1, 6
CONTACT_BODY_B, CONTACT_DISTANCE = 2, 8

BULLET_DAMPING = 0.1  # [N s/m] what a body has that was given none
OBSTACLE_STIFFNESS = 4e4  # [N/m] a jam presses a peg 5 mm into the body; at 5e3 it was 29 mm

LOWERING = 2.0  # [s] uncounted, in which the robot comes to rest on uneven ground


class Simulation:
    """One robot on one ground in its own physics client.

    Args:
        robot: the robot.
        config: physics settings.
    """

    def __init__(self, robot: Robot, config: SimulationConfig | None = None) -> None:
        self.robot = robot
        self.config = config or SimulationConfig()
        self._client = open_client(self.config.gui, robot.length)
        self._effort_limit = self.config.effort_limit or robot.effort_limit
        self._velocity_limit = self.config.velocity_limit or robot.velocity_limit
        self._joints = list(range(robot.n_joints))
        self._yaw = robot.yaw_indices
        self._mass_fractions = robot.body_masses / robot.body_masses.sum()
        legged = isinstance(robot, LeggedRobot)
        self._bodies = self._yaw.tolist() if legged else self._joints  # of the mean body frame
        self._behind = self._fraction_behind_joints()
        self._steps = 0
        try:
            self._build()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Simulation:
        """Return the simulation itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the physics client."""
        self.close()

    @property
    def time(self) -> float:
        """Simulated time since the start [s]; a reset does not turn it back."""
        return self._steps * self.config.time_step

    @property
    def client(self) -> int:
        """PyBullet's id of this physics client."""
        return self._client

    @property
    def terrain_bodies(self) -> tuple[int, ...]:
        """PyBullet's ids of what makes the ground, the level ground first."""
        return self._ground.bodies

    @property
    def body(self) -> int:
        """PyBullet's id of the robot."""
        return self._body

    def reset(self) -> None:
        """Put the robot back: straight along x, mean body frame at the origin, at rest.

        Raises:
            SimulationError: the client has been closed.
        """
        self._check_open()
        front = self.robot.length * 0.5 - self.robot.head_length
        above = self._ground.top + self._ride_height()
        position = (front, 0.0, above)
        pybullet.resetBasePositionAndOrientation(
            self._body, self._base_frame(position), (0, 0, 0, 1), physicsClientId=self._client
        )
        pybullet.resetBaseVelocity(self._body, (0, 0, 0), (0, 0, 0), physicsClientId=self._client)
        for joint in self._joints:
            pybullet.resetJointState(self._body, joint, 0.0, 0.0, physicsClientId=self._client)
        self._reference = np.zeros(self.robot.n_joints)
        self._reference_rate = np.zeros(self.robot.n_joints)
        self._target = np.zeros(self.robot.n_joints)
        self._base_yaw = 0.0
        self._effort_sum = np.zeros(self.robot.n_joints)
        self._effort_steps = 0
        self._observed = False
        self._rng = np.random.default_rng(self.config.seed)
        if self._ground.top > 0.0:
            self._lower()

    def _lower(self) -> None:
        """Let the straight robot sink onto uneven ground, until it lies still."""
        for _ in range(round(LOWERING / self.config.time_step)):
            self._drive(np.zeros(self.robot.n_joints))
            pybullet.stepSimulation(physicsClientId=self._client)

    def command(self, positions: ArrayLike) -> None:
        """Set the motor targets, held until the next call.

        Args:
            positions: joint angles, head to tail [rad], shape (n_joints,).

        Raises:
            BadInputError: wrong shape, or a value that is not finite.
        """
        target = np.asarray(positions, float)
        if target.shape != (self.robot.n_joints,):
            raise BadInputError('positions', target.shape, f'shape ({self.robot.n_joints},)')
        if not np.isfinite(target).all():
            raise BadInputError('positions', target.tolist(), 'finite angles [rad]')
        limit = self.robot.position_limit
        self._target = np.clip(target, -limit, limit)

    def step(self, count: int = 1) -> None:
        """Advance the physics by `count` solver steps.

        Raises:
            SimulationError: the client has been closed.
        """
        self._check_open()
        if self._observed:
            self._effort_sum, self._effort_steps = np.zeros(self.robot.n_joints), 0
            self._observed = False
        dt, omega = self.config.time_step, 2.0 * math.pi * self.config.servo_frequency
        for _ in range(count):
            # Critically damped, implicit: a servo smooths late and bunched commands, which would
            # otherwise jerk the body out of quasi-static motion.
            pull = dt * omega * omega * (self._target - self._reference)
            rate = (self._reference_rate + pull) / (1.0 + dt * omega) ** 2
            rate = np.clip(rate, -self._velocity_limit, self._velocity_limit)
            self._reference += dt * rate
            self._reference_rate = rate
            self._drive(rate)
            if self._grains is not None:
                self._grains.push(self._client, self._body)
            if self._stiction is not None:
                self._stiction.update()
            pybullet.stepSimulation(physicsClientId=self._client)
            self._steps += 1
            # Commands come in stairs, so torques ripple in step with them: a reading that looked
            # at the last step only would be off by the same amount every time.
            self._effort_sum += [s[JOINT_MOTOR_TORQUE] for s in self._joint_states()]
            self._effort_steps += 1

    def observe(self) -> Observation:
        """Read joints and mean body frame.

        Raises:
            SimulationError: the client has been closed, or the physics has left the realm of
                finite numbers.
        """
        self._check_open()
        states = self._joint_states()
        table = np.array([(s[JOINT_POSITION], s[JOINT_VELOCITY]) for s in states])
        positions, velocities = table.T
        efforts = self._effort_sum / max(self._effort_steps, 1)
        self._observed = True
        pose, twist, roll = self._mean_body_frame(positions, velocities)
        if not all(np.isfinite(a).all() for a in (table, efforts, pose)):
            raise SimulationError(f'not finite at t = {self.time:.3f} s: the scene has exploded')
        if self.config.position_noise:
            positions = positions + self._rng.normal(
                0.0, self.config.position_noise, positions.shape
            )
        if self.config.effort_noise:
            efforts = efforts + self._rng.normal(0.0, self.config.effort_noise, efforts.shape)
        return Observation(self.time, positions, velocities, efforts, pose, twist, roll)

    def obstacle_depth(self) -> float:
        """How deep the robot presses into obstacles or into itself, at most [m].

        Contact is compliant: a millimetre or two is its give, half a body a robot that passes
        through what should stop it.

        Raises:
            SimulationError: the client has been closed.
        """
        self._check_open()
        level = self._ground.bodies[0]
        contacts = pybullet.getContactPoints(self._body, physicsClientId=self._client)
        depths = [-c[CONTACT_DISTANCE] for c in contacts if c[CONTACT_BODY_B] != level]
        return max(0.0, *depths) if depths else 0.0

    def hold_posture(self) -> None:
        """Make the present posture the motor target.

        Raises:
            SimulationError: the client has been closed.
        """
        self._check_open()
        self.command([s[JOINT_POSITION] for s in self._joint_states()])

    def close(self) -> None:
        """Disconnect the physics client; further calls do nothing."""
        if self._client >= 0:
            pybullet.disconnect(physicsClientId=self._client)
            self._client = -1

    def _drive(self, rate: Array) -> None:
        """Give the motors their reference for the coming step, moving at `rate` [rad/s]."""
        pybullet.setJointMotorControlArray(
            self._body,
            self._joints,
            pybullet.POSITION_CONTROL,
            targetPositions=self._reference.tolist(),
            targetVelocities=rate.tolist(),
            forces=self._forces,
            positionGains=self._position_gains,
            velocityGains=self._velocity_gains,
            physicsClientId=self._client,
        )

    def _joint_states(self) -> list[tuple]:
        states: list[tuple] = pybullet.getJointStates(
            self._body, self._joints, physicsClientId=self._client
        )
        return states

    def _check_open(self) -> None:
        if self._client < 0:
            raise SimulationError('the simulation is closed')

    def _build(self) -> None:
        client, config = self._client, self.config
        pybullet.setGravity(0, 0, -STANDARD_GRAVITY, physicsClientId=client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=config.time_step,
            numSolverIterations=config.solver_iterations,
            enableConeFriction=1,
            deterministicOverlappingPairs=1,
            physicsClientId=client,
        )
        self._ground = build_ground(
            client, config.terrain, self.robot, config.friction, config.seed
        )
        self._grains: GranularGround | None = None
        if self._ground.grains is not None:
            grains = self._ground.grains
            self._grains = GranularGround(self.robot, grains, config.friction, config.time_step)
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        if self._ground.solid:
            # What an obstacle bends beyond the gait must not pass through itself.
            flags |= pybullet.URDF_USE_SELF_COLLISION
            flags |= pybullet.URDF_USE_SELF_COLLISION_EXCLUDE_PARENT
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f'{self.robot.name}.urdf'
            path.write_text(self._urdf())
            self._body = pybullet.loadURDF(str(path), flags=flags, physicsClientId=client)
        stiffness = self._body_stiffness()
        for link in range(-1, self.robot.n_joints):
            pybullet.changeDynamics(
                self._body,
                link,
                lateralFriction=0.0 if self._grains else config.friction,
                contactStiffness=stiffness,
                contactDamping=config.contact_damping,
                linearDamping=0.0,
                angularDamping=0.0,
                jointDamping=0.0,
                physicsClientId=client,
            )
        self._stiction = self._carpet()
        pitch = config.pitch_effort_limit or self._effort_limit
        self._forces = [
            pitch if axis == 'pitch' else self._effort_limit for axis in self.robot.joint_axes
        ]
        self._position_gains = [0.3] * self.robot.n_joints
        self._velocity_gains = [1.0] * self.robot.n_joints
        self.reset()

    def _urdf(self) -> str:
        if not isinstance(self.robot, LeggedRobot):
            return urdf_from_robot(self.robot, solid=self._ground.solid)
        kind = self.config.terrain.kind
        if kind != 'flat':
            raise BadInputError('terrain', kind, 'flat for a robot with legs')
        return legged_urdf(self.robot)

    def _carpet(self) -> Stiction | None:
        """What makes feet stick harder than they slide, if anything does."""
        kinetic, static = self.config.friction, self.config.static_friction
        if static <= kinetic:
            return None
        if not isinstance(self.robot, LeggedRobot):
            raise BadInputError('static_friction', static, 'a robot with legs')
        return Stiction(self._client, self._body, self.robot, (kinetic, static))

    def _ride_height(self) -> float:
        """Height of the body axis above the ground at rest [m]."""
        if isinstance(self.robot, LeggedRobot):
            return self.robot.legs.height
        return ride_height(self.robot)

    def _body_stiffness(self) -> float:
        """Contact stiffness of the robot's bodies [N/m]; what carries it makes up for the rest.

        Bullet puts the stiffnesses of two bodies in series. On open ground all the give is the
        feet's. Among obstacles a foot's give would let the motors press pegs half into the body,
        so there the body is stiff and the ground soft.
        """
        soft = self.config.contact_stiffness
        if not self._ground.solid:
            return soft
        stiff = max(OBSTACLE_STIFFNESS, 2.0 * soft)
        for body in self._ground.carriers:
            pybullet.changeDynamics(
                body,
                -1,
                contactStiffness=1.0 / (1.0 / soft - 1.0 / stiff),
                contactDamping=BULLET_DAMPING,
                physicsClientId=self._client,
            )
        return stiff

    def _base_frame(self, link_frame: tuple[float, float, float]) -> tuple[float, float, float]:
        """Position of the base's centre of mass, which PyBullet's base calls speak of."""
        x, y, z = link_frame
        return x + 0.5 * self.robot.head_length, y, z

    def _fraction_behind_joints(self) -> Array:
        """Share of the body length behind each yaw joint: d(mean link angle)/d(joint angle)."""
        lengths = self.robot.planar_link_lengths
        return 1.0 - np.cumsum(lengths)[:-1] / lengths.sum()

    def _mean_body_frame(self, positions: Array, velocities: Array) -> tuple[Array, Array, float]:
        client = self._client
        base, (qx, qy, qz, qw) = pybullet.getBasePositionAndOrientation(
            self._body, physicsClientId=client
        )
        base_velocity, base_rate = pybullet.getBaseVelocity(self._body, physicsClientId=client)
        links = pybullet.getLinkStates(
            self._body, self._bodies, computeLinkVelocity=1, physicsClientId=client
        )
        bend = float(self._behind @ positions[self._yaw])
        roll = 0.0
        if self._ground.top > 0.0:
            turns = np.array([(qx, qy, qz, qw)] + [s[LINK_COM_TURN] for s in links])
            yaw = projected_heading(turns, self._mass_fractions) - bend
            roll = mean_roll(turns, self._mass_fractions)
        else:
            yaw = math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
        self._base_yaw += math.remainder(yaw - self._base_yaw, math.tau)
        heading = self._base_yaw + bend
        # Seen from above, yaw joints of a body on its back turn the other way.
        rate = base_rate[2] + math.cos(roll) * float(self._behind @ velocities[self._yaw])
        centres = np.array([base] + [s[LINK_COM_POSITION] for s in links])
        rates = np.array([base_velocity] + [s[LINK_COM_VELOCITY] for s in links])
        x, y, _ = self._mass_fractions @ centres
        vx, vy, _ = self._mass_fractions @ rates
        c, s = math.cos(heading), math.sin(heading)
        twist = np.array([c * vx + s * vy, c * vy - s * vx, rate])
        return np.array([x, y, heading]), twist, roll
