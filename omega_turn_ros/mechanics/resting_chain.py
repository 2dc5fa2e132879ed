"""A chain bent in three dimensions, at rest on level ground: which feet carry how much.

Where pitch joints lift bodies the load is not spread evenly: the robot settles on its lowest
feet. Each foot is a spring under the belly; the pose of least energy, the weight's and the
springs', gives the loads (own derivation).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError, ConvergenceError
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]

FOOT_STIFFNESS = 5e3  # [N/m] as the simulator's; a straight robot sags by 0.2 mm
FOOT_STANCE = 0.005  # [m] feet alternate left and right of the body axis by this
FOOT_CLEARANCE = 0.001  # [m] of the feet below the belly
GAUSS = 0.5 / math.sqrt(3.0)  # two feet per module load the ground as a uniform line would

NEWTON_STEPS = 200
BALANCED = 1e-6  # force, and torque over body length, left over the weight
LARGEST_TILT, LARGEST_LIFT = 0.1, 0.005  # [rad], [m] of one step
SOFTEST = 1e-5  # of a foot's stiffness: what a step may rely on at least
HALVINGS = 20


@dataclass(frozen=True, slots=True)
class RestingState:
    """Settled postures.

    Attributes:
        feet: places in the mean body frame, z up from the ground [m], shape (B, P, 3); z is below
            0 where a foot is pressed.
        loads: normal forces, their sum the weight [N], shape (B, P).
    """

    feet: Array
    loads: Array


class RestingChain:
    """A robot that lies on its feet, two under each module, whichever joints lift it.

    Args:
        robot: axes, lengths and masses.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        lengths = robot.planar_link_lengths
        self._behind = 1.0 - np.cumsum(lengths)[:-1] / lengths.sum()
        self._mass_fractions = robot.body_masses / robot.body_masses.sum()
        back = np.r_[0.0, -robot.body_lengths[1:]]  # each body's origin is the joint before it
        self._centres = back + 0.5 * robot.body_lengths
        bodies, feet, handed = [], [], 1.0
        for body, (start, span) in enumerate(zip(back, robot.body_lengths)):
            segments = max(1, round(float(span) / robot.module_length))
            for k in range(segments):
                # Neighbouring modules put the front foot on opposite sides, none twice the same.
                handed = 1.0 if (max(body - 1, 0) + k) % 2 == 0 else -1.0
                for end in (1.0, -1.0):
                    x = start + (k + 0.5 + end * GAUSS) * span / segments
                    bodies.append(body)
                    feet.append((x, end * handed * FOOT_STANCE, -self._depth))
        self._body_of_foot, self._feet = np.array(bodies, np.intp), np.array(feet)

    @property
    def _depth(self) -> float:
        """Feet below the body axis [m]."""
        return 0.5 * self.robot.module_width + FOOT_CLEARANCE

    def state(self, angles: ArrayLike) -> RestingState:
        """Let postures settle on level ground.

        Args:
            angles: of all joints [rad], shape (B, n_joints).

        Raises:
            BadInputError: wrong shape, or a value that is not finite.
            ConvergenceError: a posture did not settle, or rolls over.
        """
        q = np.asarray(angles, float)
        if q.ndim != 2 or q.shape[1] != self.robot.n_joints:
            raise BadInputError('angles', q.shape, f'shape (batch, {self.robot.n_joints})')
        if not np.isfinite(q).all():
            raise BadInputError('angles', 'NaN or Inf', 'finite angles [rad]')
        feet, head = self._unsettled(q)
        heading = np.arctan2(head[:, 1], head[:, 0])
        height = -feet[..., 2].min(axis=1)
        open_ = np.arange(q.shape[0])
        for _ in range(NEWTON_STEPS):
            step, left = self._newton_step(feet[open_], height[open_])
            open_, step = open_[left > BALANCED], step[left > BALANCED]
            if open_.size == 0:
                break
            turn, rise = self._descend(feet[open_], height[open_], step)
            feet[open_] = np.einsum('bij,bpj->bpi', turn, feet[open_])
            head[open_] = np.einsum('bij,bj->bi', turn, head[open_])
            height[open_] += rise
        else:
            raise ConvergenceError(f'{open_.size} of {q.shape[0]} postures did not settle')
        if (height < 0.0).any():  # feet alone touch the ground: the rest has sunk through it
            raise ConvergenceError(f'{(height < 0.0).sum()} of {q.shape[0]} postures roll over')
        # Tilting has turned the head a little: back to where the mean body frame has it.
        back = _turn_z(heading - np.arctan2(head[:, 1], head[:, 0]))
        feet = np.einsum('bij,bpj->bpi', back, feet)
        feet[..., 2] += height[:, None]
        return RestingState(feet, -FOOT_STIFFNESS * np.minimum(feet[..., 2], 0.0))

    def _unsettled(self, q: Array) -> tuple[Array, Array]:
        """Feet about the centre of mass with the head level, and the head's direction."""
        robot = self.robot
        batch, count = q.shape[0], robot.n_joints + 1
        rotation = np.zeros((batch, count, 3, 3))
        joint = np.zeros((batch, count, 3))
        rotation[:, 0] = _turn_z(-(q[:, robot.yaw_indices] @ self._behind))
        cos, sin = np.cos(q)[..., None], np.sin(q)[..., None]
        for i, axis in enumerate(robot.joint_axes):
            before, now, c, s = rotation[:, i], rotation[:, i + 1], cos[:, i], sin[:, i]
            x, y, z = before[..., 0], before[..., 1], before[..., 2]
            if axis == 'yaw':
                now[..., 0], now[..., 1], now[..., 2] = c * x + s * y, c * y - s * x, z
            else:
                now[..., 0], now[..., 1], now[..., 2] = c * x - s * z, y, c * z + s * x
            if i:
                joint[:, i + 1] = joint[:, i] - robot.module_length * x
        body = self._body_of_foot
        feet = joint[:, body] + np.einsum('bpij,pj->bpi', rotation[:, body], self._feet)
        centres = joint + self._centres[:, None] * rotation[..., 0]
        feet -= np.einsum('m,bmi->bi', self._mass_fractions, centres)[:, None]
        return feet, rotation[:, 0, :, 0].copy()

    def _energy(self, feet: Array, height: Array) -> Array:
        pressed = np.minimum(feet[..., 2] + height[:, None], 0.0)
        energy: Array = self.robot.weight * height + 0.5 * FOOT_STIFFNESS * (pressed**2).sum(1)
        return energy

    def _newton_step(self, feet: Array, height: Array) -> tuple[Array, Array]:
        """Step (slopes along x and y times body length, height) [m], and the share unbalanced."""
        k, weight, size = FOOT_STIFFNESS, self.robot.weight, self.robot.length
        pressed = np.minimum(feet[..., 2] + height[:, None], 0.0)
        basis = np.concatenate([feet[..., :2] / size, np.ones((*feet.shape[:2], 1))], axis=-1)
        gradient = k * np.einsum('bp,bpi->bi', pressed, basis)
        gradient[:, 2] += weight
        active = np.where(pressed < 0.0, 1.0, 0.0)
        hessian = k * np.einsum('bp,bpi,bpj->bij', active, basis, basis)
        # Feet lie below the centre of mass, so tilting lowers it: the springs must outdo that.
        tipping = -k * (pressed * feet[..., 2]).sum(axis=1) / size**2
        hessian[:, 0, 0] += tipping
        hessian[:, 1, 1] += tipping
        lowest = np.linalg.eigvalsh(hessian)[:, 0]
        hessian += np.maximum(0.0, SOFTEST * k - lowest)[:, None, None] * np.eye(3)
        step = np.linalg.solve(hessian, -gradient[..., None])[..., 0]
        reach = np.array([LARGEST_TILT * size, LARGEST_TILT * size, LARGEST_LIFT])
        step /= np.maximum(np.abs(step / reach).max(axis=1), 1.0)[:, None]
        return step, np.abs(gradient).max(axis=1) / weight

    def _descend(self, feet: Array, height: Array, step: Array) -> tuple[Array, Array]:
        """Rotation and rise of as much of each step as lowers the energy."""
        before, factor = self._energy(feet, height), np.ones(step.shape[0])
        rounding = 1e-13 * self.robot.weight * self.robot.length
        for _ in range(HALVINGS):
            part = factor[:, None] * step
            turn = _tilting(part[:, :2] / self.robot.length)
            lower = np.einsum('bij,bpj->bpi', turn, feet)
            worse = self._energy(lower, height + part[:, 2]) > before + rounding
            if not worse.any():
                break
            factor[worse] *= 0.5
        return turn, part[:, 2]


def _turn_z(angle: Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    turn = np.zeros((angle.size, 3, 3))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1] = c, -s, s, c
    turn[:, 2, 2] = 1.0
    return turn


def _tilting(slope: Array) -> Array:
    """Rotation about a level axis that lifts a point at x, y by slope . (x, y), to first order."""
    size = np.hypot(slope[:, 0], slope[:, 1])
    c, s = 1.0 / np.hypot(1.0, size), size / np.hypot(1.0, size)
    ux, uy = np.divide(slope.T, size, out=np.zeros_like(slope.T), where=size > 0.0)
    turn = np.zeros((size.size, 3, 3))
    turn[:, 0, 0], turn[:, 1, 1] = 1.0 + (c - 1.0) * ux * ux, 1.0 + (c - 1.0) * uy * uy
    turn[:, 0, 1] = turn[:, 1, 0] = (c - 1.0) * ux * uy
    turn[:, 0, 2], turn[:, 1, 2] = -s * ux, -s * uy
    turn[:, 2, 0], turn[:, 2, 1], turn[:, 2, 2] = s * ux, s * uy, c
    return turn
