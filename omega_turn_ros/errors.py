"""The package's error tree: every leaf also inherits the built-in a caller would expect."""

from __future__ import annotations


class OmegaTurnError(Exception):
    """Root of all errors raised on purpose by this project."""


class BadInputError(OmegaTurnError, ValueError):
    """A value from outside is unusable: names the field, the value and what was expected.

    Args:
        field: name of the offending field, as the user wrote it.
        value: the offending value.
        expected: what would have been accepted, units included.
    """

    def __init__(self, field: str, value: object, expected: str) -> None:
        self.field = field
        self.value = value
        self.expected = expected
        super().__init__(f'{field}: got {value!r}, expected {expected}')


class RosArgumentsError(OmegaTurnError, ValueError):
    """ROS 2 refuses its arguments, a parameter file or the domain."""


class ConvergenceError(OmegaTurnError, ArithmeticError):
    """An iterative solver stopped short of its tolerance."""


class SimulationError(OmegaTurnError, RuntimeError):
    """The physics engine is missing, closed, or left the realm of finite numbers."""


class MissingPackageError(OmegaTurnError, ImportError):
    """An optional package is not installed.

    Args:
        package: its name on PyPI.
        extra: of this package, which brings it.
        otherwise: how to do without.
    """

    def __init__(self, package: str, extra: str, otherwise: str = '') -> None:
        self.package = package
        hint = f"pip install '{package}' (it comes with the extra '{extra}')"
        super().__init__(
            f'{package} is not installed: ' + ', or '.join(filter(None, (hint, otherwise)))
        )
