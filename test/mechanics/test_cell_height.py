"""Green's theorem on a grid, for connections with and without jumps."""

from __future__ import annotations

import numpy as np
import pytest

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.mechanics.cell_height import CellHeight

PHI = 2.0 * np.pi * (np.arange(101) + 0.5) / 100
W = np.linspace(-0.5, 0.5, 41)
MIDDLE_PHI, MIDDLE_W = 0.5 * (PHI[1:] + PHI[:-1]), 0.5 * (W[1:] + W[:-1])


def test_mean_is_the_curl_of_a_smooth_connection() -> None:
    along = np.sin(MIDDLE_PHI)[:, None] * W**2
    across = np.cos(2.0 * PHI)[:, None] * MIDDLE_W
    field = CellHeight.around(PHI, W, along, across)
    curl = -2.0 * np.sin(2.0 * MIDDLE_PHI)[:, None] * MIDDLE_W
    curl = curl - 2.0 * np.sin(MIDDLE_PHI)[:, None] * MIDDLE_W
    np.testing.assert_allclose(field.mean, curl, atol=2e-3)


def test_surface_is_what_a_path_over_a_jump_gains() -> None:
    """A_2 = 1 for phi in (1, 4): a path gains w(4) - w(1), and none of its cells knows a slope."""
    across = np.where((PHI > 1.0) & (PHI < 4.0), 1.0, 0.0)[:, None] * np.ones(MIDDLE_W.size)
    field = CellHeight.around(PHI, W, np.zeros((100, W.size)), across)

    def path(phi: np.ndarray | float) -> np.ndarray:
        return 0.3 * (1.0 - np.cos(phi)) / 2.0

    gained = path(4.0) - path(1.0)
    assert -field.surface(path(MIDDLE_PHI)) == pytest.approx(gained, abs=0.01)


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(BadInputError, match='connection'):
        CellHeight.around(PHI, W, np.zeros((100, 40)), np.zeros((101, 40)))
    field = CellHeight.around(PHI, W, np.zeros((100, 41)), np.zeros((101, 40)))
    with pytest.raises(BadInputError, match='path'):
        field.surface(np.full(100, 0.6))
