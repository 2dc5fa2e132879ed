"""What a robot is to this package: joint names, axes, limits, the planar chain, and any legs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from omega_turn_ros.errors import BadInputError
from omega_turn_ros.resources import fields_apart, read_config

AXES = ('yaw', 'pitch')
LEG_PAIR = ('swing', 'lift', 'swing', 'lift')  # axes of the joints of one leg pair, left leg first


@dataclass(frozen=True, slots=True)
class Robot:
    """A limbless chain of modules, head to tail.

    Attributes:
        name: what people call it.
        joint_names: all joints, head to tail, shape (n_joints,).
        joint_axes: 'yaw' (+ = counter-clockwise seen from above) or 'pitch', shape (n_joints,).
        module_length: distance between neighbouring joints [m].
        module_width: body width [m].
        head_length: body in front of the first joint [m].
        module_mass: mass per module length of body [kg].
        position_limit: each joint stays within +- this [rad].
        velocity_limit: largest joint speed [rad/s].
        effort_limit: largest actuator torque [N m].
        effort_sign: +1 where a positive effort drives its joint towards positive angles, else -1.
    """

    name: str
    joint_names: tuple[str, ...]
    joint_axes: tuple[str, ...]
    module_length: float
    module_width: float
    head_length: float
    module_mass: float
    position_limit: float
    velocity_limit: float
    effort_limit: float
    effort_sign: int

    @property
    def n_joints(self) -> int:
        """Number of joints of either axis."""
        return len(self.joint_names)

    @property
    def yaw_indices(self) -> NDArray[np.intp]:
        """Indices of the yaw joints in `joint_names`, shape (N,)."""
        return np.array([i for i, axis in enumerate(self.joint_axes) if axis == 'yaw'], np.intp)

    @property
    def n_yaw(self) -> int:
        """N of the wave equations: the number of yaw joints."""
        return self.joint_axes.count('yaw')

    @property
    def body_lengths(self) -> NDArray[np.float64]:
        """Length of each rigid body [m], head first, shape (n_joints + 1,)."""
        return np.array([self.head_length] + [self.module_length] * self.n_joints)

    @property
    def body_masses(self) -> NDArray[np.float64]:
        """Mass of each rigid body [kg], head first, shape (n_joints + 1,)."""
        return self.module_mass * self.body_lengths / self.module_length

    @property
    def planar_link_lengths(self) -> NDArray[np.float64]:
        """Lengths of the rigid links between yaw joints [m], shape (N + 1,)."""
        lengths = [self.head_length]
        for axis in self.joint_axes:
            if axis == 'yaw':
                lengths.append(0.0)
            lengths[-1] += self.module_length
        return np.array(lengths)

    @property
    def length(self) -> float:
        """Body length BL [m]."""
        return float(self.body_lengths.sum())

    @property
    def weight(self) -> float:
        """Total weight on level ground [N]."""
        return float(self.body_masses.sum()) * STANDARD_GRAVITY

    def with_yaw_joints(self, count: int) -> Robot:
        """Return the front of this robot, cut off before its yaw joint number `count` + 1.

        Raises:
            BadInputError: fewer than 2, or more than the robot has.
        """
        if not 2 <= count <= self.n_yaw:
            raise BadInputError('yaw joints', count, f'2..{self.n_yaw}, those of {self.name}')
        if count == self.n_yaw:
            return self
        cut = int(self.yaw_indices[count])
        return replace(
            self,
            name=f'{self.name}_{count}_yaw',
            joint_names=self.joint_names[:cut],
            joint_axes=self.joint_axes[:cut],
        )


@dataclass(frozen=True, slots=True)
class Legs:
    """Legs of one robot, all alike; each foot hangs from a bent leg below and beside its hip.

    Attributes:
        hip_offset: of the swing axes from the body axis [m].
        reach: foot beside its swing axis when down [m].
        height: of the body axis above the ground when the feet are down [m].
        mass: of one leg [kg].
    """

    hip_offset: float
    reach: float
    height: float
    mass: float


@dataclass(frozen=True, slots=True)
class LeggedRobot(Robot):
    """Segments with a leg pair in the middle of each and a yaw joint between neighbours.

    Joints, head to tail: swing and lift of the left leg, of the right leg, then the yaw joint to
    the next segment. Swing > 0 moves the foot forward, lift > 0 up. `head_length` is the length of
    the first segment, `module_length` of the others, `module_mass` their mass without legs.

    Attributes:
        legs: what all legs share.
    """

    legs: Legs

    @property
    def n_pairs(self) -> int:
        """Number of leg pairs."""
        return self.n_yaw + 1

    @property
    def body_lengths(self) -> NDArray[np.float64]:
        """Length of each segment [m], head first, shape (n_pairs,)."""
        return np.array([self.head_length] + [self.module_length] * self.n_yaw)

    @property
    def planar_link_lengths(self) -> NDArray[np.float64]:
        """See `Robot.planar_link_lengths`: the segments."""
        return self.body_lengths

    @property
    def weight(self) -> float:
        """Total weight on level ground [N]."""
        legs = 2 * self.n_pairs * self.legs.mass
        return (float(self.body_masses.sum()) + legs) * STANDARD_GRAVITY


STANDARD_GRAVITY = 9.81  # [m/s^2], the value the simulator uses too


def load_robot(name: str) -> Robot:
    """Read a robot from `config/robots/<name>.yaml` or from a path ending in `.yaml`.

    Raises:
        BadInputError: the file is missing, or a field is missing, unknown or out of range.
    """
    return robot_from_mapping(read_config('robots', name))


def robot_from_mapping(data: dict[str, Any]) -> Robot:
    """Check a mapping field by field and build the robot it describes, legged if it has `legs`.

    Raises:
        BadInputError: a field is missing, unknown or out of range.
    """
    numbers = (
        'module_length',
        'module_width',
        'head_length',
        'module_mass',
        'position_limit',
        'velocity_limit',
        'effort_limit',
    )
    optional = {'name', 'effort_sign', 'legs'}
    known = {'joints', *numbers} | (optional & set(data))
    if not set(data) <= known:
        expected = f'the fields of a robot file ({fields_apart(data, known)})'
        raise BadInputError('robot', data.get('name'), expected)
    legs = _check_legs(data['legs']) if 'legs' in data else None
    names, axes = _check_joints(data.get('joints'), AXES if legs is None else ('yaw', *LEG_PAIR))
    values = {key: _check_positive(key, data.get(key)) for key in numbers}
    if values['position_limit'] > math.pi:
        raise BadInputError('position_limit', values['position_limit'], 'at most pi [rad]')
    sign = data.get('effort_sign', 1)
    if sign not in (1, -1):
        raise BadInputError('effort_sign', sign, '1 or -1')
    name = str(data.get('name', 'robot'))
    if legs is None:
        return Robot(name, names, axes, effort_sign=sign, **values)
    if axes != (*LEG_PAIR, *(('yaw', *LEG_PAIR) * axes.count('yaw'))):
        raise BadInputError('joints', list(axes), f'{LEG_PAIR}, then yaw and {LEG_PAIR} in turn')
    return LeggedRobot(name, names, axes, effort_sign=sign, legs=legs, **values)


def _check_legs(legs: object) -> Legs:
    fields = Legs.__slots__
    if not isinstance(legs, dict) or set(legs) != set(fields):
        raise BadInputError('legs', legs, f'a mapping with exactly {", ".join(fields)}')
    return Legs(**{key: _check_positive(f'legs.{key}', legs[key]) for key in fields})


def _check_positive(field: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise BadInputError(field, value, 'a number > 0')
    if not math.isfinite(value) or value <= 0.0:
        raise BadInputError(field, value, 'a finite number > 0')
    return float(value)


def _check_joints(
    joints: object, known: tuple[str, ...]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    if not isinstance(joints, Sequence) or isinstance(joints, str) or not joints:
        raise BadInputError('joints', joints, 'a list of {name, axis}, head to tail')
    names, axes = [], []
    for i, joint in enumerate(joints):
        field = f'joints[{i}]'
        if not isinstance(joint, dict) or set(joint) != {'name', 'axis'}:
            raise BadInputError(field, joint, 'a mapping with exactly name and axis')
        if joint['axis'] not in known:
            raise BadInputError(f'{field}.axis', joint['axis'], f'one of {known}')
        if not isinstance(joint['name'], str) or not joint['name'] or joint['name'] in names:
            raise BadInputError(f'{field}.name', joint['name'], 'a name used once')
        names.append(joint['name'])
        axes.append(joint['axis'])
    if axes.count('yaw') < 2:
        raise BadInputError('joints', axes.count('yaw'), 'at least 2 yaw joints')
    return tuple(names), tuple(axes)
