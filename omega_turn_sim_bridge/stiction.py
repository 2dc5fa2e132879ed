"""Feet that stick harder than they slide, as on carpet. Bullet itself knows one coefficient.

    mu(v) = mu_k + (mu_s - mu_k) exp(-(v/v_s)^2)

(the static part of the law of R. Stribeck, 1902, as used for friction compensation), with v the
slip of the foot in the step before.
"""

from __future__ import annotations

import math

from omega_turn_ros.robot import LeggedRobot
from omega_turn_sim_bridge.engine import pybullet
from omega_turn_sim_bridge.legged import SOLE_RADIUS, foot_links

STRIBECK_SPEED = 0.01  # [m/s] v_s: fibres let go over about a millimetre
# Positions in the tuple PyBullet returns for a link.
FRAME_POSITION, FRAME_TURN, VELOCITY, SPIN, COM = 4, 5, 6, 7, 0


class Stiction:
    """Sets the friction of each foot by its slip.

    Args:
        client: PyBullet's physics client.
        body: PyBullet's id of the robot.
        robot: the robot.
        friction: (mu_k, mu_s).
    """

    def __init__(
        self, client: int, body: int, robot: LeggedRobot, friction: tuple[float, float]
    ) -> None:
        self._client, self._body = client, body
        self._links = foot_links(robot)
        down = SOLE_RADIUS - robot.legs.height
        self._soles = [
            ((1.0 if i % 2 == 0 else -1.0) * robot.legs.reach, down)
            for i in range(len(self._links))
        ]
        self._kinetic, self._static = friction

    def coefficient(self, slip: float) -> float:
        """Friction coefficient of a foot that slips so fast [m/s]."""
        extra = (self._static - self._kinetic) * math.exp(-((slip / STRIBECK_SPEED) ** 2))
        return self._kinetic + extra

    def slips(self) -> list[float]:
        """Horizontal speed of each foot where it touches level ground [m/s], in robot order."""
        states = pybullet.getLinkStates(
            self._body, self._links, computeLinkVelocity=1, physicsClientId=self._client
        )
        return [_speed(state, *sole) for state, sole in zip(states, self._soles)]

    def update(self) -> None:
        """Set the coefficients for the coming step."""
        for link, slip in zip(self._links, self.slips()):
            pybullet.changeDynamics(
                self._body,
                link,
                lateralFriction=self.coefficient(slip),
                physicsClientId=self._client,
            )


def _speed(state: tuple, out: float, down: float) -> float:
    """Horizontal speed of a sole at (0, out, down) in the frame of its link [m/s]."""
    turn = pybullet.getMatrixFromQuaternion(state[FRAME_TURN])
    place = [
        state[FRAME_POSITION][k] + turn[3 * k + 1] * out + turn[3 * k + 2] * down for k in range(3)
    ]
    x, y, z = (p - c for p, c in zip(place, state[COM]))
    z -= SOLE_RADIUS
    vx, vy, _ = state[VELOCITY]
    wx, wy, wz = state[SPIN]
    return math.hypot(vx + wy * z - wz * y, vy + wz * x - wx * z)
