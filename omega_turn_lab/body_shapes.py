"""Shapes of the robot seen from above, for pictures."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_lab.run_record import RunRecord
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.feet import Feet
from omega_turn_ros.robot import LeggedRobot, Robot

Array = NDArray[np.float64]

RAISED = math.radians(2.0)  # lift of a leg beyond which its foot is drawn in the air
ROUND = 13  # corners of each half circle; odd, so that one lies at its tip


def stadiums(
    starts: ArrayLike, ends: ArrayLike, width: float, overhang: tuple[ArrayLike, ArrayLike]
) -> Array:
    """Strips with round ends, as polygons.

    Args:
        starts: one end of each strip's axis [m], shape (..., M, 2).
        ends: the other end [m], shape (..., M, 2).
        width: of the strips [m].
        overhang: how far the tip of each round end reaches past `starts` and past `ends` [m], each
            a number or shape (M,).

    Returns:
        Corners [m], counter-clockwise, shape (..., M, 2 ROUND, 2).
    """
    a, b = np.asarray(starts, float), np.asarray(ends, float)
    axis = (b - a) / np.linalg.norm(b - a, axis=-1, keepdims=True)
    left = np.stack([-axis[..., 1], axis[..., 0]], axis=-1)
    radius = 0.5 * width
    a = a - (np.asarray(overhang[0], float) - radius)[..., None] * axis
    b = b + (np.asarray(overhang[1], float) - radius)[..., None] * axis
    bow = np.linspace(-0.5 * np.pi, 0.5 * np.pi, ROUND)
    c, s = radius * np.cos(bow)[:, None], radius * np.sin(bow)[:, None]
    front = b[..., None, :] + c * axis[..., None, :] + s * left[..., None, :]
    back = a[..., None, :] - c * axis[..., None, :] - s * left[..., None, :]
    return np.concatenate([front, back], axis=-2)


def body_polygons(outline: Array, width: float) -> Array:
    """The body's silhouette as overlapping strips, one per link, round at the joints.

    Args:
        outline: head tip, joints, tail tip [m], shape (..., N + 2, 2).
        width: of the body [m].

    Returns:
        Corners [m], shape (..., N + 1, 2 ROUND, 2).
    """
    reach = np.full(outline.shape[-2], 0.5 * width)
    reach[[0, -1]] = 0.0  # joints are covered, tips are not passed
    first, second = outline[..., :-1, :], outline[..., 1:, :]
    return stadiums(first, second, width, (reach[:-1], reach[1:]))


def module_polygons(outline: Array, robot: Robot) -> Array:
    """The body's modules as rounded strips, head first; pitch joints are taken as straight.

    Args:
        outline: head tip, yaw joints, tail tip [m], shape (N + 2, 2).
        robot: whose modules they are.

    Returns:
        Corners [m], shape (n_joints + 1, 2 ROUND, 2).
    """
    along = np.concatenate([[0.0], np.cumsum(robot.planar_link_lengths)])
    seams = np.concatenate([[0.0], np.cumsum(robot.body_lengths)])
    points = np.stack([np.interp(seams, along, outline[:, k]) for k in (0, 1)], axis=-1)
    gap = -0.03 * robot.module_length
    return stadiums(points[:-1], points[1:], robot.module_width, (gap, gap))


def nice_step(least: float) -> float:
    """Smallest of 1, 2, 5 times a power of ten that is not below `least`."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(power * digit for digit in (1, 2, 5, 10) if power * digit >= least)


def body_outlines(record: RunRecord, robot: Robot) -> Array:
    """Body axes [m], shape (T, N + 2, 2)."""
    columns = np.shape(record.joint_positions)[1]
    if columns != robot.n_joints:
        raise BadInputError('joint_positions', columns, f'{robot.n_joints} joints of {robot.name}')
    yaw = record.joint_positions[:, robot.yaw_indices]
    return PlanarChain.of_robot(robot).outline(yaw, record.pose)


def leg_lines(record: RunRecord, robot: Robot) -> tuple[Array, NDArray[np.bool_]]:
    """Legs from hip to foot [m], shape (T, legs, 2, 2), and which feet are down, (T, legs)."""
    count = len(record.time)
    if not isinstance(robot, LeggedRobot):
        return np.zeros((count, 0, 2, 2)), np.zeros((count, 0), bool)
    feet, q = Feet(robot), np.asarray(record.joint_positions, float)
    lines = np.stack([feet.hips(q), feet.places(q)], axis=-2)
    c, s = np.cos(record.pose[:, 2]), np.sin(record.pose[:, 2])
    turn = np.stack([np.stack([c, s], -1), np.stack([-s, c], -1)], axis=-2)
    lift = q[:, np.array(robot.joint_axes) == 'lift']
    return lines @ turn[:, None] + record.pose[:, None, None, :2], lift < RAISED


def turned_deg(record: RunRecord) -> Array:
    """Heading since the start [deg], shape (T,)."""
    turned: Array = np.degrees(record.pose[:, 2] - record.pose[0, 2])
    return turned


def sampled_at(record: RunRecord, times: Array) -> RunRecord:
    """The record at other times [s], linear in between."""

    def at(table: Array) -> Array:
        columns = np.asarray(table, float).reshape(len(record.time), -1)
        values = [np.interp(times, record.time, column) for column in columns.T]
        return np.stack(values, axis=-1).reshape(len(times), *np.shape(table)[1:])

    return RunRecord(
        times,
        at(record.pose),
        at(record.joint_positions),
        at(record.joint_commands),
        at(record.remaining),
    )
