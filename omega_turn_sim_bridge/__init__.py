"""A PyBullet robot that stands in for hardware behind the same topics."""
