"""Arguments of the launch file: read as people write them, or refused by name."""

from __future__ import annotations

from pathlib import Path

import pytest

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.nodes.gait_parameters import GAIT_PARAMETERS
from omega_turn_ros.nodes.launch_arguments import (
    FEEDBACK,
    LARGEST_FACTOR,
    LaunchSettings,
    launch_arguments,
    read_arguments,
)
from omega_turn_ros.nodes.names import LONGEST
from omega_turn_sim_bridge.bridge_parameters import BRIDGE_PARAMETERS


def read(**given: str) -> LaunchSettings:
    return read_arguments(launch_arguments({}), given)


def test_without_arguments_the_parameter_file_alone_speaks_but_for_the_simulated_clock() -> None:
    settings = read()
    assert settings.parameters == {
        'gait_node': {'use_sim_time': True},
        'admittance_node': {'use_sim_time': True},
        'pybullet_bridge': {},
    }
    assert settings.use_sim and settings.admittance and settings.params_file.is_file()
    assert (settings.namespace, settings.turn_deg, settings.domain_id) == ('', 0.0, 73)


def test_hardware_leaves_the_clock_to_the_parameter_file() -> None:
    assert read(use_sim='off').parameters['gait_node'] == {}


def test_what_is_given_goes_to_the_node_it_concerns_in_its_own_type() -> None:
    settings = read(
        gui='0',
        real_time_factor='2',
        compliance='on',
        heading_feedback='None',
        use_sim_time='no',
        turn_deg='-4.5e1',
        namespace='/snake_1/',
        domain_id='7',
    )
    assert settings.parameters == {
        'gait_node': {'use_sim_time': False, 'heading_feedback': 'none', 'use_compliance': True},
        'admittance_node': {'use_sim_time': False},
        'pybullet_bridge': {'gui': False, 'real_time_factor': 2.0},
    }
    factor = settings.parameters['pybullet_bridge']['real_time_factor']
    assert isinstance(factor, float)  # a node would refuse '2'
    assert (settings.namespace, settings.turn_deg, settings.domain_id) == ('snake_1', -45.0, 7)


@pytest.mark.parametrize('text', ['off', 'no', 'false', '0', 'False', 'OFF', ' off '])
def test_compliance_is_left_out_however_one_says_no(text: str) -> None:
    settings = read(compliance=text)
    assert not settings.admittance
    assert settings.parameters['gait_node']['use_compliance'] is False


def test_the_domain_of_the_environment_is_the_default() -> None:
    assert read_arguments(launch_arguments({'ROS_DOMAIN_ID': '12'}), {}).domain_id == 12


@pytest.mark.parametrize(
    ('name', 'text'),
    [
        ('turn_deg', 'ninety'),
        ('turn_deg', 'nan'),
        ('turn_deg', '-inf'),
        ('turn_deg', ''),
        ('use_sim', 'maybe'),
        ('use_sim', ''),
        ('compliance', '2'),
        ('gui', 'offf'),
        ('real_time_factor', '-3'),
        ('heading_feedback', 'gps'),
        ('log_level', 'loud'),
        ('domain_id', 'abc'),
        ('domain_id', '233'),
        ('domain_id', '-1'),
        ('namespace', 'a b'),
        ('namespace', '1st'),
        ('namespace', 'a//b'),
        ('namespace', 'a' * (LONGEST + 1)),
        ('params_file', '/no/such.yaml'),
        ('params_file', ''),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(name: str, text: str) -> None:
    with pytest.raises(BadInputError) as caught:
        read(**{name: text})
    assert (caught.value.field, caught.value.value) == (name, text)


@pytest.mark.parametrize(
    'text', ['a: [1, 2\n', '- gait_node\n', '', 'gait_node:\n  gait: omega\n']
)
def test_a_file_that_holds_no_parameters_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / 'mine.yaml'
    path.write_text(text)
    with pytest.raises(BadInputError, match='params_file'):
        read(params_file=str(path))


def test_a_file_with_namespaces_in_levels_is_accepted(tmp_path: Path) -> None:
    path = tmp_path / 'mine.yaml'
    path.write_text('snake_1:\n  gait_node:\n    ros__parameters:\n      gait: offset\n')
    assert read(params_file=str(path)).params_file == path


def test_bounds_are_those_of_the_nodes() -> None:
    (feedback,) = (spec for spec in GAIT_PARAMETERS if spec.name == 'heading_feedback')
    (factor,) = (spec for spec in BRIDGE_PARAMETERS if spec.name == 'real_time_factor')
    assert feedback.choices == FEEDBACK
    assert (factor.low, factor.high) == (0.0, LARGEST_FACTOR)
