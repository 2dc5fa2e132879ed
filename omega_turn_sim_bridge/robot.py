"""The limbless robot as URDF: for PyBullet, and for robot_state_publisher and RViz."""

from __future__ import annotations

import math
from xml.etree import ElementTree as ET

from omega_turn_ros.robot import Robot

FOOT_RADIUS = 0.005  # [m] spheres the body stands on
FOOT_CLEARANCE = 0.001  # [m] of the feet below the box, far above the contact's sag
GAUSS = 1.0 / (2.0 * math.sqrt(3.0))  # two-point Gauss nodes of a unit line
STANCE = 0.005  # [m] feet alternate left and right of the axis by this, or the body rolls over
# [kg m^2] per body, all axes: what geared motors reflect. Bullet solves friction per world axis,
# so a foot's force leaves the direction of its slip where the body yields unevenly (46 deg off for
# bare boxes, an offset turn 9 % short); inertia far above the box's own evens that out.
REFLECTED_INERTIA = 0.01
SOLID_LIFT = 0.002  # [m] of solid bodies, out of reach of contact search with level ground


def ride_height(robot: Robot) -> float:
    """Height of the body axis above level ground with the feet just touching [m]."""
    return 0.5 * robot.module_width + FOOT_CLEARANCE


def urdf_from_robot(robot: Robot, solid: str = '') -> str:
    """Describe the robot as a chain of boxes, head first, each on two spheres per module length.

    The spheres sit at the Gauss nodes of their module, so they load the ground as a uniform line
    would (mean and second moment). The head is the base; its frame is at joint 1, x forward.

    Args:
        robot: the robot.
        solid: what each body collides with besides its feet: '' nothing, enough on level ground;
            'round' capsules, smooth along upright pegs; 'square' boxes.

    Returns:
        URDF text. Link `head`, then `module_1`.. named after the joint in front of each.
    """
    root = ET.Element('robot', name=robot.name)
    for name, rgba in (
        ('head', '0.85 0.33 0.1 1'),
        ('even', '0.2 0.3 0.4 1'),
        ('odd', '0.3 0.45 0.55 1'),
    ):
        ET.SubElement(ET.SubElement(root, 'material', name=name), 'color', rgba=rgba)
    head = _add_body(root, robot, 'head', robot.head_length, 0.5 * robot.head_length, 'head', 0)
    if solid:
        _add_solid(head, robot, (0.0, robot.head_length), (False, True), solid)
    parent, joint_x = 'head', 0.0
    for i, (name, axis) in enumerate(zip(robot.joint_names, robot.joint_axes)):
        child = f'module_{i + 1}'
        colour = 'odd' if axis == 'yaw' else 'even'
        middle = -0.5 * robot.module_length
        body = _add_body(root, robot, child, robot.module_length, middle, colour, i)
        if solid:
            last = i == robot.n_joints - 1
            _add_solid(body, robot, (-robot.module_length, 0.0), (last, False), solid)
        joint = ET.SubElement(root, 'joint', name=name, type='revolute')
        ET.SubElement(joint, 'parent', link=parent)
        ET.SubElement(joint, 'child', link=child)
        ET.SubElement(joint, 'origin', xyz=f'{joint_x} 0 0', rpy='0 0 0')
        ET.SubElement(joint, 'axis', xyz='0 0 1' if axis == 'yaw' else '0 1 0')
        ET.SubElement(
            joint,
            'limit',
            lower=str(-robot.position_limit),
            upper=str(robot.position_limit),
            effort=str(robot.effort_limit),
            velocity=str(robot.velocity_limit),
        )
        parent, joint_x = child, -robot.module_length
    ET.indent(root)
    return ET.tostring(root, encoding='unicode')


def _add_body(
    root: ET.Element,
    robot: Robot,
    name: str,
    length: float,
    centre: float,
    colour: str,
    first_segment: int,
) -> ET.Element:
    """Append and return one box of the given length whose middle lies at x = centre."""
    link = ET.SubElement(root, 'link', name=name)
    mass = robot.module_mass * length / robot.module_length
    width = robot.module_width
    inertial = ET.SubElement(link, 'inertial')
    ET.SubElement(inertial, 'origin', xyz=f'{centre} 0 0')
    ET.SubElement(inertial, 'mass', value=str(mass))
    rotor = REFLECTED_INERTIA
    roll = mass * width**2 / 6.0 + rotor
    bend = mass * (width**2 + length**2) / 12.0 + rotor
    ET.SubElement(
        inertial, 'inertia', ixx=str(roll), iyy=str(bend), izz=str(bend), ixy='0', ixz='0', iyz='0'
    )
    visual = ET.SubElement(link, 'visual')
    ET.SubElement(visual, 'origin', xyz=f'{centre} 0 0')
    box = ET.SubElement(ET.SubElement(visual, 'geometry'), 'box')
    box.set('size', f'{0.96 * length} {width} {width}')
    ET.SubElement(visual, 'material', name=colour)
    segments = max(1, round(length / robot.module_length))
    span = length / segments
    for k in range(segments):
        # Neighbouring modules put the front foot on opposite sides, so no turn is favoured.
        handed = 1.0 if (first_segment + k) % 2 == 0 else -1.0
        middle = centre - 0.5 * length + (k + 0.5) * span
        for end, side in ((1.0, handed), (-1.0, -handed)):
            collision = ET.SubElement(link, 'collision')
            x, y = middle + end * GAUSS * span, side * STANCE
            z = -ride_height(robot) + FOOT_RADIUS
            ET.SubElement(collision, 'origin', xyz=f'{x} {y} {z}')
            foot = ET.SubElement(ET.SubElement(collision, 'geometry'), 'sphere')
            foot.set('radius', str(FOOT_RADIUS))
    return link


def _add_solid(
    link: ET.Element,
    robot: Robot,
    along: tuple[float, float],
    is_tip: tuple[bool, bool],
    solid: str,
) -> None:
    """Make a body solid from x to x [m]; round ends reach half around joints, none past a tip."""
    collision = ET.SubElement(link, 'collision')
    geometry = ET.SubElement(collision, 'geometry')
    width = robot.module_width
    if solid == 'square':
        origin = f'{sum(along) / 2} 0 {SOLID_LIFT}'
        ET.SubElement(collision, 'origin', xyz=origin)
        box = ET.SubElement(geometry, 'box')
        box.set('size', f'{along[1] - along[0]} {width} {width}')
        return
    back = along[0] + 0.5 * width * is_tip[0]
    front = along[1] - 0.5 * width * is_tip[1]
    origin = f'{(back + front) / 2} 0 {SOLID_LIFT}'
    ET.SubElement(collision, 'origin', xyz=origin, rpy=f'0 {math.pi / 2} 0')
    capsule = ET.SubElement(geometry, 'capsule')
    capsule.set('radius', str(0.5 * width))
    capsule.set('length', str(front - back))
