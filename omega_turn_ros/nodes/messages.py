"""Checked reading of odom and wave_amplitudes."""

from __future__ import annotations

import math

from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.joint_message import JointReader

ON_BACK = 'on its back: every joint mirrored'  # in diagnostics
JAMMED = 'jammed'  # in diagnostics, while a turn goes on and gets nowhere
STATES_STALE = 'joint_states stale'  # a problem in the gait node's diagnostics


def heading_of(message: Odometry) -> float:
    """Heading of the pose [rad], in -pi..pi.

    Raises:
        BadInputError: the quaternion is not finite or not of unit length.
    """
    q = message.pose.pose.orientation
    norm = math.sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w)
    if not abs(norm - 1.0) < 1e-2:  # also catches NaN
        raise BadInputError('orientation', (q.x, q.y, q.z, q.w), 'a unit quaternion')
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def uprightness_of(message: Odometry) -> float:
    """Cosine of the tilt of a pose that `heading_of` has accepted: 1 level, -1 upside down."""
    q = message.pose.pose.orientation
    return 1.0 - 2.0 * (q.x * q.x + q.y * q.y)


def read_offsets(message: JointState, reader: JointReader, limit: float) -> tuple[float, float]:
    """Amplitude offsets of (forward, turning) [rad].

    Raises:
        BadInputError: names, sizes or values are wrong, or an offset exceeds `limit` [rad].
    """
    forward, turning = (float(v) for v in reader.read(message, 'position'))
    for name, value in (('forward', forward), ('turning', turning)):
        if abs(value) > limit * (1.0 + 1e-9):
            raise BadInputError(f'offset of {name}', value, f'within +-{limit} rad')
    return forward, turning


def text_of_end(goal: float, shortfall: float) -> str:
    """Say how a turn by `goal` [rad] ended that lacks `shortfall` [rad]."""
    side = 'short' if shortfall * goal >= 0.0 else 'too far'
    return f'turn ended, {abs(math.degrees(shortfall)):.1f} deg {side}'


def text_of_request(angle: float) -> str:
    """Say what a `turn_angle` [rad] asks for."""
    return f'turn by {math.degrees(angle):.6g} deg' if angle else 'turn ended on request'
