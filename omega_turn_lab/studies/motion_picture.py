"""A robot's way over a ground with obstacles, from above: body over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from omega_turn_lab.body_shapes import body_polygons
from omega_turn_lab.ground_view import view_ground
from omega_turn_lab.obstacle_trial import ObstacleTrial
from omega_turn_lab.studies.figures import COLOURS
from omega_turn_lab.studies.tasks import Result
from omega_turn_ros.mechanics.chain import PlanarChain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHAPES = 9  # drawn of a turn
MARGIN = 0.12  # [m] around the robot's way
STANDING: dict[str, Any] = {'facecolor': '0.25', 'lw': 0.0}
LYING: dict[str, Any] = {'facecolor': '0.93', 'ec': '0.7', 'lw': 0.5}


def draw_motion(axes: Axes, trial: ObstacleTrial, result: Result) -> None:
    """Draw the body over time, pale at first, dark at the end, head marked, and the ground.

    Args:
        axes: to draw on; its ticks are taken away.
        trial: whose ground and robot.
        result: with `poses`, `yaw_angles` and `total_deg`.
    """
    from matplotlib.colors import to_rgb
    from matplotlib.patches import Polygon

    chain = PlanarChain.of_robot(trial.robot)
    poses, angles = np.array(result['poses']), np.array(result['yaw_angles'])
    chosen = np.linspace(0, len(poses) - 1, SHAPES).round().astype(int)
    outlines = chain.outline(angles[chosen], poses[chosen])
    for i, outline in enumerate(outlines):
        depth = 0.15 + 0.85 * i / (SHAPES - 1)
        # Mixed with white by hand: a body of see-through strips would show its overlaps.
        body, head = ((1.0 - depth) + depth * np.array(to_rgb(c)) for c in COLOURS[:2])
        for polygon in body_polygons(outline, trial.robot.module_width):
            axes.add_patch(Polygon(polygon, facecolor=body, lw=0, zorder=1 + i))
        axes.plot(*outline[0], 'o', color=head, ms=2.2, zorder=1 + i)
    ground = view_ground(trial.terrain, trial.robot, trial.seed)
    look, order = (LYING, 0) if ground.carries else (STANDING, SHAPES + 1)
    for obstacle in ground.obstacles:
        axes.add_patch(Polygon(obstacle, zorder=order, **look))
    low, high = (f(outlines.reshape(-1, 2), axis=0) for f in (np.min, np.max))
    axes.set_xlim(low[0] - MARGIN, high[0] + MARGIN)
    axes.set_ylim(low[1] - MARGIN, high[1] + MARGIN)
    axes.set_aspect('equal')
    axes.axis('off')
    turned = result['total_deg']
    axes.text(
        0.5,
        -0.02,
        f'{turned:.0f}° in {trial.cycles} cycles',
        transform=axes.transAxes,
        ha='center',
        va='top',
        fontsize=7.0,
    )
