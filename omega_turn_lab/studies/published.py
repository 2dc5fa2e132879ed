"""The paper's own numbers, read from `paper_results.yaml`."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Any

import yaml


@cache
def _figures() -> dict[str, list[dict[str, Any]]]:
    source = resources.files('omega_turn_lab.studies') / 'paper_results.yaml'
    figures: dict[str, list[dict[str, Any]]] = yaml.safe_load(source.read_text(encoding='utf-8'))
    return figures


def paper_figure(
    study: str, quantity: str, params: dict[str, float]
) -> tuple[float | None, float | None]:
    """Mean and standard deviation the paper gives, None where it gives none.

    Args:
        study: name of the study.
        quantity: such as 'angle'.
        params: N, k_f, k_t and theta_max_deg.
    """
    for entry in _figures().get(study, []):
        if entry['quantity'] == quantity and all(
            entry[name] == value for name, value in params.items() if name in entry
        ):
            return entry['value'], entry['std']
    return None, None
