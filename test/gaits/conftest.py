"""The shipped robot and gaits, and controllers for them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from rig import Rig

from omega_turn_ros.design.rest import heading_to_rest
from omega_turn_ros.gaits.controller import GaitController
from omega_turn_ros.gaits.controller_state import ControllerConfig
from omega_turn_ros.gaits.library import LibraryGait, gait_names, load_gait
from omega_turn_ros.gaits.limits import JointLimits
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.robot import Robot, load_robot


@pytest.fixture(scope='session')
def robot() -> Robot:
    return load_robot('limbless16')


@pytest.fixture(scope='session')
def chain(robot: Robot) -> PlanarChain:
    """As fine as the one the gaits are calibrated with."""
    return PlanarChain.of_robot(robot)


TWO_WAVE = [name for name in gait_names() if isinstance(load_gait(name).gait, WaveGait)]


@pytest.fixture(scope='session', params=TWO_WAVE)
def shipped(request: pytest.FixtureRequest) -> LibraryGait:
    """Every two-wave gait of the library in turn."""
    return load_gait(request.param)


@pytest.fixture(scope='session')
def omega() -> LibraryGait:
    return load_gait('omega')


@pytest.fixture(scope='session')
def make_controller(robot: Robot, omega: LibraryGait) -> Callable[..., GaitController]:
    """Make a controller; keyword arguments are fields of its configuration."""

    def make(
        gait: LibraryGait = omega, limits: JointLimits | None = None, **config: object
    ) -> GaitController:
        return GaitController(
            robot,
            gait,
            ControllerConfig(**config),
            limits or JointLimits(robot.position_limit, robot.velocity_limit, 0.2),
            heading_to_rest(robot, gait.gait),
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
