"""Vocabulary of a robot description: primitives, links, joints, robots; inertia of primitives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Vec3 = tuple[float, float, float]
ZERO: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Box:
    """Solid box; `xyz` [m] and `rpy` [rad] (fixed-axis) place its centre in the link frame."""

    name: str
    size: Vec3
    xyz: Vec3 = ZERO
    rpy: Vec3 = ZERO

    @property
    def volume(self) -> float:
        """[m^3]"""
        return math.prod(self.size)

    def unit_inertia(self) -> NDArray[np.float64]:
        """(3, 3) [m^2] inertia about the centre per kilogram, box axes."""
        squares = np.square(self.size)
        return np.diag((squares.sum() - squares) / 12.0)


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """Solid cylinder along its own z; `xyz` [m] and `rpy` [rad] place its centre in the link."""

    name: str
    radius: float
    length: float
    xyz: Vec3 = ZERO
    rpy: Vec3 = ZERO

    @property
    def volume(self) -> float:
        """[m^3]"""
        return math.pi * self.radius**2 * self.length

    def unit_inertia(self) -> NDArray[np.float64]:
        """(3, 3) [m^2] inertia about the centre per kilogram, cylinder axes."""
        across = (3.0 * self.radius**2 + self.length**2) / 12.0
        return np.diag([across, across, self.radius**2 / 2.0])


Primitive = Box | Cylinder


@dataclass(frozen=True, kw_only=True)
class Inertia:
    """Mass [kg], centre of mass [m] and inertia about it [kg m^2], all in the link frame."""

    mass: float
    com: Vec3
    xx: float
    yy: float
    zz: float
    xy: float = 0.0
    xz: float = 0.0
    yz: float = 0.0

    @classmethod
    def of_matrix(cls, mass: float, com: Vec3, tensor: NDArray[np.float64]) -> Inertia:
        """From a symmetric inertia tensor (3, 3) [kg m^2]."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor.tolist()
        return cls(mass=mass, com=com, xx=xx, yy=yy, zz=zz, xy=xy, xz=xz, yz=yz)

    def matrix(self) -> NDArray[np.float64]:
        """(3, 3) [kg m^2] symmetric inertia tensor."""
        return np.array(
            [
                [self.xx, self.xy, self.xz],
                [self.xy, self.yy, self.yz],
                [self.xz, self.yz, self.zz],
            ]
        )


@dataclass(frozen=True, kw_only=True)
class Link:
    """Rigid body, or a mere frame when it has neither inertia nor collision shapes."""

    name: str
    inertia: Inertia | None = None
    collisions: tuple[Primitive, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Joint whose child frame is parent * Trans(xyz) * Rot(rpy) * Rot(axis, q)."""

    name: str
    parent: str
    child: str
    xyz: Vec3 = ZERO
    rpy: Vec3 = ZERO
    type: Literal["revolute", "fixed"] = "fixed"
    axis: Vec3 = (0.0, 0.0, 1.0)
    lower: float = 0.0
    """[rad]"""
    upper: float = 0.0
    """[rad]"""
    velocity: float = 0.0
    """[rad/s] limit"""
    effort: float = 0.0
    """[Nm] limit"""


@dataclass(frozen=True, kw_only=True)
class Robot:
    """Kinematic tree of an arm with a hand."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    root: str

    def link(self, name: str) -> Link:
        """The link called `name`."""
        return next(link for link in self.links if link.name == name)

    def joint(self, name: str) -> Joint:
        """The joint called `name`."""
        return next(joint for joint in self.joints if joint.name == name)


def rotation(rpy: Sequence[float]) -> NDArray[np.float64]:
    """(3, 3) matrix Rz(yaw) Ry(pitch) Rx(roll) of fixed-axis angles [rad]."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_of(turn: NDArray[np.float64]) -> Vec3:
    """Fixed-axis angles [rad] of a rotation (3, 3): what `rotation` makes it from."""
    turn = np.round(turn, 12) + 0.0  # Else the last bit decides between pi and -pi.
    flat = math.hypot(turn[0, 0], turn[1, 0])
    pitch = math.atan2(-turn[2, 0], flat)
    if flat < 1e-9:  # Roll and yaw turn about the same axis.
        return math.atan2(-turn[1, 2], turn[1, 1]), pitch, 0.0
    return math.atan2(turn[2, 1], turn[2, 2]), pitch, math.atan2(turn[1, 0], turn[0, 0])


def inertia_of_primitives(mass: float, com: Vec3, primitives: Sequence[Primitive]) -> Inertia:
    """Inertia of a body of even density made of `primitives`, carried over to a given `com`.

    Overlaps of primitives count twice. The tensor is taken about the primitives' own centroid,
    so that a `com` which was measured or estimated elsewhere does not inflate it.
    """
    volumes = np.array([primitive.volume for primitive in primitives])
    masses = mass * volumes / volumes.sum()
    centres = np.array([primitive.xyz for primitive in primitives])
    arms = centres - masses @ centres / mass
    tensor = np.zeros((3, 3))
    for part_mass, arm, primitive in zip(masses, arms, primitives, strict=True):
        turn = rotation(primitive.rpy)
        tensor += part_mass * turn @ primitive.unit_inertia() @ turn.T
        tensor += part_mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertia.of_matrix(mass, com, tensor)
