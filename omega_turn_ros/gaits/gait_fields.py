"""Checks of the parameters that a gait is made of, in code or in a library file."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

from omega_turn_ros.errors import BadInputError


def check_number(field: str, value: Any) -> None:
    """Refuse what is no finite number.

    Raises:
        BadInputError: names the field.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise BadInputError(f'gait field {field}', value, 'a number')
    if not math.isfinite(value):
        raise BadInputError(f'gait field {field}', value, 'a finite number')


def with_fields(parameters: Any, fields: Collection[str]) -> dict[str, Any]:
    """Return the parameters if they are a mapping of exactly these fields.

    Raises:
        BadInputError: they are not.
    """
    if not isinstance(parameters, dict) or set(parameters) != set(fields):
        expected = f'exactly the fields {sorted(fields)}'
        raise BadInputError('gait parameters', parameters, expected)
    return parameters
