"""How feet that are down share the weight of a body above them (own derivation).

'equal' is the paper's assumption. It leaves a moment: five feet, three of them on one side, cannot
bear equal loads with the centre of mass between the sides. 'static' is what a stiff body on feet
that give equally does: loads are linear in the place of the foot, sum N = 1 and sum N p = the
centre of mass, taken at the origin of the mean body frame; a foot that would have to pull carries
nothing.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def equal_loads(feet: Array, down: Flags) -> Array:
    """Equal share for every foot that is down, sum 1.

    Args:
        feet: places [m], shape (..., P, 2).
        down: which carry, shape (..., P).

    Returns:
        Loads, shape (..., P).
    """
    del feet
    share: Array = down / down.sum(axis=-1, keepdims=True)
    return share


def static_loads(feet: Array, down: Flags) -> Array:
    """Loads of a stiff body on equally soft feet, sum 1; arguments as `equal_loads`."""
    basis = np.concatenate([np.ones_like(feet[..., :1]), feet], axis=-1)
    wanted = np.array([1.0, 0.0, 0.0])
    carries = down.copy()
    loads = np.zeros(down.shape)
    for _ in range(down.shape[-1]):
        # Few or aligned feet cannot bear every moment: the pseudo-inverse comes nearest.
        held = basis * carries[..., None]
        gram = np.swapaxes(held, -1, -2) @ held
        plane = (np.linalg.pinv(gram, hermitian=True) @ wanted)[..., None]
        loads = (held @ plane)[..., 0]
        if not (loads < 0.0).any():
            break
        # One at a time: without it the others may find that they push after all.
        worst = loads == loads.min(axis=-1, keepdims=True)
        carries &= ~(worst & (loads < 0.0))
    total: Array = loads.sum(axis=-1, keepdims=True)
    return loads / total


LOADS: dict[str, Callable[[Array, Flags], Array]] = {
    'equal': equal_loads,
    'static': static_loads,
}
