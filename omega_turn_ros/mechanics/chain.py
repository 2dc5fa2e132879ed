"""Kinematics of a planar chain of rigid links, seen from its mean body frame.

Mean body frame ('virtual chassis'): origin at the length-weighted mean of the link centres, x axis
along the length-weighted mean of the link angles. That mean is linear in the joint angles, so it
never flips, and two equal shapes compare exactly. Link x axes point from tail to head; joint i
turns the links behind it, + = counter-clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]

# Of a robot's link: twice as many move no angle of the shipped gaits by more than 0.2 degrees.
POINTS_PER_LINK = 8


@dataclass(frozen=True, slots=True)
class ShapeState:
    """Contact points of a chain and their velocities due to shape change alone.

    Attributes:
        points: positions in the mean body frame [m], shape (..., P, 2).
        velocities: time derivatives of `points` in the mean body frame [m/s], shape (..., P, 2).
        link_angles: angles of the link axes in the mean body frame [rad], shape (..., L).
        joints: positions of the joints in the mean body frame [m], shape (..., L - 1, 2).
    """

    points: Array
    velocities: Array
    link_angles: Array
    joints: Array


class PlanarChain:
    """N + 1 rigid links joined by N yaw joints, resting on `points_per_link` points each.

    The points of a link are Gauss-Legendre nodes carrying the matching share of its load, so two
    points already have the mean and the second moment of a uniformly loaded line.

    Args:
        link_lengths: [m], head first, shape (L,), L >= 2.
        weight: total normal force [N].
        points_per_link: contact points along each link.
        loads: share of the weight on each link, any unit, shape (L,); in proportion to length if
            not given.
        width: of the contact patch [m]; 0 is a line.
        points_across: rows of contact points over the width.

    Raises:
        BadInputError: fewer than two links, or a length, load, weight or count that is not
            positive.
    """

    def __init__(
        self,
        link_lengths: ArrayLike,
        weight: float = 1.0,
        points_per_link: int = POINTS_PER_LINK,
        *,
        loads: ArrayLike | None = None,
        width: float = 0.0,
        points_across: int = 1,
    ):
        lengths = np.array(link_lengths, float)
        if lengths.ndim != 1 or lengths.size < 2:
            raise BadInputError('link_lengths', lengths.shape, 'at least two lengths [m]')
        if not np.all(np.isfinite(lengths) & (lengths > 0.0)):
            raise BadInputError('link_lengths', lengths.tolist(), 'finite lengths > 0 [m]')
        if not np.isfinite(weight) or weight <= 0.0:
            raise BadInputError('weight', weight, 'a finite weight > 0 [N]')
        if not np.isfinite(width) or width < 0.0:
            raise BadInputError('width', width, 'a finite width >= 0 [m]')
        for field, count in (
            ('points_per_link', points_per_link),
            ('points_across', points_across),
        ):
            if count < 1:
                raise BadInputError(field, count, 'at least 1')
        shares = lengths if loads is None else np.array(loads, float)
        if shares.shape != lengths.shape or not np.all(np.isfinite(shares) & (shares > 0.0)):
            raise BadInputError('loads', shares.tolist(), f'{lengths.size} finite loads > 0')
        along, along_share = np.polynomial.legendre.leggauss(points_per_link)
        across, across_share = np.polynomial.legendre.leggauss(points_across)
        along, across = (grid.ravel() for grid in np.meshgrid(along, across, indexing='ij'))
        point_share = 0.25 * np.outer(along_share, across_share).ravel()
        self.lengths = lengths
        self.fractions = lengths / lengths.sum()
        self.link_of_point = np.repeat(np.arange(lengths.size), along.size)
        self.point_offsets = (0.5 * lengths[:, None] * along).ravel()
        self.point_sides = np.tile(0.5 * width * across, lengths.size)
        self.normal_forces = (weight * (shares / shares.sum())[:, None] * point_share).ravel()

    @classmethod
    def of_robot(cls, robot: Robot, points_per_link: int = POINTS_PER_LINK) -> PlanarChain:
        """Chain of the robot's planar links, pitch joints straight, with the robot's weight."""
        return cls(robot.planar_link_lengths, robot.weight, points_per_link)

    @property
    def n_joints(self) -> int:
        """N, the number of yaw joints."""
        return self.lengths.size - 1

    def link_angles(self, angles: ArrayLike) -> Array:
        """Link angles in the mean body frame [rad], shape (..., L), from joint angles (..., N)."""
        joint_angles = np.asarray(angles, float)
        absolute = np.zeros((*joint_angles.shape[:-1], self.lengths.size))
        np.cumsum(joint_angles, axis=-1, out=absolute[..., 1:])
        return absolute - (absolute @ self.fractions)[..., None]

    def state(self, angles: ArrayLike, rates: ArrayLike) -> ShapeState:
        """Contact points and their shape velocities.

        Args:
            angles: yaw joint angles [rad], shape (..., N).
            rates: their time derivatives [rad/s], shape (..., N).
        """
        alpha = self.link_angles(angles)
        alpha_rate = self.link_angles(rates)
        tangent = np.stack([np.cos(alpha), np.sin(alpha)], axis=-1)
        normal = np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)
        tangent_rate = alpha_rate[..., None] * normal
        centres, joints = self._centres(tangent)
        centre_rates, _ = self._centres(tangent_rate)
        normal_rate = -alpha_rate[..., None] * tangent
        link, along = self.link_of_point, self.point_offsets[:, None]
        left = self.point_sides[:, None]
        place = along * tangent[..., link, :] + left * normal[..., link, :]
        place_rate = along * tangent_rate[..., link, :] + left * normal_rate[..., link, :]
        return ShapeState(
            centres[..., link, :] + place,
            centre_rates[..., link, :] + place_rate,
            alpha,
            joints,
        )

    def _centres(self, directions: Array) -> tuple[Array, Array]:
        """Link centres and joints about the mean of the centres, for tangents or their rates."""
        spans = self.lengths[:, None] * directions
        tails = -np.cumsum(spans, axis=-2)
        centres = tails + 0.5 * spans
        mean = np.einsum('l,...lx->...x', self.fractions, centres)[..., None, :]
        return centres - mean, tails[..., :-1, :] - mean

    def outline(self, angles: ArrayLike, pose: ArrayLike) -> Array:
        """Head tip, joints and tail tip in the world.

        Args:
            angles: yaw joint angles [rad], shape (..., N).
            pose: mean body frame in the world, x [m], y [m], heading [rad], shape (..., 3).

        Returns:
            Points along the body axis [m], shape (..., N + 2, 2).
        """
        alpha = self.link_angles(angles)
        tangent = np.stack([np.cos(alpha), np.sin(alpha)], axis=-1)
        _, joints = self._centres(tangent)
        head = joints[..., :1, :] + self.lengths[0] * tangent[..., :1, :]
        tail = joints[..., -1:, :] - self.lengths[-1] * tangent[..., -1:, :]
        local = np.concatenate([head, joints, tail], axis=-2)
        x, y, heading = np.moveaxis(np.asarray(pose, float), -1, 0)
        c, s = np.cos(heading)[..., None], np.sin(heading)[..., None]
        return np.stack(
            [
                x[..., None] + c * local[..., 0] - s * local[..., 1],
                y[..., None] + s * local[..., 0] + c * local[..., 1],
            ],
            axis=-1,
        )
