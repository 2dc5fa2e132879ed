"""Gaits with rounded parameters, designed elsewhere on the paper's robot: a fixed yardstick.

Each was optimised for the largest angle per cycle under its joint limit with N = 8, k_f = 1.5,
14 cm links, isotropic Coulomb friction.
"""

from __future__ import annotations

import math

from omega_turn_ros.gaits.two_wave_gait import TwoWaveGait

STARTING_GAITS: dict[str, tuple[str, float, TwoWaveGait]] = {
    'omega': (
        # At 90 deg head and tail would overlap by 5 mm; half a degree less clears them.
        'Omega turn, k_t = 1, joint limit 90 deg (89.5 used: head and tail just clear)',
        math.radians(89.5),
        TwoWaveGait(1.5, 1.0, 0.59, 0.0, -1.02, -0.78, -2.75, -3.07),
    ),
    'omega_75': (
        'Omega turn, k_t = 1, joint limit 75 deg',
        math.radians(75.0),
        TwoWaveGait(1.5, 1.0, -0.47, 0.05, -0.97, -0.66, 0.33, -2.8),
    ),
    'omega_60': (
        'Omega turn, k_t = 1, joint limit 60 deg',
        math.radians(60.0),
        TwoWaveGait(1.5, 1.0, 0.38, 0.01, -1.0, -0.52, -2.74, -3.0),
    ),
    'offset': (
        'Offset turn with time-varying offset, k_t = 0, joint limit 90 deg',
        math.radians(90.0),
        TwoWaveGait(1.5, 0.0, 1.32, 0.2, -1.03, 0.32, -0.19, -3.99),
    ),
    'geometric': (
        'Geometric turn, k_t = k_f = 1.5, joint limit 90 deg',
        math.radians(90.0),
        TwoWaveGait(1.5, 1.5, 0.72, 1.07, 0.28, 0.73, 4.08, -1.29),
    ),
}
