"""Turning control for elongate robots: two-wave gaits, their mechanics, compliance and nodes."""

__version__ = '0.1.0'
