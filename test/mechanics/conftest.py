"""Chains to put on the ground and motions to make them do."""

from __future__ import annotations

import numpy as np
import pytest
from plain_chain import RandomMotions

from omega_turn_ros.mechanics.chain import PlanarChain
from omega_turn_ros.robot import load_robot


@pytest.fixture(scope='session')
def chain() -> PlanarChain:
    """The paper's robot."""
    return PlanarChain.of_robot(load_robot('limbless16'))


@pytest.fixture(scope='session')
def uneven() -> PlanarChain:
    """Links of four lengths and an odd number of points each: nothing cancels by symmetry."""
    return PlanarChain([0.3, 0.1, 0.2, 0.15], weight=7.0, points_per_link=3)


@pytest.fixture(scope='session')
def motions(chain: PlanarChain) -> RandomMotions:
    """Forty shapes of up to 60 deg per joint with every joint on the move."""
    rng = np.random.default_rng(20240607)
    angles = rng.uniform(-1.05, 1.05, (40, chain.n_joints))
    rates = rng.normal(0.0, 0.6, (40, chain.n_joints))
    return RandomMotions(angles, rates)
