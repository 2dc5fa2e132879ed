"""Names in the ROS graph, checked before rcl sees them."""

from __future__ import annotations

import re

from omega_turn_ros.errors import BadInputError

LONGEST = 128  # characters; DDS has room for topics of 255 with what comes before and after
_PARTS = re.compile(r'[A-Za-z_]\w*(/[A-Za-z_]\w*)*', re.ASCII)


def check_namespace(text: str) -> str:
    """Return a namespace without outer slashes, '' for none.

    Raises:
        BadInputError: ROS 2 would refuse it.
    """
    name = text.strip('/')
    if name and (not _PARTS.fullmatch(name) or len(name) > LONGEST):
        expected = f'letters, digits and _, parts divided by / and not begun by a digit, {LONGEST}'
        raise BadInputError('namespace', text, f'{expected} characters at most')
    return name
