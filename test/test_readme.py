"""The README tells the truth about parameters, topics, services and commands."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from omega_turn_lab import cli
from omega_turn_ros.nodes.launch_arguments import launch_arguments

README = (Path(__file__).parent.parent / 'README.md').read_text()


def table_rows(heading: str) -> dict[str, list[str]]:
    """Cells of the first table whose header begins with `heading`, by first cell."""
    lines = README.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(f'| {heading} |'))
    rows = {}
    for line in lines[start + 2 :]:
        if not line.startswith('|'):
            break
        first, *rest = (cell.strip() for cell in line.strip('|').split('|'))
        rows[first.strip('`')] = rest
    return rows


def test_parameter_tables_are_those_of_the_code() -> None:
    reference = pytest.importorskip('omega_turn_lab.reference')
    assert reference.with_tables(README) == README, (
        'renew: python -m omega_turn_lab.reference README.md'
    )
    for node, specs in reference.NODES.items():
        assert all(f'| `{spec.name}` |' in README for spec in specs), node


def test_topics_and_services_are_those_of_the_running_nodes() -> None:
    rclpy = pytest.importorskip('rclpy')
    from omega_turn_ros.nodes.admittance_node import AdmittanceNode
    from omega_turn_ros.nodes.gait_node import GaitNode
    from omega_turn_sim_bridge.bridge_node import PyBulletBridge

    context = rclpy.context.Context()
    context.init(domain_id=99)
    nodes = [make(context=context) for make in (GaitNode, AdmittanceNode, PyBulletBridge)]
    topics: dict[str, str] = {}
    services: dict[str, str] = {}
    for node in nodes:
        name = node.get_name()
        for pairs in (
            node.get_publisher_names_and_types_by_node(name, '/'),
            node.get_subscriber_names_and_types_by_node(name, '/'),
        ):
            topics.update({topic: types[0] for topic, types in pairs})
        services.update(
            {s: types[0] for s, types in node.get_service_names_and_types_by_node(name, '/')}
        )
    for node in nodes:
        node.destroy_node()
    context.try_shutdown()
    plumbing = {'/rosout', '/parameter_events'}
    documented = {'/' + name.lstrip('/'): cells[0] for name, cells in table_rows('topic').items()}
    assert documented == {t: kind for t, kind in topics.items() if t not in plumbing}
    ours = {s: kind for s, kind in services.items() if kind == 'std_srvs/srv/Trigger'}
    documented = {'/' + name: cells[0] for name, cells in table_rows('service').items()}
    assert documented == ours


def test_commands_shown_are_commands_that_exist(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        cli.main(['--help'])
    known = set(re.findall(r'^\s{4}(\w+)\s', capsys.readouterr().out, flags=re.MULTILINE))
    shown = set(re.findall(r'`?omega_turn (\w+) -', README))
    assert shown and shown <= known
    makefile = (Path(__file__).parent.parent / 'Makefile').read_text()
    for target in re.findall(r'\bmake (\w+)', README):
        assert f'\n{target}:' in makefile, target


def test_launch_arguments_shown_exist() -> None:
    known = {argument.name for argument in launch_arguments({})}
    shown = set(re.findall(r'\b(\w+):=', README))
    assert shown and shown <= known
