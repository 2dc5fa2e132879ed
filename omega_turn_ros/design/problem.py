"""What a designed gait must achieve: the largest turn per cycle within the limits of a body."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_laws import CoulombFriction, ForceLaw
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.mechanics.self_collision import clear_scale, self_clearance
from omega_turn_ros.robot import Robot

Array = NDArray[np.float64]

SMALLEST_LIMIT = math.radians(1.0)
FINE, FINEST = 480, 20_000  # samples of a cycle in the last search, and where a limit is final
REFINEMENT = 4  # shapes looked at between two samples where the body nearly meets itself


@dataclass(frozen=True)
class DesignProblem:
    """One body on one ground, and the limits its gait must keep.

    Attributes:
        chain: planar links and contact points.
        width: of the links, for self-collision [m].
        theta_max: no joint bends further than this [rad].
        k_f: spatial frequency of the forward wave.
        k_t: spatial frequency of the turning wave.
        law: of the ground.
        samples: shapes per cycle in the search.
    """

    chain: PlanarChain
    width: float
    theta_max: float
    k_f: float = 1.5
    k_t: float = 1.0
    law: ForceLaw = field(default_factory=CoulombFriction)
    samples: int = 48

    def __post_init__(self) -> None:
        """Refuse bodies and limits that cannot turn."""
        if not SMALLEST_LIMIT <= self.theta_max <= math.pi:
            expected = f'an angle in {SMALLEST_LIMIT:.4f}..pi [rad]: less cannot move the body'
            raise BadInputError('theta_max', self.theta_max, expected)
        if not math.isfinite(self.width) or self.width <= 0.0:
            raise BadInputError('width', self.width, 'a finite width > 0 [m]')
        for name in ('k_f', 'k_t'):
            value = getattr(self, name)
            if not 0.0 <= value <= 0.5 * self.chain.n_joints:
                expected = f'0..{0.5 * self.chain.n_joints:g}, half the number of joints'
                raise BadInputError(name, value, expected)
        if self.k_f == 0.0:
            raise BadInputError('k_f', self.k_f, 'above 0: the forward wave must travel')
        if self.samples < 16:
            raise BadInputError('samples', self.samples, 'at least 16')

    @classmethod
    def of_robot(
        cls,
        robot: Robot,
        theta_max: float,
        k_f: float = 1.5,
        k_t: float = 1.0,
        law: ForceLaw | None = None,
    ) -> DesignProblem:
        """Problem of a robot's planar chain.

        Raises:
            BadInputError: the limit exceeds the robot's own, or see the class.
        """
        if theta_max > robot.position_limit + 1e-9:
            expected = f"at most the robot's own {robot.position_limit:.4f} [rad]"
            raise BadInputError('theta_max', theta_max, expected)
        chain = PlanarChain.of_robot(robot)
        ground = law or CoulombFriction()
        return cls(chain, robot.module_width, theta_max, k_f, k_t, ground)

    @cached_property
    def motion(self) -> QuasiStatic:
        """The mechanics of the body on its ground."""
        return QuasiStatic(self.chain, self.law)

    @cached_property
    def phases(self) -> Array:
        """Gait phases of the search, both ends [rad], shape (samples + 1,)."""
        grid: Array = np.linspace(0.0, 2.0 * np.pi, self.samples + 1)
        return grid

    def path(self, gait: WaveGait, samples: int = FINE) -> Array:
        """Closed path of a gait [rad], shape (samples + 1, N)."""
        return gait.angles(np.linspace(0.0, 2.0 * np.pi, samples + 1), self.chain.n_joints)

    def turn(self, path: Array) -> float:
        """Angle per cycle of a closed path [rad], + = counter-clockwise."""
        return self.motion.turn(path)

    def clearance(self, path: Array) -> float:
        """Smallest gap of the body to itself along a path [m], negative where it overlaps."""
        return float(self_clearance(self.chain, self.width, path).min())

    def feasible_factor(self, path: Array, tolerance: float = 1e-4) -> float:
        """Factor that brings a path to its limits.

        To the joint limit, or to less where the body would meet itself on the way.

        Args:
            path: joint angles at any scale, not all zero [rad], shape (T, N).
            tolerance: how far below the largest clear scale it may end, relative.
        """
        factor = self.theta_max / float(np.abs(path).max())
        scaled = factor * path
        return factor * clear_scale(self.chain, self.width, scaled, tolerance, REFINEMENT)

    def fitted(self, gait: WaveGait) -> WaveGait:
        """Scale both amplitudes so that the gait just keeps every limit on a fine grid.

        Raises:
            BadInputError: both amplitudes are zero.
        """
        path = self.path(gait, FINEST)
        if not np.abs(path).max() > 0.0:
            raise BadInputError('gait amplitudes', 0.0, 'not all zero')
        return gait.scaled(self.feasible_factor(path, 1e-7))


@dataclass(frozen=True, slots=True)
class Design:
    """A designed gait and how it was found.

    Attributes:
        gait: turning counter-clockwise, within every limit.
        angle: per cycle [rad].
        clearance: smallest gap of the body to itself [m].
        method: 'direct', 'fourier' or 'hierarchical'.
        evaluations: cycles integrated on the way, all starts.
        starts: how many searches began.
        tops: what was maximised, as the searches ended, best first: the angle [rad] of every
            start; of the direct methods, the value of the runs of the last round.
        reason: why the best start stopped.
    """

    gait: WaveGait
    angle: float
    clearance: float
    method: str
    evaluations: int
    starts: int
    tops: tuple[float, ...]
    reason: str
