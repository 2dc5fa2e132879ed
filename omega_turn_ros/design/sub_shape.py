"""The three planes in which the paper looks at a two-wave gait (eq:sub_shape_space).

A gait is a closed path in m = [A_f, tau_f, A_o, tau_o]. With two of its functions f_1: tau_f ->
A_f, f_2: tau_o -> A_o and f_3: tau_f -> tau_o held, the third is a path in a plane r = (r_1, r_2):

    'turning'  (tau_o, A_o), a cylinder, path A_o = f_2(tau_o)
    'forward'  (tau_f, A_f), a cylinder, path A_f = f_1(tau_f)
    'phase'    (tau_f, tau_o), a torus, path tau_o = tau_f + psi

The index o of the paper's planes is the index t, turning, of its template.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from omega_turn_ros.design.problem import DesignProblem
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.two_wave import two_wave_angles
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.mechanics.height_function import ConnectionField
from omega_turn_ros.mechanics.local_connection import local_connection
from omega_turn_ros.mechanics.self_collision import self_clearance
from omega_turn_ros.mechanics.shape_grid import ShapeAxis

Array = NDArray[np.float64]
Plane = Literal['turning', 'forward', 'phase']
BISECTIONS = 8
PLANES: tuple[Plane, ...] = ('turning', 'forward', 'phase')


@dataclass(frozen=True, slots=True)
class Feasibility:
    """How far each shape of a grid is from the limits.

    Attributes:
        bend: largest joint angle over the joint limit [-], shape (...); above 1 is infeasible.
        clearance: gap of the body to itself [m], shape (...); below 0 is infeasible.
    """

    bend: Array
    clearance: Array

    @property
    def over_limit(self) -> NDArray[np.bool_]:
        """Where a joint exceeds its limit, shape (...)."""
        result: NDArray[np.bool_] = self.bend > 1.0 + 1e-9
        return result

    @property
    def collides(self) -> NDArray[np.bool_]:
        """Where the body overlaps itself, shape (...)."""
        result: NDArray[np.bool_] = self.clearance < 0.0
        return result

    @property
    def infeasible(self) -> NDArray[np.bool_]:
        """Where either limit is broken, shape (...)."""
        return self.over_limit | self.collides


@dataclass(frozen=True, slots=True)
class SubShape:
    """One plane of shapes around a gait.

    Attributes:
        problem: body, ground and limits.
        gait: whose other two functions are held.
        plane: 'turning', 'forward' or 'phase'.
    """

    problem: DesignProblem
    gait: TwoWaveGait
    plane: Plane

    def __post_init__(self) -> None:
        """Refuse a plane that is not one of the three."""
        if self.plane not in PLANES:
            raise BadInputError('plane', self.plane, f'one of {PLANES}')

    def embed(self, r: ArrayLike) -> tuple[Array, Array]:
        """Place points of the plane in the space of all two-wave shapes.

        Args:
            r: points of the plane [rad, rad], shape (..., 2).

        Returns:
            m = [A_f, tau_f, A_o, tau_o] [rad], shape (..., 4), and dm/dr, shape (..., 4, 2).
        """
        first, second = np.moveaxis(np.asarray(r, float), -1, 0)
        gait, one, zero = self.gait, np.ones_like(first), np.zeros_like(first)
        if self.plane == 'turning':
            forward, slope = _amplitude(gait.a_f, gait.gamma, first - gait.psi + gait.phi_f)
            m = (forward, first - gait.psi, second, first)
            derivative = ((slope, zero), (one, zero), (zero, one), (one, zero))
        elif self.plane == 'forward':
            turning, slope = _amplitude(gait.a_o, 1.0, first + gait.psi + gait.phi_o)
            m = (second, first, turning, first + gait.psi)
            derivative = ((zero, one), (one, zero), (slope, zero), (one, zero))
        else:
            forward, slope_f = _amplitude(gait.a_f, gait.gamma, first + gait.phi_f)
            turning, slope_o = _amplitude(gait.a_o, 1.0, second + gait.phi_o)
            m = (forward, first, turning, second)
            derivative = ((slope_f, zero), (one, zero), (zero, slope_o), (zero, one))
        rows = [np.stack(row, axis=-1) for row in derivative]
        return np.stack(m, axis=-1), np.stack(rows, axis=-2)

    def shapes(self, r: ArrayLike) -> tuple[Array, Array]:
        """Joint angles and their derivatives.

        Args:
            r: points of the plane [rad, rad], shape (..., 2).

        Returns:
            theta [rad], shape (..., N), and d theta / d r, shape (..., N, 2).
        """
        m, derivative = self.embed(r)
        forward, phase_f, turning, phase_o = np.moveaxis(m, -1, 0)
        n, k_f, k_t = self.problem.chain.n_joints, self.gait.k_f, self.gait.k_t
        quarter = 0.5 * np.pi

        def waves(a_f: ArrayLike, lead_f: float, a_o: ArrayLike, lead_o: float) -> Array:
            return two_wave_angles(a_f, phase_f + lead_f, a_o, phase_o + lead_o, k_f, k_t, n)

        by_m = (
            waves(1.0, 0.0, 0.0, 0.0),
            waves(forward, quarter, 0.0, 0.0),
            waves(0.0, 0.0, 1.0, 0.0),
            waves(0.0, 0.0, turning, quarter),
        )
        return waves(forward, 0.0, turning, 0.0), np.stack(by_m, axis=-1) @ derivative

    def path(self, samples: int = 720) -> Array:
        """Path of the gait in the plane, unwrapped, from r_1 = 0 to 2 pi.

        Args:
            samples: steps of the path.

        Returns:
            Points [rad, rad], shape (samples + 1, 2).
        """
        first = np.linspace(0.0, 2.0 * np.pi, samples + 1)
        return np.stack([first, self.function(first)], axis=-1)

    def function(self, first: ArrayLike) -> Array:
        """The gait's own function of this plane: f_2, f_1 or tau_o of tau_f [rad], any shape."""
        tau, gait = np.asarray(first, float), self.gait
        if self.plane == 'turning':
            return _amplitude(gait.a_o, 1.0, tau + gait.phi_o)[0]
        if self.plane == 'forward':
            return _amplitude(gait.a_f, gait.gamma, tau + gait.phi_f)[0]
        return tau + gait.psi

    def axes(self, points: int, reach: float) -> tuple[ShapeAxis, ShapeAxis]:
        """Grid of the plane.

        Args:
            points: along each axis.
            reach: largest amplitude of the grid, both ways [rad]; a torus has none.
        """
        first = ShapeAxis.phase(points)
        if self.plane == 'phase':
            return first, first
        return first, ShapeAxis(np.linspace(-reach, reach, points))

    def field(
        self, points: int = 64, reach: float | None = None, spread: float | None = None
    ) -> ConnectionField:
        """Local connection on a grid of the plane.

        Args:
            points: along each axis.
            reach: largest amplitude of the grid [rad], 1.5 times the joint limit if not given.
            spread: fit to paths whose slope dr_2/dr_1 is the gait's own plus and minus this; to
                all directions if not given.

        Raises:
            ConvergenceError: the force balance of a shape was not solved.
        """
        axes = self.axes(points, 1.5 * self.problem.theta_max if reach is None else reach)
        directions = None if spread is None else self._directions(axes[0].values, spread)
        fit = local_connection(self.problem.motion, *self.shapes(grid(axes)), directions)
        return ConnectionField(axes, fit.matrix, fit.misfit)

    def _directions(self, first: Array, spread: float) -> Array:
        """Directions (1, slope of the gait -+ spread) over r_1, shape (n_1, 1, 2, 2)."""
        gait = self.gait
        if self.plane == 'turning':
            slope = _amplitude(gait.a_o, 1.0, first + gait.phi_o)[1]
        elif self.plane == 'forward':
            slope = _amplitude(gait.a_f, gait.gamma, first + gait.phi_f)[1]
        else:
            slope = np.ones_like(first)
        slopes = slope[:, None, None] + spread * np.array([-1.0, 1.0])
        return np.stack([np.ones_like(slopes), slopes], axis=-1)

    def feasibility(self, r: ArrayLike) -> Feasibility:
        """Distance from both limits at points of the plane [rad, rad], shape (..., 2)."""
        theta, _ = self.shapes(r)
        bend = np.abs(theta).max(axis=-1) / self.problem.theta_max
        return Feasibility(bend, self_clearance(self.problem.chain, self.problem.width, theta))

    def allowed_scale(self, r: ArrayLike) -> Array:
        """Largest factor up to 1 by which a shape keeps both limits, points (..., 2) -> (...)."""
        problem = self.problem
        theta, _ = self.shapes(r)
        flat = theta.reshape(-1, theta.shape[-1])
        scale = np.minimum(1.0, problem.theta_max / np.maximum(np.abs(flat).max(axis=1), 1e-12))
        shrunk = scale[:, None] * flat
        (open_,) = np.nonzero(self_clearance(problem.chain, problem.width, shrunk) < 0.0)
        low, high = np.zeros(open_.size), np.ones(open_.size)
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            clear = self_clearance(problem.chain, problem.width, middle[:, None] * shrunk[open_])
            low = np.where(clear >= 0.0, middle, low)
            high = np.where(clear >= 0.0, high, middle)
        scale[open_] *= low
        return scale.reshape(theta.shape[:-1])


def grid(axes: tuple[ShapeAxis, ShapeAxis]) -> Array:
    """Points of a grid [rad, rad], shape (n_1, n_2, 2)."""
    return np.stack(np.meshgrid(axes[0].values, axes[1].values, indexing='ij'), axis=-1)


def _amplitude(a: float, mean: float, phase: Array) -> tuple[Array, Array]:
    """Return a (mean + sin(phase)) of eq:prescribe_amp and its derivative [rad], (...)."""
    return a * (mean + np.sin(phase)), a * np.cos(phase)
