"""The legged robot as URDF: segments in a row, and two legs of two joints on each."""

from __future__ import annotations

from xml.etree import ElementTree as ET

from omega_turn_ros.robot import LEG_PAIR, LeggedRobot

SOLE_RADIUS = 0.008  # [m] of the sphere a leg stands on
HIP_MASS = 0.2  # of a leg's mass in the hip, which swings only
# [kg m^2] per body, all axes: what geared motors reflect, see `robot.REFLECTED_INERTIA`.
SEGMENT_ROTOR = 0.01
LEG_ROTOR = 0.002
COLOURS = {'head': '0.85 0.33 0.1 1', 'segment': '0.25 0.37 0.47 1', 'leg': '0.55 0.58 0.6 1'}


def legged_urdf(robot: LeggedRobot) -> str:
    """Describe the robot: boxes in a row; on each two legs that swing and lift, one sphere each.

    Segment 1 is the base; its frame is at the yaw joint behind it, x forward, as a limbless
    robot's head. Nothing but the spheres can touch.

    Args:
        robot: the robot.

    Returns:
        URDF text, joints in the robot's order. Links `segment_i`, and `hip_i_left`, `leg_i_left`,
        `hip_i_right`, `leg_i_right`, i = 1..n.
    """
    root = ET.Element('robot', name=robot.name)
    for name, rgba in COLOURS.items():
        ET.SubElement(ET.SubElement(root, 'material', name=name), 'color', rgba=rgba)
    names = iter(robot.joint_names)
    for i, (length, mass) in enumerate(zip(robot.body_lengths, robot.body_masses), start=1):
        middle = (0.5 if i == 1 else -0.5) * length
        if i > 1:
            x = 0.0 if i == 2 else -robot.module_length
            parents = (f'segment_{i - 1}', f'segment_{i}')
            _add_joint(root, robot, next(names), parents, (x, 0.0), '0 0 1')
        _add_segment(root, robot, i, middle, float(mass))
        for left, side in ((1, 'left'), (-1, 'right')):
            _add_leg(root, robot, f'{i}_{side}', middle, left)
            hip, foot = f'hip_{i}_{side}', f'leg_{i}_{side}'
            at = (middle, left * robot.legs.hip_offset)
            # Swing > 0 is forward and lift > 0 is up on either side.
            _add_joint(root, robot, next(names), (f'segment_{i}', hip), at, f'0 0 {-left}')
            _add_joint(root, robot, next(names), (hip, foot), (0.0, 0.0), f'{left} 0 0')
    ET.indent(root)
    return ET.tostring(root, encoding='unicode')


def foot_links(robot: LeggedRobot) -> list[int]:
    """Places of the lift joints among the robot's, whose links the feet belong to."""
    return [i for i, axis in enumerate(robot.joint_axes) if axis == LEG_PAIR[1]]


def _add_segment(
    root: ET.Element, robot: LeggedRobot, number: int, middle: float, mass: float
) -> None:
    """Append a box without legs whose middle lies at x = middle."""
    link = ET.SubElement(root, 'link', name=f'segment_{number}')
    length, width = float(robot.body_lengths[number - 1]), robot.module_width
    size = (0.8 * length, width, 0.6 * width)
    _add_inertia(link, (middle, 0.0, 0.0), mass, size, SEGMENT_ROTOR)
    _add_box(link, (middle, 0.0, 0.0), size, 'head' if number == 1 else 'segment')


def _add_leg(root: ET.Element, robot: LeggedRobot, name: str, middle: float, left: int) -> None:
    """Append a hip, and the leg on it: outwards, then down to its sphere."""
    legs = robot.legs
    hip = ET.SubElement(root, 'link', name=f'hip_{name}')
    size = 0.4 * robot.module_width
    _add_inertia(hip, (0.0, 0.0, 0.0), HIP_MASS * legs.mass, (size, size, size), LEG_ROTOR)
    _add_box(hip, (0.0, 0.0, 0.0), (size, size, size), 'leg')
    leg = ET.SubElement(root, 'link', name=f'leg_{name}')
    out, thick = left * legs.reach, 1.5 * SOLE_RADIUS
    _add_inertia(
        leg,
        (0.0, 0.5 * out, 0.0),
        (1.0 - HIP_MASS) * legs.mass,
        (thick, legs.reach, thick),
        LEG_ROTOR,
    )
    _add_box(leg, (0.0, 0.5 * out, 0.0), (thick, legs.reach, thick), 'leg')
    _add_box(leg, (0.0, out, -0.5 * legs.height), (thick, thick, legs.height - thick), 'leg')
    collision = ET.SubElement(leg, 'collision')
    ET.SubElement(collision, 'origin', xyz=f'0 {out} {SOLE_RADIUS - legs.height}')
    sole = ET.SubElement(ET.SubElement(collision, 'geometry'), 'sphere')
    sole.set('radius', str(SOLE_RADIUS))


def _add_joint(
    root: ET.Element,
    robot: LeggedRobot,
    name: str,
    links: tuple[str, str],
    at: tuple[float, float],
    axis: str,
) -> None:
    joint = ET.SubElement(root, 'joint', name=name, type='revolute')
    ET.SubElement(joint, 'parent', link=links[0])
    ET.SubElement(joint, 'child', link=links[1])
    ET.SubElement(joint, 'origin', xyz=f'{at[0]} {at[1]} 0', rpy='0 0 0')
    ET.SubElement(joint, 'axis', xyz=axis)
    ET.SubElement(
        joint,
        'limit',
        lower=str(-robot.position_limit),
        upper=str(robot.position_limit),
        effort=str(robot.effort_limit),
        velocity=str(robot.velocity_limit),
    )


def _add_inertia(
    link: ET.Element,
    at: tuple[float, float, float],
    mass: float,
    size: tuple[float, float, float],
    rotor: float,
) -> None:
    """Mass and inertia of a full box of that size [m], and of the motors on it."""
    inertial = ET.SubElement(link, 'inertial')
    ET.SubElement(inertial, 'origin', xyz='{} {} {}'.format(*at))
    ET.SubElement(inertial, 'mass', value=str(mass))
    xx, yy, zz = (edge**2 for edge in size)
    axes = {'ixx': yy + zz, 'iyy': xx + zz, 'izz': xx + yy}
    values = {name: str(mass * sum_ / 12.0 + rotor) for name, sum_ in axes.items()}
    ET.SubElement(inertial, 'inertia', {**values, 'ixy': '0', 'ixz': '0', 'iyz': '0'})


def _add_box(
    link: ET.Element,
    at: tuple[float, float, float],
    size: tuple[float, float, float],
    colour: str,
) -> None:
    visual = ET.SubElement(link, 'visual')
    ET.SubElement(visual, 'origin', xyz='{} {} {}'.format(*at))
    box = ET.SubElement(ET.SubElement(visual, 'geometry'), 'box')
    box.set('size', '{} {} {}'.format(*size))
    ET.SubElement(visual, 'material', name=colour)
