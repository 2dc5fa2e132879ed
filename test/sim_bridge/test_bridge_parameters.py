"""What the bridge's parameters make of its physics settings."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import pytest

from omega_turn_ros.errors import BadInputError
from omega_turn_sim_bridge.bridge_parameters import BRIDGE_PARAMETERS, make_config, make_terrain
from omega_turn_sim_bridge.simulation_config import SimulationConfig
from omega_turn_sim_bridge.terrain_config import load_terrain

FIXED = {'time_step', 'terrain', 'contact_stiffness', 'contact_damping'}  # not a parameter's own


def values(**given: Any) -> dict[str, Any]:
    return {spec.name: spec.default for spec in BRIDGE_PARAMETERS} | given


def test_defaults_are_those_of_the_physics() -> None:
    assert make_config(values()) == SimulationConfig(terrain=load_terrain('flat'))


def test_every_setting_of_the_physics_follows_the_parameter_of_its_name() -> None:
    for field in fields(SimulationConfig):
        if field.name in FIXED:
            continue
        given = True if field.name == 'gui' else 3
        assert getattr(make_config(values(**{field.name: given})), field.name) == given


def test_a_step_of_the_solver_lasts_as_long_as_its_rate_says() -> None:
    assert make_config(values(physics_rate=400.0)).time_step == pytest.approx(0.0025)


def test_a_foot_that_sticks_less_than_it_slides_is_refused() -> None:
    with pytest.raises(BadInputError, match='static_friction'):
        make_config(values(friction=0.6, static_friction=0.5))


def test_a_terrain_keeps_its_own_where_no_parameter_departs_from_it() -> None:
    assert make_terrain(values(terrain='pegboard')) == load_terrain('pegboard')
    changed = make_terrain(values(terrain='pegboard', peg_spacing=0.5, peg_friction=0.0))
    assert (changed.spacing_bl, changed.peg_friction) == (0.5, 0.0)
