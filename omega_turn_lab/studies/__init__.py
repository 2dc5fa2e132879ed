"""One study per table or figure of the paper: run it, print ours beside the paper's, draw it."""

from __future__ import annotations

NAMES = (
    'flat',
    'evolution',
    'amplitude',
    'frequency',
    'joints',
    'granular',
    'pegboard',
    'rocks',
    'height',
    'legged',
    'sensitivity',
    'beyond',
)
