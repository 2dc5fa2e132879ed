"""Where the shipped configuration lives, whichever way the package was installed."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import resources
from pathlib import Path
from typing import Any

import yaml

from omega_turn_ros.errors import BadInputError


def config_root() -> Path:
    """Return the `config` folder: package data when installed, the source tree otherwise."""
    packaged = Path(str(resources.files('omega_turn_ros'))) / 'config'
    if packaged.is_dir():
        return packaged
    return Path(__file__).resolve().parent.parent / 'config'


def config_names(folder: str) -> list[str]:
    """Return the sorted stems of the YAML files in `config/<folder>`."""
    return sorted(entry.stem for entry in (config_root() / folder).glob('*.yaml'))


def read_config(folder: str, name: str) -> dict[str, Any]:
    """Read one mapping from a file path or from the shipped `config/<folder>/<name>.yaml`.

    Args:
        folder: `'robots'`, `'gaits'` or `'terrains'`.
        name: a shipped name such as `'limbless16'`, or a path ending in `.yaml`.

    Raises:
        BadInputError: no such file, no valid YAML, or its top level is not a mapping.
    """
    if name.endswith(('.yaml', '.yml')):
        entry = Path(name).expanduser()
    else:
        entry = config_root() / folder / f'{name}.yaml'
    field = folder.removesuffix('s')
    if not entry.is_file():
        raise BadInputError(
            field, name, f'a path to a .yaml file or one of {config_names(folder)}'
        )
    try:
        data = yaml.safe_load(entry.read_text(encoding='utf-8'))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise BadInputError(field, name, f'valid YAML ({error})') from error
    if not isinstance(data, dict):
        raise BadInputError(field, name, 'a YAML mapping at the top level')
    return data


def fields_apart(data: Iterable[object], expected: Iterable[str]) -> str:
    """Return for people which fields should not be there and which are missing."""
    unknown, missing = set(map(str, data)) - set(expected), set(expected) - set(map(str, data))
    named = (('unknown', unknown), ('missing', missing))
    return ', '.join(f'{what}: {" ".join(sorted(some))}' for what, some in named if some)
