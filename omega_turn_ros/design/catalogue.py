"""The gaits of the shipped library: what each is designed for."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from omega_turn_ros.design.calibrate import make_library_gait
from omega_turn_ros.design.direct import design_direct
from omega_turn_ros.design.fourier import design_fourier
from omega_turn_ros.design.hierarchical import design_hierarchical
from omega_turn_ros.design.legged import LeggedRecipe
from omega_turn_ros.design.problem import Design, DesignProblem
from omega_turn_ros.design.sidewinding import SidewindingRecipe
from omega_turn_ros.errors import BadInputError
from omega_turn_ros.gaits.library import LibraryGait
from omega_turn_ros.robot import LeggedRobot, Robot

METHODS: dict[str, Callable[[DesignProblem, int], Design]] = {
    'direct': design_direct,
    'speed': partial(design_direct, per_second=True),
    'hierarchical': design_hierarchical,
    'fourier_1': partial(design_fourier, harmonics=1),
    'fourier_2': partial(design_fourier, harmonics=2),
}


@dataclass(frozen=True, slots=True)
class Recipe:
    """One gait to design.

    Attributes:
        name: of the library file.
        description: one line for people.
        k_f: spatial frequency of the forward wave.
        k_t: spatial frequency of the turning wave.
        theta_max_deg: limit on every joint angle [deg].
        method: one of `METHODS`.
    """

    name: str
    description: str
    k_f: float = 1.5
    k_t: float = 1.0
    theta_max_deg: float = 90.0
    method: str = 'direct'


CATALOGUE = (
    Recipe('omega', 'Omega turn, k_t = 1, joint limit 90 deg'),
    Recipe('omega_75', 'Omega turn, k_t = 1, joint limit 75 deg', theta_max_deg=75.0),
    Recipe('omega_60', 'Omega turn, k_t = 1, joint limit 60 deg', theta_max_deg=60.0),
    Recipe('offset', 'Offset turn with time-varying offset, k_t = 0', k_t=0.0),
    Recipe('geometric', 'Geometric turn, k_t = k_f = 1.5', k_t=1.5),
    Recipe(
        'omega_fast',
        'Fourier series of two harmonics, k_t = 0.75: most turn per second at equal joint speed',
        k_t=0.75,
        method='fourier_2',
    ),
)


SIDEWINDING = SidewindingRecipe()


def recipes_for(robot: Robot) -> list[Recipe | SidewindingRecipe | LeggedRecipe]:
    """Return every gait of the library that the robot can play, within its own joint limit."""
    if isinstance(robot, LeggedRobot):
        return [LeggedRecipe()]
    found: list[Recipe | SidewindingRecipe | LeggedRecipe] = [
        within_limits(recipe, robot) for recipe in CATALOGUE
    ]
    return [*found, SIDEWINDING] if SIDEWINDING.fits(robot) else found


def within_limits(recipe: Recipe, robot: Robot) -> Recipe:
    """Return the recipe with its joint limit lowered to the robot's own where that is tighter."""
    own = math.degrees(robot.position_limit)
    if recipe.theta_max_deg <= own:
        return recipe
    text = f'{recipe.description}, here {own:.1f} deg, the limit of {robot.name}'
    return replace(recipe, theta_max_deg=own, description=text)


def design_recipe(recipe: Recipe, robot: Robot, seed: int = 0) -> tuple[Design, LibraryGait]:
    """Design and calibrate one gait for a robot.

    Raises:
        BadInputError: the robot or the recipe cannot turn, or there is no such method.
    """
    if recipe.method not in METHODS:
        raise BadInputError('method', recipe.method, f'one of {sorted(METHODS)}')
    limit = math.radians(recipe.theta_max_deg)
    problem = DesignProblem.of_robot(robot, limit, recipe.k_f, recipe.k_t)
    design = METHODS[recipe.method](problem, seed)
    return design, make_library_gait(recipe.name, recipe.description, design.gait, robot)
