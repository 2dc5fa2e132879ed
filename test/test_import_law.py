"""The import law of the house: arrows down only, and ROS and PyBullet in their rooms only."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
CONTROL, BRIDGE, LAB = 'omega_turn_ros', 'omega_turn_sim_bridge', 'omega_turn_lab'
STOREYS = (CONTROL, BRIDGE, LAB)  # each may import itself and those before it

BASE = ('robot', 'resources', 'errors')
GROUND_FLOOR = ('gaits', 'mechanics')
UPPER_FLOOR = ('compliance', 'design', 'worm')
SCIENCE = (*BASE, *GROUND_FLOOR, *UPPER_FLOOR)
SCIENCE_TOOLS = {'numpy', 'scipy', 'numba', 'yaml'}
OPTIMISERS = {'cma'}  # for design alone

ROS_SUFFIXES = ('_msgs', '_srvs', '_interfaces')
ROS_PREFIXES = ('rclpy', 'rosidl', 'rmw_', 'ament_', 'launch', 'tf2', 'rosbag2', 'ros2')
ROS_BRIDGE = tuple(f'{BRIDGE}.{name}' for name in ('bridge_node', 'bridge_parameters', 'start'))
ROS_ROOMS = (f'{CONTROL}.nodes', *ROS_BRIDGE, 'launch')
# Of the lab: what talks to the nodes. The door (cli) may, but only once a command asks for it.
ROS_LAB = tuple(
    f'{LAB}.{name}'
    for name in (
        'demo',
        'turn',
        'turn_client',
        'recording',
        'live',
        'reference',
        'ros_environment',
    )
)
ROS_LATE = (f'{LAB}.cli',)


@dataclass(frozen=True)
class Import:
    """One imported name."""

    module: str  # dotted name of the importing file
    target: str  # dotted name imported
    line: int
    at_import: bool  # runs when the file is imported, not when a function is called

    @property
    def top(self) -> str:
        return self.target.split('.')[0]


def inside(name: str, *packages: str) -> bool:
    """Whether a dotted name is one of the packages or lies in one."""
    return any(name == package or name.startswith(package + '.') for package in packages)


def is_ros(name: str) -> bool:
    top = name.split('.')[0]
    return top.endswith(ROS_SUFFIXES) or top.startswith(ROS_PREFIXES)


def imports_of(path: Path, root: Path) -> Iterator[Import]:
    """Every import of a file: in functions, under TYPE_CHECKING, relative, or by importlib."""
    parts = list(path.relative_to(root).with_suffix('').parts)
    is_package = parts[-1] == '__init__'
    if is_package:
        parts.pop()
    module = '.'.join(parts)
    package = parts if is_package else parts[:-1]
    tree = ast.parse(path.read_text(encoding='utf-8'), str(path))
    late = {
        id(node)
        for function in ast.walk(tree)
        if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
        for node in ast.walk(function)
    }
    for node in ast.walk(tree):
        targets: list[str] = []
        if isinstance(node, ast.Import):
            targets = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            source = '.'.join([*above, *([node.module] if node.module else [])])
            targets = [f'{source}.{alias.name}' for alias in node.names]
        elif isinstance(node, ast.Call) and node.args:
            name = getattr(node.func, 'attr', getattr(node.func, 'id', ''))
            value = getattr(node.args[0], 'value', None)
            if name in ('import_module', '__import__', 'importorskip') and isinstance(value, str):
                targets = [value]
        for target in targets:
            yield Import(module, target, node.lineno, id(node) not in late)


def wrong_storey(used: Import) -> str | None:
    own = used.module.split('.')[0]
    if used.top not in STOREYS or own not in STOREYS:
        return None
    if STOREYS.index(used.top) > STOREYS.index(own):
        return f'{own} stands below {used.top}'
    return None


def wrong_floor(used: Import) -> str | None:
    """Arrows inside omega_turn_ros."""
    own, target = used.module, used.target
    if not inside(target, CONTROL) or not inside(own, CONTROL) or own == CONTROL:
        return None
    floors = (
        (BASE, BASE),
        (('gaits',), (*BASE, 'gaits')),
        (('mechanics',), (*BASE, 'mechanics')),
        (UPPER_FLOOR, SCIENCE),
    )
    for rooms, allowed in floors:
        if inside(own, *(f'{CONTROL}.{room}' for room in rooms)):
            if inside(target, *(f'{CONTROL}.{room}' for room in allowed)):
                return None
            return f'{own} may use of {CONTROL} only {", ".join(allowed)}'
    return None


def wrong_tool(used: Import) -> str | None:
    """What the science may use from outside."""
    if not inside(used.module, *(f'{CONTROL}.{room}' for room in SCIENCE)):
        return None
    if used.top in STOREYS or used.top in SCIENCE_TOOLS or used.top in sys.stdlib_module_names:
        return None
    if used.top in OPTIMISERS and inside(used.module, f'{CONTROL}.design'):
        return None
    return f'the science uses {", ".join(sorted(SCIENCE_TOOLS))} and the standard library only'


def wrong_room(used: Import) -> str | None:
    """ROS and PyBullet, named or through a module that stands on them."""
    if used.top == 'pybullet' or used.top.startswith('pybullet_'):
        return None if inside(used.module, BRIDGE) else f'pybullet belongs into {BRIDGE}'
    if not is_ros(used.target) and not inside(used.target, *ROS_ROOMS, *ROS_LAB):
        return None
    if inside(used.module, *ROS_ROOMS, *ROS_LAB):
        return None
    if inside(used.module, *ROS_LATE):
        return 'ROS only once a command asks for it' if used.at_import else None
    if used.module == LAB or inside(used.module, LAB):
        return 'this part of the lab knows no ROS'
    return f'ROS belongs into {", ".join(ROS_ROOMS)}'


def breaches(root: Path) -> list[str]:
    """Every breach of the import law in a source tree, as file:line: what is wrong."""
    found = []
    for folder in (*STOREYS, 'launch'):
        for path in sorted((root / folder).rglob('*.py')):
            for used in imports_of(path, root):
                for law in (wrong_storey, wrong_floor, wrong_tool, wrong_room):
                    problem = law(used)
                    if problem:
                        where = path.relative_to(root).as_posix()
                        found.append(f'{where}:{used.line}: {used.target}: {problem}')
    return found


def test_house_keeps_the_import_law() -> None:
    assert breaches(ROOT) == []


def test_law_looks_at_the_rooms_it_speaks_of() -> None:
    """A checker that reads no file, or no import, finds nothing wrong."""
    for room in ('gaits', 'mechanics', 'compliance', 'design', 'nodes'):
        files = list((ROOT / CONTROL / room).glob('*.py'))
        assert len(files) >= 2, room
    used = {
        i.top
        for folder in STOREYS
        for p in (ROOT / folder).rglob('*.py')
        for i in imports_of(p, ROOT)
    }
    assert {'numpy', 'yaml', 'pybullet', 'rclpy', 'sensor_msgs', *STOREYS} <= used


LAWFUL = {
    f'{CONTROL}/__init__.py': '',
    f'{CONTROL}/robot.py': 'import math\nfrom omega_turn_ros.errors import BadInputError\n',
    f'{CONTROL}/gaits/__init__.py': '',
    f'{CONTROL}/gaits/walk.py': 'import numpy as np\nfrom ..robot import Robot\n',
    f'{CONTROL}/mechanics/drag.py': 'import numba\nfrom omega_turn_ros.robot import Robot\n',
    f'{CONTROL}/design/pick.py': 'from omega_turn_ros.gaits import walk\nimport scipy.optimize\n',
    f'{CONTROL}/nodes/node.py': 'import rclpy\nfrom omega_turn_ros.gaits import walk\n',
    f'{BRIDGE}/simulation.py': 'import pybullet\nfrom omega_turn_ros.robot import Robot\n',
    f'{BRIDGE}/bridge_node.py': 'import rclpy\nfrom . import simulation\n',
    f'{LAB}/cli.py': 'def main():\n    from omega_turn_lab import demo\n    import rclpy\n',
    f'{LAB}/demo.py': 'import rclpy\nfrom omega_turn_sim_bridge.bridge_node import Bridge\n',
    'launch/all.launch.py': 'from launch import LaunchDescription\n',
}


def lay_out(root: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_lawful_house_has_no_breach(tmp_path: Path) -> None:
    lay_out(tmp_path, LAWFUL)
    assert breaches(tmp_path) == []


@pytest.mark.parametrize(
    ('file', 'text', 'line'),
    [
        (f'{CONTROL}/gaits/walk.py', 'import rclpy\n', 1),
        (f'{CONTROL}/gaits/walk.py', 'from omega_turn_ros.mechanics.drag import f\n', 1),
        (f'{CONTROL}/gaits/walk.py', 'from omega_turn_ros import mechanics\n', 1),
        (f'{CONTROL}/gaits/walk.py', 'from ..mechanics import drag\n', 1),
        (f'{CONTROL}/gaits/__init__.py', 'from ..nodes import node\n', 1),
        (f'{CONTROL}/gaits/walk.py', 'from omega_turn_ros.design import pick\n', 1),
        (f'{CONTROL}/gaits/walk.py', 'import matplotlib.pyplot as plt\n', 1),
        (
            f'{CONTROL}/mechanics/drag.py',
            'def f():\n    from omega_turn_ros.gaits import walk\n',
            2,
        ),
        (f'{CONTROL}/mechanics/drag.py', 'def f():\n    import sensor_msgs.msg\n', 2),
        (
            f'{CONTROL}/mechanics/drag.py',
            'import typing\nif typing.TYPE_CHECKING:\n    from std_srvs.srv import Trigger\n',
            3,
        ),
        (f'{CONTROL}/robot.py', 'from omega_turn_ros.gaits import walk\n', 1),
        (f'{CONTROL}/design/pick.py', 'import omega_turn_ros.nodes.node\n', 1),
        (
            f'{CONTROL}/design/pick.py',
            'try:\n    import torch\nexcept ImportError:\n    pass\n',
            2,
        ),
        (f'{CONTROL}/design/pick.py', 'import importlib\nimportlib.import_module("rclpy")\n', 2),
        (f'{CONTROL}/worm/fit.py', '__import__("pybullet")\n', 1),
        (f'{CONTROL}/nodes/node.py', 'import pybullet\n', 1),
        (f'{CONTROL}/nodes/node.py', 'from omega_turn_sim_bridge import simulation\n', 1),
        (f'{CONTROL}/nodes/node.py', 'import omega_turn_lab\n', 1),
        (f'{BRIDGE}/simulation.py', 'from builtin_interfaces.msg import Time\n', 1),
        (f'{BRIDGE}/simulation.py', 'from omega_turn_ros.nodes import node\n', 1),
        (f'{BRIDGE}/simulation.py', 'from . import bridge_node\n', 1),
        (f'{BRIDGE}/bridge_node.py', 'from omega_turn_lab.demo import main\n', 1),
        (f'{LAB}/demo.py', 'import pybullet_data\n', 1),
        (f'{LAB}/pictures.py', 'import rclpy\n', 1),
        (f'{LAB}/cli.py', 'from omega_turn_lab import demo\n', 1),
        (f'{LAB}/cli.py', 'import os\nif os.name:\n    import rclpy\n', 3),
        (f'{LAB}/__init__.py', 'from nav_msgs.msg import Odometry\n', 1),
    ],
)
def test_planted_breach_is_found_where_it_is(
    tmp_path: Path, file: str, text: str, line: int
) -> None:
    lay_out(tmp_path, {**LAWFUL, file: text})
    found = breaches(tmp_path)
    assert found, 'not found'
    assert all(problem.startswith(f'{file}:{line}: ') for problem in found)


def test_science_and_physics_work_where_there_is_no_ros_and_the_nodes_without_pybullet() -> None:
    """The law by experiment, in a fresh interpreter: what is missing is not even tried."""
    code = """
import importlib, pkgutil, sys
absent, package, left_out = sys.argv[1].split(','), sys.argv[2], sys.argv[3]
for name in absent:
    sys.modules[name] = None
root = importlib.import_module(package)
names = [m.name for m in pkgutil.walk_packages(root.__path__, package + '.')
         if not m.name.startswith(left_out)]
for name in names:
    importlib.import_module(name)
print(len(names))
"""
    for absent, package, left_out in (
        ('rclpy,sensor_msgs,std_msgs,builtin_interfaces,pybullet', CONTROL, f'{CONTROL}.nodes'),
        ('rclpy,sensor_msgs,std_msgs,builtin_interfaces', BRIDGE, f'{BRIDGE}.bridge_'),
        (f'pybullet,{BRIDGE},{LAB}', f'{CONTROL}.nodes', 'none'),
    ):
        run = subprocess.run(
            [sys.executable, '-c', code, absent, package, left_out],
            capture_output=True,
            text=True,
            cwd=ROOT,
        )
        assert run.returncode == 0, run.stderr
        assert int(run.stdout.split()[-1]) >= 2
