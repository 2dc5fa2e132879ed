"""The force balance beside scipy and numpy, height functions and one design."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from scipy.optimize import minimize

from omega_turn_ros.design.hierarchical import design_hierarchical
from omega_turn_ros.design.problem import DesignProblem
from omega_turn_ros.design.sub_shape import SubShape
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.mechanics.force_balance import solve_balance
from omega_turn_ros.mechanics.force_laws import (
    CoulombFriction,
    ForceLaw,
    GranularResistance,
    LinearDrag,
)
from omega_turn_ros.mechanics.quasi_static import QuasiStatic
from omega_turn_ros.robot import load_robot

SHAPES = 20_000
FEW = 200  # shapes for scipy
REPEATS = 5
LAWS: dict[str, ForceLaw] = {
    'Coulomb, isotropic': CoulombFriction(),
    'Coulomb, ratio 2': CoulombFriction(2.0),
    'granular': GranularResistance(),
    'linear drag': LinearDrag(),
}


def best_of(
    run: Callable[[], object],
    repeats: int = REPEATS,
    clock: Callable[[], float] = time.thread_time,
) -> float:
    """Shortest time of some runs after one to warm up [s]: of this core, whoever else works."""
    run()
    times = []
    for _ in range(repeats):
        start = clock()
        run()
        times.append(clock() - start)
    return min(times)


def random_motions(n: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Unrelated shapes and rates: no guess helps, and a point sticks in every third."""
    rng = np.random.default_rng(1)
    return rng.uniform(-1.2, 1.2, (count, n)), rng.normal(size=(count, n))


def gait_motions(n: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Shapes along one cycle of the shipped omega turn."""
    path = load_gait('omega').gait.angles(np.linspace(0.0, 2.0 * np.pi, count + 1), n)
    return path[:-1], np.diff(path, axis=0)


def by_scipy(chain: PlanarChain, angles: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """BFGS on the dissipation with its gradient, in units of body size and speed."""
    state = chain.state(angles, rates)
    size = float(np.abs(state.points).max())
    found = []
    w = chain.normal_forces / chain.normal_forces.sum()
    for points, velocities in zip(state.points / size, state.velocities):
        speed = np.abs(velocities).mean()
        v = velocities / speed
        arm = np.stack([-points[:, 1], points[:, 0]], axis=-1)

        def dissipation(xi: np.ndarray) -> tuple[float, np.ndarray]:
            slip = v + xi[:2] + xi[2] * arm
            norm = np.sqrt((slip**2).sum(axis=1)) + 1e-300
            unit = w[:, None] * slip / norm[:, None]
            return float(w @ norm), np.array([*unit.sum(axis=0), (unit * arm).sum()])

        xi = minimize(dissipation, np.zeros(3), jac=True, method='BFGS', options={'gtol': 1e-8}).x
        found.append(xi * speed / [1.0, 1.0, size])
    return np.array(found)


def compare_solvers(chain: PlanarChain) -> None:
    """One force balance, three ways, on the same shapes."""
    print(f'one force balance, {chain.link_of_point.size} contact points, one core [us]')
    motion = QuasiStatic(chain)
    for name, motions in (('unrelated shapes', random_motions), ('along a gait', gait_motions)):
        q, dq = motions(chain.n_joints, SHAPES)
        few_q, few_dq = q[:: SHAPES // FEW], dq[:: SHAPES // FEW]
        state = chain.state(few_q, few_dq)
        ours = 1e6 * best_of(lambda: motion.body_velocity(q, dq)) / SHAPES
        numpy = best_of(
            lambda: solve_balance(state.points, state.velocities, chain.normal_forces), 2
        )
        scipy = best_of(lambda: by_scipy(chain, few_q, few_dq), 1)
        numpy, scipy = 1e6 * numpy / FEW, 1e6 * scipy / FEW
        print(
            f'  {name:18s} compiled {ours:5.2f}   numpy, batched {numpy:6.0f} '
            f'({numpy / ours:4.0f} x)   scipy BFGS {scipy:6.0f} ({scipy / ours:5.0f} x)'
        )
    for name, law in LAWS.items():
        motion = QuasiStatic(chain, law)
        times = [
            1e6 * best_of(lambda: motion.body_velocity(q, dq)) / SHAPES
            for q, dq in (m(chain.n_joints, SHAPES) for m in (random_motions, gait_motions))
        ]
        print(f'  {name:18s} unrelated {times[0]:5.2f}   along a gait {times[1]:5.2f}')


def compare_cores(chain: PlanarChain) -> None:
    """The kernel lets go of the GIL, so threads suffice."""
    motion = QuasiStatic(chain)
    q, dq = random_motions(chain.n_joints, SHAPES)
    alone = best_of(lambda: motion.body_velocity(q, dq), clock=time.perf_counter)
    with ThreadPoolExecutor(2) as pool:
        both = best_of(
            lambda: list(pool.map(motion.body_velocity, [q, q], [dq, dq])),
            clock=time.perf_counter,
        )
    print(f'two threads do {2.0 * alone / both:.2f} x the work of one')


def show_growth() -> None:
    """Cost over joints, contact points and grid."""
    print('along a gait [us]:')
    for n in (4, 8, 16, 32):
        motion = QuasiStatic(PlanarChain(np.full(n + 1, 0.1), points_per_link=4))
        q, dq = gait_motions(n, SHAPES)
        taken = 1e6 * best_of(lambda: motion.body_velocity(q, dq), 3) / SHAPES
        print(f'  N = {n:2d}, 4 points per link    {taken:6.2f}')
    for points in (2, 4, 8, 16, 32):
        motion = QuasiStatic(PlanarChain(np.full(9, 0.14), points_per_link=points))
        q, dq = gait_motions(8, SHAPES)
        taken = 1e6 * best_of(lambda: motion.body_velocity(q, dq), 3) / SHAPES
        print(f'  N =  8, {points:2d} points per link   {taken:6.2f}')


def measure_design() -> None:
    """Height functions of the omega turn, and a gait from scratch."""
    problem = DesignProblem.of_robot(load_robot('limbless16'), math.radians(90.0))
    sub = SubShape(problem, load_gait('omega').gait, 'turning')
    print('height function with misfit, three rows [s]:')
    for n in (16, 32, 64, 128):
        print(f'  {n:3d} x {n:<3d} {best_of(lambda: sub.field(n).height, 3):.3f}')
    start = time.thread_time()
    design = design_hierarchical(problem)
    taken = time.thread_time() - start
    print(
        f'hierarchical design from scratch, {design.starts} starts: {taken:.2f} s, '
        f'{math.degrees(design.angle):.1f} deg per cycle, {design.evaluations} cycles integrated'
    )


if __name__ == '__main__':
    paper = PlanarChain.of_robot(load_robot('limbless16'), points_per_link=4)
    compare_solvers(paper)
    compare_cores(paper)
    show_growth()
    measure_design()
