"""Importing this makes ROS 2 ready on this machine. It goes before all that uses rclpy.

- Discovery stays on this machine unless ROS_AUTOMATIC_DISCOVERY_RANGE says otherwise.
- AMENT_PREFIX_PATH, which pip's wheels leave unset, points to the Python prefix.
- rclpy from pip's wheels restarts the interpreter once to set its library path. Importing it
  here, first, means that nothing is done twice. pytest loads this module with `-p` therefore.
"""

from __future__ import annotations

import importlib.util
import os
import sys

os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
os.environ.setdefault('AMENT_PREFIX_PATH', sys.prefix)

HAS_ROS = importlib.util.find_spec('rclpy') is not None

if HAS_ROS:
    import rclpy  # noqa: F401
