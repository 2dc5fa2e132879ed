"""The README's parameter tables, made from the specs.

Renew them with `python -m omega_turn_lab.reference README.md`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import omega_turn_lab.ros_environment  # noqa: F401  (first: it may restart the interpreter)
from omega_turn_ros.nodes.admittance_node import ADMITTANCE_PARAMETERS
from omega_turn_ros.nodes.gait_parameters import GAIT_PARAMETERS
from omega_turn_ros.nodes.parameters import ParameterSpec
from omega_turn_sim_bridge.bridge_parameters import BRIDGE_PARAMETERS

NODES = {
    'gait_node': GAIT_PARAMETERS,
    'admittance_node': ADMITTANCE_PARAMETERS,
    'pybullet_bridge': BRIDGE_PARAMETERS,
}


def parameter_table(specs: Sequence[ParameterSpec]) -> str:
    """Markdown table of a node's parameters; `start` marks those that cannot change later."""
    rows = ['| parameter | default | accepts | set | meaning |', '|---|---|---|---|---|']
    for spec in specs:
        default = f'{spec.default:.6g}' if isinstance(spec.default, float) else f'{spec.default}'
        when = 'start' if spec.read_only else 'live'
        accepts = spec.expected.replace('|', '\\|')
        rows.append(
            f'| `{spec.name}` | `{default.lower()}` | {accepts} | {when} | {spec.description} |'
        )
    return '\n'.join(rows)


def with_tables(readme: str) -> str:
    """Return the README with the table of each node renewed between its two markers."""
    for node, specs in NODES.items():
        start, end = f'<!-- parameters {node} -->', '<!-- end -->'
        head, _, rest = readme.partition(start)
        _, _, tail = rest.partition(end)
        readme = f'{head}{start}\n\n{parameter_table(specs)}\n\n{end}{tail}'
    return readme


def main() -> int:
    """Renew the tables of the file named on the command line."""
    path = Path(sys.argv[1])
    path.write_text(with_tables(path.read_text()))
    return 0


if __name__ == '__main__':
    sys.exit(main())
