"""What the demo grants a robot where the ground is not level."""

from __future__ import annotations

import pytest

from omega_turn_lab.uneven import NEAR_ENOUGH, PATIENCE, feedback_on, pitch_effort_on
from omega_turn_ros.gaits.library import load_gait
from omega_turn_ros.nodes.gait_parameters import GAIT_PARAMETERS
from omega_turn_ros.robot import load_robot
from omega_turn_sim_bridge.terrain_config import TerrainConfig, load_terrain

KNOWN = {spec.name: spec for spec in GAIT_PARAMETERS}


def test_level_ground_asks_for_nothing() -> None:
    for name in ('flat', 'coulomb', 'granular'):
        ground = load_terrain(name)
        assert feedback_on(ground) == {}
        assert pitch_effort_on(ground, load_gait('omega').gait) == 0.0


@pytest.mark.parametrize('kind', ['pegboard', 'rocks'])
def test_obstacles_ask_for_patience_in_parameters_the_gait_node_has(kind: str) -> None:
    parameters = feedback_on(TerrainConfig(kind))
    assert parameters['max_corrections'] == PATIENCE > KNOWN['max_corrections'].default
    assert set(parameters) <= set(KNOWN)
    assert parameters.get('heading_tolerance') == (NEAR_ENOUGH if kind == 'rocks' else None)


def test_only_gaits_that_lie_flat_give_way_on_rocks() -> None:
    rocks = TerrainConfig('rocks')
    robot = load_robot('limbless16')
    assert 0.0 < pitch_effort_on(rocks, load_gait('omega').gait) < robot.effort_limit
    assert pitch_effort_on(rocks, load_gait('sidewinding').gait) == 0.0
