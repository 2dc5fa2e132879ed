"""Attributes of our nodes must not fall on those rclpy keeps on a Node."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from rclpy.context import Context
from rclpy.node import Node

import omega_turn_ros.nodes.admittance_node
import omega_turn_ros.nodes.gait_node
import omega_turn_sim_bridge.bridge_node

MODULES = (
    omega_turn_ros.nodes.admittance_node,
    omega_turn_ros.nodes.gait_node,
    omega_turn_sim_bridge.bridge_node,
)


def assigned_attributes(path: Path) -> set[str]:
    """Names assigned to `self` anywhere in a file."""
    return {
        node.attr
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and isinstance(node.value, ast.Name)
        and node.value.id == 'self'
    }


@pytest.mark.parametrize('module', MODULES, ids=lambda m: m.__name__.rpartition('.')[2])
def test_no_attribute_shadows_one_of_rclpy_node(module: object) -> None:
    context = Context()
    context.init()
    plain = Node('plain', context=context)
    taken = set(vars(plain)) | set(dir(Node))
    plain.destroy_node()
    context.try_shutdown()
    ours = assigned_attributes(Path(str(module.__file__)))
    assert ours
    assert not ours & taken
