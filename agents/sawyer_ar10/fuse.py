"""Fuses links that cannot move against each other: PhysX pays for every link, moving or not.

Mass, centre of mass and inertia add up by the parallel axis theorem, shapes and joints keep their
places, so the robot moves as before.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.agents.robot_model import (
    Inertia,
    Joint,
    Link,
    Primitive,
    Robot,
    Vec3,
    rotation,
    rpy_of,
)

Placed = TypeVar("Placed", Primitive, Joint)
Transform = NDArray[np.float64]
"""(4, 4) homogeneous."""


@dataclass(frozen=True)
class Fusion:
    """A robot without the joints that never move."""

    robot: Robot
    frames: dict[str, tuple[str, Transform]]
    """Every link of the original robot -> the link that carries it, and its pose there."""


def fuse(robot: Robot, keep: Collection[str]) -> Fusion:
    """Fuse every link that hangs on a fixed joint with its parent, unless both are to be kept.

    The parent takes the child in; a child that is to be kept takes its parent in.

    Args:
        robot: any robot.
        keep: links that shall still be there, with the same frame; the root always is.

    Raises:
        ValueError: a link to be kept stands off the axis that its parent turns about.
    """
    frames = _carriers(robot, {*keep, robot.root})
    carriers = {carrier for carrier, _ in frames.values()}
    links = tuple(_body(robot, link, frames) for link in robot.links if link.name in carriers)
    joints = (_joint(joint, frames) for joint in robot.joints)
    left = tuple(joint for joint in joints if joint.parent != joint.child)
    return Fusion(replace(robot, links=links, joints=left), frames)


def _carriers(robot: Robot, keep: set[str]) -> dict[str, tuple[str, Transform]]:
    """The `frames` of a fusion."""
    frames = {link.name: (link.name, np.eye(4)) for link in robot.links}
    for joint in robot.joints:
        if joint.type != "fixed":
            continue
        carrier, at = frames[joint.parent]
        at = at @ _transform(joint)
        if joint.child not in keep:
            old, new, shift = joint.child, carrier, at
        elif carrier not in keep:
            old, new, shift = carrier, joint.child, _inverse(at)
        else:
            continue
        for link, (own, pose) in frames.items():
            if own == old:
                frames[link] = (new, shift @ pose)
    return frames


def _body(robot: Robot, link: Link, frames: dict[str, tuple[str, Transform]]) -> Link:
    """A link with all that it carries, its own shapes first."""
    others = (other for other in robot.links if other is not link)
    carried = [(own, *frames[own.name]) for own in (link, *others)]
    here = [(own, at) for own, carrier, at in carried if carrier == link.name]
    shapes = tuple(_placed(shape, at) for own, at in here for shape in own.collisions)
    weights = [(own.inertia, at) for own, at in here if own.inertia is not None]
    return Link(name=link.name, inertia=_sum(weights), collisions=shapes)


def _joint(joint: Joint, frames: dict[str, tuple[str, Transform]]) -> Joint:
    """A joint between the links that carry its own."""
    parent, at = frames[joint.parent]
    child, below = frames[joint.child]
    if parent == child or (parent, child) == (joint.parent, joint.child):
        return replace(joint, parent=parent, child=child)
    to_child, axis = _inverse(below), np.array(joint.axis)
    if np.linalg.norm(np.cross(to_child[:3, 3], axis)) > 1e-9:
        raise ValueError(f"link {child!r} stands off the axis of joint {joint.name!r}")
    placed = _placed(joint, at, to_child)
    return replace(placed, parent=parent, child=child, axis=_vec3(axis @ to_child[:3, :3]))


def _placed(item: Placed, before: Transform, after: Transform | None = None) -> Placed:
    """The same with its place multiplied from the left and, if given, from the right."""
    if after is None and np.array_equal(before, np.eye(4)):
        return item  # Its numbers stay as they were written.
    pose = before @ _transform(item)
    pose = pose if after is None else pose @ after
    return replace(item, xyz=_vec3(pose[:3, 3]), rpy=rpy_of(pose[:3, :3]))


def _sum(parts: list[tuple[Inertia, Transform]]) -> Inertia | None:
    """Inertia of bodies at these poses together."""
    if not parts:
        return None
    if len(parts) == 1 and np.array_equal(parts[0][1], np.eye(4)):
        return parts[0][0]
    mass = np.array([inertia.mass for inertia, _ in parts])
    centres = np.array([at[:3, :3] @ inertia.com + at[:3, 3] for inertia, at in parts])
    com = mass @ centres / mass.sum()
    tensor = np.zeros((3, 3))
    for (inertia, at), arm in zip(parts, centres - com, strict=True):
        tensor += at[:3, :3] @ inertia.matrix() @ at[:3, :3].T
        tensor += inertia.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertia.of_matrix(float(mass.sum()), _vec3(com), tensor)


def _transform(item: Primitive | Joint) -> Transform:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation(item.rpy), item.xyz
    return pose


def _inverse(pose: Transform) -> Transform:
    inverse = np.eye(4)
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -inverse[:3, :3] @ pose[:3, 3]
    return inverse


def _vec3(values: object) -> Vec3:
    x, y, z = np.asarray(values, dtype=float).tolist()
    return x, y, z
