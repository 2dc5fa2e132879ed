"""What every study needs, computed from gaits that were not searched for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from omega_turn_lab.studies import tasks as tasks_module
from omega_turn_lab.studies.areas import area_readings
from omega_turn_lab.studies.run import ROBOT, available, load_study
from omega_turn_lab.studies.study import Outcome, Plan
from omega_turn_lab.studies.tasks import DesignTask, PhysicsTask, Result
from omega_turn_ros.design.problem import Design, DesignProblem
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait
from omega_turn_ros.gaits.wave_gait import WaveGait
from omega_turn_ros.robot import load_robot

# Those whose numbers are of designed gaits; the others have tests of their own.
OTHERS = ('height', 'beyond', 'pegboard', 'rocks', 'legged')
PAPER = [name for name in available() if name not in OTHERS]


def unsearched(problem: DesignProblem, seed: int = 0, area_limit: float = math.inf) -> Design:
    """A shipped gait of the nearest k_t, fitted to the problem."""
    shipped = [load_gait(name).gait for name in ('offset', 'omega', 'geometric')]
    nearest = min(shipped, key=lambda gait: abs(gait.k_t - problem.k_t))
    assert isinstance(nearest, TwoWaveGait)
    shifted = replace(
        nearest, k_f=problem.k_f, k_t=problem.k_t, psi=nearest.psi + 0.1 / area_limit + seed
    )
    gait = problem.fitted(shifted)
    angle = problem.turn(problem.path(gait))
    gait = gait if angle > 0.0 else gait.mirrored()
    return Design(gait, abs(angle), 0.0, 'none', 1, 1, (1.0,), 'not searched')


def played_by_theory(task: DesignTask, gait: WaveGait) -> Result:
    """What a trial returns, had the physics been the force balance of half the gait."""
    fraction = np.linspace(0.0, 1.0, 51)
    path = gait.angles(2.0 * np.pi * fraction, task.robot.n_yaw, 0.5)
    poses = task.problem.motion.pose_along(path)
    return {
        'angle_deg': math.degrees(poses[-1, 2]),
        'areas': area_readings(task.problem.chain, task.robot.module_width, path, poses),
        'fraction': fraction.tolist(),
        'poses': poses.tolist(),
        'yaw_angles': path.tolist(),
    }


@pytest.fixture(scope='session')
def outcome() -> Outcome:
    """Every case of the paper's studies, with PyBullet."""
    plan = Plan(load_robot(ROBOT), seed=0)
    studies = [load_study(name) for name in PAPER]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tasks_module, 'design_direct', unsearched)
        designed = {task: task.run() for study in studies for task in study.designs(plan)}
    found = Outcome(plan, designed)
    played = {}
    for study in studies:
        for task in study.designs(plan) if study.played else ():
            gait = found.gait(task)
            played[PhysicsTask(task.robot, gait)] = played_by_theory(task, gait)
    design_of = {found.gait(task): task for task in designed}
    trials = [trial for study in studies for trial in study.trials(found)]
    tried = {
        trial: played_by_theory(design_of[trial.gait], trial.gait)
        for trial in trials
        if isinstance(trial, PhysicsTask)
    }
    return Outcome(plan, designed, played, {**tried})


@pytest.fixture(scope='session')
def without_pybullet(outcome: Outcome) -> Outcome:
    """The same, as `--no-pybullet` leaves it."""
    return Outcome(outcome.plan, outcome.designed)
