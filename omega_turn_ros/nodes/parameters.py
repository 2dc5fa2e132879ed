"""Parameters declared once: type, default, unit, bounds and description in one place."""

from __future__ import annotations

import array
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from omega_turn_ros.errors import BadInputError

Value = bool | int | float | str | list[float]

# For the constructor of a node with NodeParameters: the way to learn what the user gave.
DECLARE_GIVEN = {'automatically_declare_parameters_from_overrides': True}
OF_EVERY_NODE = ('use_sim_time', 'start_type_description_service')


@dataclass(frozen=True, slots=True)
class ParameterSpec:
    """One parameter.

    Attributes:
        name: as in `ros2 param set`.
        default: fixes the type; a list means that many numbers.
        description: one sentence.
        unit: of the number, '' for none.
        low: smallest allowed number; None for no bound.
        high: largest allowed number; None for no bound.
        choices: allowed strings; empty for any.
        read_only: set at start only.
    """

    name: str
    default: Value
    description: str
    unit: str = ''
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    read_only: bool = False

    @property
    def expected(self) -> str:
        """What `check` accepts, for people."""
        if isinstance(self.default, bool):
            return 'true or false'
        if isinstance(self.default, str):
            return f'one of {list(self.choices)}' if self.choices else 'text'
        kind = 'an integer' if isinstance(self.default, int) else 'a number'
        if isinstance(self.default, list):
            kind = f'{len(self.default)} numbers'
        bounds = ''
        if self.low is not None or self.high is not None:
            low = '-inf' if self.low is None else f'{self.low:g}'
            high = 'inf' if self.high is None else f'{self.high:g}'
            bounds = f' in [{low}, {high}]'
        return f'{kind}{bounds}' + (f' [{self.unit}]' if self.unit else '')

    def check(self, value: object) -> Value:
        """Return the value in the parameter's type.

        Raises:
            BadInputError: wrong type, not finite, out of bounds, or not a choice.
        """
        if isinstance(self.default, bool):
            if isinstance(value, bool):
                return value
        elif isinstance(self.default, str):
            if isinstance(value, str) and (not self.choices or value in self.choices):
                return value
        elif isinstance(self.default, list):
            values = list(value) if isinstance(value, Iterable) else []
            if len(values) == len(self.default) and all(self._is_number(v) for v in values):
                return [float(v) for v in values]
        elif self._is_number(value):
            if isinstance(self.default, float):
                return float(value)  # type: ignore[arg-type]
            if isinstance(value, int):
                return value
        shown = list(value) if isinstance(value, array.array) else value
        raise BadInputError(f'parameter {self.name}', shown, self.expected)

    def _is_number(self, value: object) -> bool:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return False
        low = -math.inf if self.low is None else self.low
        high = math.inf if self.high is None else self.high
        return math.isfinite(value) and low <= value <= high


class NodeParameters:
    """A node's parameters: declared from specs, checked at start and on every change.

    Args:
        node: the node that owns them.
        specs: all parameters of the node.
        accept: called with the complete new values before a change; raises BadInputError to
            refuse it.
        apply: called with the complete new values after a change.

    Raises:
        BadInputError: a start value is refused.
    """

    def __init__(
        self,
        node: Node,
        specs: Iterable[ParameterSpec],
        accept: Callable[[Mapping[str, Any]], None],
        apply: Callable[[Mapping[str, Any]], None],
    ) -> None:
        self._specs = {spec.name: spec for spec in specs}
        self._accept, self._apply = accept, apply
        self.values: dict[str, Any] = {}
        _take_back_given(node, self._specs)
        for spec in self._specs.values():
            # Dynamic typing lets `-p period:=8` pass for 8.0; `check` keeps the type.
            descriptor = ParameterDescriptor(
                description=f'{spec.description} [{spec.unit}]' if spec.unit else spec.description,
                additional_constraints=spec.expected,
                read_only=spec.read_only,
                dynamic_typing=True,
            )
            node.declare_parameter(spec.name, spec.default, descriptor)
            self.values[spec.name] = spec.check(node.get_parameter(spec.name).value)
        accept(self.values)
        node.add_on_set_parameters_callback(self._on_set)
        node.add_post_set_parameters_callback(self._post_set)

    def __getitem__(self, name: str) -> Any:
        """Present value of a parameter."""
        return self.values[name]

    def _merged(self, parameters: Iterable[Parameter]) -> dict[str, Any]:
        merged = dict(self.values)
        for parameter in parameters:
            if parameter.name in self._specs:
                merged[parameter.name] = self._specs[parameter.name].check(parameter.value)
        return merged

    def _on_set(self, parameters: list[Parameter]) -> SetParametersResult:
        try:
            self._accept(self._merged(parameters))
        except BadInputError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _post_set(self, parameters: list[Parameter]) -> None:
        self.values = self._merged(parameters)
        self._apply(self.values)


def _take_back_given(node: Node, known: Iterable[str]) -> None:
    """Undeclare what the user gave: known names are declared anew, others were a mistake."""
    given = set(node.list_parameters([], 0).names) - set(OF_EVERY_NODE)
    for name in given:
        node.undeclare_parameter(name)
    unknown = sorted(name for name in given - set(known) if not name.startswith('qos_overrides.'))
    if unknown:
        text = f'parameters that {node.get_name()} does not have are ignored'
        node.get_logger().warning(f'{text}: {", ".join(unknown)}')
