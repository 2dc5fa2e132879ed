"""Turning with ten legs (Sec. IV.J): height function, paths, and rotation per cycle over A_3.

The paper's claims: rotation grows with A_3 between 0 and 20 deg; the height function has two
stripes; on carpet, which sticks, the robot departs from the model at middle amplitudes. It prints
no numbers.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from omega_turn_lab.legged_trial import LeggedTrial
from omega_turn_lab.studies.legged_height import legged_height, path_turn
from omega_turn_lab.studies.legged_pictures import Curves, draw_legged
from omega_turn_lab.studies.rows import Row
from omega_turn_lab.studies.study import Outcome, Study
from omega_turn_ros.design.legged import walking_gait
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.legged import LeggedGait
from omega_turn_ros.mechanics.legged import LeggedMotion
from omega_turn_ros.robot import LeggedRobot, load_robot

NAME = 'legged'
ROBOT = 'legged10'
A_3_DEG = (0.0, 5.0, 10.0, 15.0, 20.0)
SHOWN_DEG = (10.0, 20.0)  # low and high amplitude of the paper's panels b and c
FINE_DEG = np.linspace(0.0, 20.0, 41)
CARPET = 0.75  # static friction beside a kinetic one of 0.5
STEPS = 720
OURS, PRINTED, CONSTANT = 'A_3 (1 - cos phi)/2', 'A_3 sin phi', 'A_3'
# w_3 as we turn; as the paper prints it, which cannot turn; and constant.
PATHS = {OURS: (0.5, -0.5 * math.pi), PRINTED: (0.0, 0.0), CONSTANT: (1.0, 0.0)}


def robot() -> LeggedRobot:
    """Return the robot of the study."""
    found = load_robot(ROBOT)
    if not isinstance(found, LeggedRobot):
        raise BadInputError('robot', ROBOT, 'a robot with legs')
    return found


def gait(path: str, a_3_deg: float) -> LeggedGait:
    """Gait of one path and amplitude."""
    sigma, phi_3 = PATHS[path]
    return replace(walking_gait(), a_3=math.radians(a_3_deg), sigma=sigma, phi_3=phi_3)


def trial(path: str, a_3_deg: float, static_friction: float = 0.0) -> LeggedTrial:
    """Its trial in PyBullet."""
    return LeggedTrial(robot(), gait(path, a_3_deg), static_friction=static_friction)


def _trials(outcome: Outcome) -> list[LeggedTrial]:
    del outcome
    ground = [trial(path, a_3) for path in PATHS for a_3 in A_3_DEG[1:]]
    carpet = [trial(OURS, a_3, CARPET) for a_3 in A_3_DEG]
    return [trial(OURS, 0.0), *ground, *carpet]


def _angle(loads: str, path: str, a_3_deg: float) -> float:
    """Rotation per cycle by force balance [deg]."""
    phases = np.linspace(0.0, 2.0 * np.pi, STEPS + 1)
    return math.degrees(LeggedMotion(robot(), loads).turn(gait(path, a_3_deg).angles(phases)))


def _played(outcome: Outcome, task: LeggedTrial, quantity: str = 'angle_deg') -> float | None:
    found = outcome.tried.get(task)
    return None if found is None else float(found[quantity])


def _spread(outcome: Outcome, task: LeggedTrial) -> float | None:
    """Standard deviation over its cycles [deg]."""
    found = outcome.tried.get(task)
    return None if found is None else float(np.std(found['cycle_angles_deg'], ddof=1))


def _rows(outcome: Outcome) -> list[Row]:
    rows = []
    for path in PATHS:
        for a_3 in A_3_DEG if path == OURS else A_3_DEG[1:]:
            case = f'w_3 = {path}, A_3 {a_3:g} deg'
            params = {'n_pairs': 5, 'A_3_deg': a_3}
            played = _played(outcome, trial(path, a_3))
            for loads, seen in (('equal', played), ('static', played)):
                ours = _angle(loads, path, a_3)
                rows.append(
                    Row(f'{case}, {loads} loads', params, 'angle', 'deg', None, None, ours, seen)
                )
            if path == OURS:
                carpet = _played(outcome, trial(path, a_3, CARPET))
                rows.append(
                    Row(f'{case}, carpet', params, 'angle', 'deg', None, None, None, carpet)
                )
                for ground, mu_s in (('', 0.0), (', carpet', CARPET)):
                    spread = _spread(outcome, trial(path, a_3, mu_s))
                    name = f'{case}{ground}'
                    rows.append(Row(name, params, 'angle_std', 'deg', None, None, None, spread))
    return [*rows, *_height_rows(), _walking_row(outcome)]


def _height_rows() -> list[Row]:
    """The height function's prediction beside the integral it stands for."""
    whole = gait(OURS, A_3_DEG[-1])
    motion = LeggedMotion(robot())
    field = legged_height(motion, whole)
    rows = []
    for a_3 in SHOWN_DEG:
        surface = path_turn(motion, whole, field, a_3 / A_3_DEG[-1]).surface
        params = {'n_pairs': 5, 'A_3_deg': a_3}
        case = f'w_3 = {OURS}, A_3 {a_3:g} deg, equal loads'
        value = math.degrees(surface)
        rows.append(Row(case, params, 'surface', 'deg', None, None, value, None))
    return rows


def _walking_row(outcome: Outcome) -> Row:
    phases = np.linspace(0.0, 2.0 * np.pi, STEPS + 1)
    motion = LeggedMotion(robot())
    advance = float(motion.pose_along(gait(OURS, 0.0).angles(phases))[-1, 0]) / robot().length
    played = _played(outcome, trial(OURS, 0.0), 'advance_bl')
    params = {'n_pairs': 5, 'A_3_deg': 0.0}
    return Row('walking', params, 'advance', 'BL', None, None, advance, played)


def _records(outcome: Outcome) -> list[dict[str, Any]]:
    records = []
    for task in _trials(outcome) if outcome.tried else ():
        found = outcome.tried[task]
        path = next(name for name in PATHS if gait(name, 1.0).sigma == task.gait.sigma)
        records.append(
            {
                'w_3': path,
                'A_3_deg': round(math.degrees(task.gait.a_3), 6),
                'friction': task.friction,
                'static_friction': task.static_friction or task.friction,
                'angle_deg': found['angle_deg'],
                'cycle_angles_deg': found['cycle_angles_deg'],
                'advance_bl': found['advance_bl'],
            }
        )
    return records


def _draw(outcome: Outcome, out: Path) -> None:
    whole = gait(OURS, A_3_DEG[-1])
    motion = LeggedMotion(robot())
    curves = Curves(
        FINE_DEG,
        {
            (loads, path): np.array([_angle(loads, path, a_3) for a_3 in FINE_DEG])
            for loads, path in (('equal', OURS), ('static', OURS), ('equal', PRINTED))
        },
        A_3_DEG,
        {
            (ground, path): [_played(outcome, trial(path, a_3, mu_s)) for a_3 in A_3_DEG]
            for ground, path, mu_s in (
                ('kinetic', OURS, 0.0),
                ('carpet', OURS, CARPET),
                ('kinetic', PRINTED, 0.0),
            )
        }
        if outcome.tried
        else {},
    )
    motions = {a_3: outcome.tried[trial(OURS, a_3)] for a_3 in SHOWN_DEG if outcome.tried} or {
        a_3: _by_theory(a_3) for a_3 in SHOWN_DEG
    }
    field = legged_height(motion, whole)
    draw_legged(out / f'{NAME}.png', motion, whole, field, curves, motions)


def _by_theory(a_3_deg: float) -> dict[str, Any]:
    """A cycle as a trial gives it, had the physics been the force balance."""
    fraction = np.linspace(0.0, 1.0, 61)
    angles = gait(OURS, a_3_deg).angles(2.0 * np.pi * fraction)
    poses = LeggedMotion(robot(), 'static').pose_along(angles)
    return {'fraction': fraction.tolist(), 'poses': poses.tolist(), 'angles': angles.tolist()}


STUDY = Study(
    NAME,
    'Ten legs: rotation per cycle, 6 s',
    lambda plan: (),
    _rows,
    _draw,
    played=False,
    trials=_trials,
    records=_records,
)
