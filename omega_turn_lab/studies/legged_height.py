"""Height function of a robot with legs over (phi, w_3) (Sec. IV.J), and the turn of its paths."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.mechanics.cell_height import CellHeight
from omega_turn_ros.mechanics.height_function import ROTATION
from omega_turn_ros.mechanics.legged import LeggedMotion
from omega_turn_ros.mechanics.local_connection import local_connection

Array = NDArray[np.float64]

CELLS = (120, 25)  # over phi and w_3
REACH = 1.1  # largest w_3 of the grid, over A_3
STEP = 1e-4  # [rad] of the derivative by phi
STEPS = 720  # of a path
# Slopes dw_3/dphi that the linear connection is fitted to: what paths up to A_3 = 20 deg have.
SLOPES = np.linspace(-0.35, 0.35, 5)


@dataclass(frozen=True, slots=True)
class LeggedTurn:
    """Rotation per cycle of one path.

    Attributes:
        surface: by the height function, with what the line w_3 = 0 turns [rad].
        direct: by the nonlinear force balance [rad].
    """

    surface: float
    direct: float


def shapes_at(gait: LeggedGait, phase: Array, offset: Array) -> Array:
    """All joint angles at (phi, w_3) [rad], shapes (...); shape (..., 5 n - 1)."""
    return replace(gait, a_3=1.0, sigma=1.0).angles(phase, offset)


def legged_height(motion: LeggedMotion, gait: LeggedGait) -> CellHeight:
    """Height function of rotation over one period of phi and both signs of w_3."""
    reach = REACH * gait.a_3
    # Edges off the instants at which feet come down and go up, all multiples of 3 deg here.
    phi = 2.0 * np.pi * (np.arange(CELLS[0] + 1) + 0.5) / CELLS[0]
    w = np.linspace(-reach, reach, CELLS[1] + 1)
    middle_w = 0.5 * (w[1:] + w[:-1])
    width = phi[1] - phi[0]
    quarters = (phi[:-1, None] + width * np.array([0.25, 0.75])).ravel()
    along = _connection(motion, gait, quarters, w)[..., 0]
    along = along.reshape(CELLS[0], 2, -1).mean(axis=1)
    across = _connection(motion, gait, phi, middle_w)[..., 1]
    return CellHeight.around(phi, w, along, across)


def path_turn(
    motion: LeggedMotion, gait: LeggedGait, field: CellHeight, scale: float
) -> LeggedTurn:
    """Rotation of the gait's path at a scale of A_3, both ways."""
    phi = 0.5 * (field.first[1:] + field.first[:-1])
    cycle = np.linspace(0.0, 2.0 * np.pi, STEPS + 1)
    walking = motion.turn(gait.angles(cycle, 0.0))
    return LeggedTurn(
        surface=walking - field.surface(scale * gait.offset(phi)),
        direct=motion.turn(gait.angles(cycle, scale)),
    )


def _connection(motion: LeggedMotion, gait: LeggedGait, phi: Array, w: Array) -> Array:
    """Rotation row of the connection on a grid, shape (n, m, 2)."""
    phase, offset = np.meshgrid(phi, w, indexing='ij')
    angles = shapes_at(gait, phase, offset)
    ahead, behind = (shapes_at(gait, phase + step, offset) for step in (STEP, -STEP))
    by_phase = (ahead - behind) / (2.0 * STEP)
    by_offset = shapes_at(gait, phase, offset + 1.0) - angles
    directions = np.stack([np.ones_like(SLOPES), SLOPES], axis=-1)
    directions = np.broadcast_to(directions, (*phase.shape, *directions.shape))
    found = local_connection(motion, angles, np.stack([by_phase, by_offset], axis=-1), directions)
    return found.matrix[..., ROTATION, :]
