"""Choosing gaits: calibration of angle over amplitude, and what stands on it."""
