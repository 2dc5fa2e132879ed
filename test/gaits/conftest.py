"""The shipped robot and gaits, and a controller on a model robot that follows it exactly."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest

from omega_turn_ros.design.calibrate import POINTS_PER_LINK
from omega_turn_ros.gaits.controller import GaitController
from omega_turn_ros.gaits.controller_state import (
    ControllerConfig,
    ControllerState,
    Inputs,
    Mode,
    Output,
)
from omega_turn_ros.gaits.library import LibraryGait, gait_names, load_gait
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.posture import unbend_heading
from omega_turn_ros.mechanics.trajectory import heading_along
from omega_turn_ros.robot import Robot, load_robot


@pytest.fixture(scope='session')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='session')
def chain(robot: Robot) -> PlanarChain:
    """As fine as the one the gaits are calibrated with."""
    return PlanarChain.of_robot(robot, POINTS_PER_LINK)


@pytest.fixture(scope='session', params=gait_names())
def shipped(request: pytest.FixtureRequest) -> LibraryGait:
    """Every gait of the library in turn."""
    return load_gait(request.param)


@pytest.fixture(scope='session')
def omega() -> LibraryGait:
    return load_gait('omega')


@dataclass
class Rig:
    """A controller and a robot that takes every posture commanded.

    The robot's heading advances by `ground` times what the gait's tables predict. Nothing of it
    reaches the controller unless heading feedback is on.
    """

    controller: GaitController
    chain: PlanarChain
    ground: float = 1.0
    dt: float = 0.05
    posture: np.ndarray = field(default_factory=lambda: np.zeros(16))
    heading: float = 3.0  # near the branch cut of the measured heading
    outputs: list[Output] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.state = self.controller.initial_state()

    def ask(self, angle: float) -> None:
        self.state = self.controller.request_turn(self.state, angle)

    def inputs(self, **other: object) -> Inputs:
        """What a healthy robot reports, with fields replaced."""
        measured = math.remainder(self.heading, math.tau)
        return Inputs(**{'positions': self.posture, 'fresh': True, 'heading': measured, **other})

    def step(self, count: int = 1, **inputs: object) -> Output:
        """Advance; keyword arguments replace fields of the inputs."""
        for _ in range(count):
            self.heading += self.ground * self._predicted()
            self.state, output = self.controller.step(
                self.state, self.inputs(**inputs), self.dt
            )
            self.outputs.append(output)
            self.posture = output.positions
        return output

    def finish(self, most_steps: int = 20_000, **inputs: object) -> None:
        """Advance until the turn is over."""
        for _ in range(most_steps):
            if self.state.goal is None and self.state.mode is Mode.HOLDING:
                return
            self.step(**inputs)
        raise AssertionError(f'still {self.state.mode.value} after {most_steps} steps')

    def run_until(self, done: Callable[[ControllerState], bool]) -> None:
        """Advance until the controller's state is as wanted."""
        for _ in range(20_000):
            if done(self.state):
                return
            self.step()
        raise AssertionError('never came to it')

    def commands(self, since: int = 0) -> np.ndarray:
        """All commands from the given step on, shape (T, n_joints)."""
        return np.array([output.positions for output in self.outputs[since:]])

    def balanced_heading(self, since: int = 0) -> float:
        """Heading that ground friction gives the commanded postures, from the force balance."""
        yaw = self.commands(since)[:, self.controller.robot.yaw_indices]
        return float(heading_along(self.chain, yaw)[-1])

    def _predicted(self) -> float:
        """Heading change of the coming step by the tables, without the learned ratio."""
        state = self.state
        blind, _ = self.controller.step(state, self.inputs(heading=None), self.dt)
        change = blind.heading.progress - state.heading.progress
        return change / state.ratio if state.mode is Mode.CYCLING else change


@pytest.fixture(scope='session')
def make_controller(
    robot: Robot, omega: LibraryGait
) -> Callable[..., GaitController]:
    """Make a controller; keyword arguments are fields of its configuration."""
    chain = PlanarChain.of_robot(robot)

    def make(
        gait: LibraryGait = omega, limits: JointLimits | None = None, **config: object
    ) -> GaitController:
        return GaitController(
            robot,
            gait,
            ControllerConfig(**config),
            limits or JointLimits(robot.position_limit, robot.velocity_limit, 0.2),
            lambda posture: unbend_heading(chain, posture),
        )

    return make


@pytest.fixture
def make_rig(
    make_controller: Callable[..., GaitController], chain: PlanarChain
) -> Callable[..., Rig]:
    """Make a rig whose controller has seen the robot; keyword arguments configure it."""

    def make(ground: float = 1.0, posture: np.ndarray | None = None, **config: object) -> Rig:
        rig = Rig(make_controller(**config), chain, ground)
        if posture is not None:
            rig.posture = posture
        rig.step()
        return rig

    return make
