"""A camera above the physics scene: what is really there, without a window."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError, SimulationError
from omega_turn_sim_bridge.engine import pybullet
from omega_turn_sim_bridge.simulation import Simulation

DISTANCE = 40.0  # camera height in picture sizes: 5 cm of body shift by 0.1 % of a 1 m view
RGBA = 2  # position in the tuple PyBullet returns
LARGEST_SIDE = 4096  # [px], so that a slip of the finger does not ask for gigabytes


def render_from_above(
    simulation: Simulation,
    width: int = 640,
    height: int = 480,
    centre_xy: tuple[float, float] = (0.0, 0.0),
    span: float = 2.0,
) -> NDArray[np.uint8]:
    """Photograph the scene straight down: world x to the right, y up.

    PyBullet's TinyRenderer draws on the CPU, so this works in DIRECT mode and without a display.
    It cannot do orthographic views; a high camera with a narrow lens comes close enough.

    Args:
        simulation: an open simulation.
        width: of the picture [px].
        height: of the picture [px].
        centre_xy: the ground point in the middle of the picture [m].
        span: how much ground the picture's width shows [m].

    Returns:
        Red, green, blue, shape (height, width, 3).

    Raises:
        BadInputError: a size or position that makes no picture.
        SimulationError: the simulation is closed.
    """
    _check(width, height, centre_xy, span)
    if simulation.client < 0:
        raise SimulationError('the simulation is closed')
    x, y = centre_xy
    view_height = span * height / width
    above = DISTANCE * max(span, view_height)
    view = pybullet.computeViewMatrix((x, y, above), (x, y, 0.0), (0.0, 1.0, 0.0))
    projection = pybullet.computeProjectionMatrixFOV(
        fov=math.degrees(2.0 * math.atan2(0.5 * view_height, above)),
        aspect=width / height,
        nearVal=0.5 * above,
        farVal=1.5 * above,
    )
    lens = {'viewMatrix': view, 'projectionMatrix': projection}
    engine = {'renderer': pybullet.ER_TINY_RENDERER, 'physicsClientId': simulation.client}
    pixels = pybullet.getCameraImage(width, height, **lens, **engine)[RGBA]
    # A tuple of ints where PyBullet was built without numpy.
    picture = np.asarray(pixels, np.uint8).reshape(height, width, 4)
    return np.ascontiguousarray(picture[..., :3])


def _check(width: int, height: int, centre_xy: tuple[float, float], span: float) -> None:
    for field, side in (('width', width), ('height', height)):
        if not 1 <= side <= LARGEST_SIDE:
            raise BadInputError(field, side, f'1 to {LARGEST_SIDE} [px]')
    if len(centre_xy) != 2 or not all(math.isfinite(value) for value in centre_xy):
        raise BadInputError('centre_xy', centre_xy, 'finite x, y [m]')
    if not math.isfinite(span) or span <= 0.0:
        raise BadInputError('span', span, 'a finite length > 0 [m]')
