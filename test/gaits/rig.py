"""A turning controller on a model robot that takes every posture commanded."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from omega_turn_ros.gaits.controller import GaitController
from omega_turn_ros.gaits.controller_state import ControllerState, Inputs, Mode, Output
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.trajectory import heading_along


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
            self.state, output = self.controller.step(self.state, self.inputs(**inputs), self.dt)
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
        return change / state.ground.ratio if state.mode is Mode.CYCLING else change
