"""Which way up an object can rest on a level surface: its hull's faces under the centre of mass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.geometry import (
    matrix_to_quat,
    part_corners,
    rotation_between,
)
from maniskill_taskgrasp.assets.objects.model import Part, RestingPose

Array = NDArray[np.float64]

MIN_TILT = np.radians(4.5)  # A pose that a smaller tilt upsets is not one to count on.
MIN_SHARE = 0.01  # Rarer ends of a random drop are left out.
SAME_TURN = np.radians(25.0)  # Poses closer than this are one pose.
MAX_POSES = 6
ROUND = 0.01  # Extents and moments this close (relative) make an axis one of symmetry.


def candidate_poses(
    parts: Sequence[Part], com: Array, inertia: Array, design_to_object: Array
) -> list[RestingPose]:
    """Resting poses of the parts' convex hull, most probable first.

    Args:
        com: (3,) [m] centre of mass, object frame.
        inertia: (3, 3) about it.
        design_to_object: (3, 3) whose first column is the object's own "up".
    """
    import trimesh

    corners = np.concatenate([part_corners(part) for part in parts])
    hull = trimesh.Trimesh(corners).convex_hull
    transforms, shares = trimesh.poses.compute_stable_poses(
        hull, center_mass=com, sigma=0.0, n_samples=1, threshold=0.0
    )
    symmetric = symmetry_axes(np.ptp(corners, axis=0), com, inertia)
    size = np.abs(design_to_object.T) @ np.ptp(corners, axis=0)
    turnable = [int(np.argmax(np.abs(design_to_object[axis]))) for axis in symmetric]
    kept: list[tuple[Array, float]] = []  # up direction in the object frame, share
    for transform, share in zip(transforms, shares, strict=True):
        up = transform[2, :3]
        if _tilt_margin(corners, com, up) < MIN_TILT and kept:
            continue  # The likeliest pose is always kept: physics has the last word.
        for i, (other, total) in enumerate(kept):
            if _same(up, other, symmetric):
                kept[i] = (other, total + share)
                break
        else:
            kept.append((up, float(share)))
    kept = sorted((k for k in kept if k[1] >= MIN_SHARE), key=lambda k: -k[1])[:MAX_POSES]
    if len(symmetric) == 3 and kept:
        kept = [(design_to_object[:, 0], 1.0)]  # A ball is shown upright.
    total = sum(share for _, share in kept)
    return _named(
        [
            RestingPose(
                name=_pose_name(design_to_object.T @ up, size, turnable),
                quat_wxyz=matrix_to_quat(rotation_between(up, (0.0, 0.0, 1.0))),
                height=float(-(corners @ up).min()),
                probability=share / total,
            )
            for up, share in kept
        ]
    )


def symmetry_axes(extents: Array, com: Array, inertia: Array) -> list[int]:
    """Axes (0, 1, 2) about which turning the object changes nothing that matters for resting."""
    axes, moments = [], np.diag(inertia)
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        alike = abs(extents[i] - extents[j]) < ROUND * extents[i]
        alike &= abs(moments[i] - moments[j]) < ROUND * moments[i]
        if alike and np.hypot(com[i], com[j]) < ROUND * extents[i]:
            axes.append(axis)
    return axes


def _same(up: Array, other: Array, symmetric: list[int]) -> bool:
    if len(symmetric) == 3:
        return True
    if symmetric:
        up, other = (_about(v, symmetric[0]) for v in (up, other))
    return float(np.arccos(np.clip(up @ other, -1, 1))) < SAME_TURN


def _about(v: Array, axis: int) -> Array:
    """Direction v turned about an axis of symmetry into one half plane."""
    along = v[axis]
    out = np.zeros(3)
    out[axis], out[(axis + 1) % 3] = along, np.sqrt(max(0.0, 1 - along**2))
    return out


def _tilt_margin(corners: Array, com: Array, up: Array) -> float:
    """[rad] smallest tilt about an edge of the support that carries the centre of mass over it."""
    from scipy.spatial import ConvexHull, QhullError

    heights = corners @ up
    touching = corners[heights < heights.min() + 2e-4]
    rotation = rotation_between(up, (0.0, 0.0, 1.0))
    flat = (touching @ rotation.T)[:, :2]
    centre, drop = (rotation @ com)[:2], com @ up - heights.min()
    try:
        edges = ConvexHull(flat).equations
    except (QhullError, ValueError):
        return 0.0
    reach = -(edges[:, :2] @ centre + edges[:, 2])
    return float(np.arctan2(reach.min(), drop))


def _pose_name(up: Array, size: Array, symmetric: list[int]) -> str:
    """Name of a pose.

    Args:
        up: (3,) world up in the design frame, where +x is up when the thing stands, +z its face.
        size: (3,) [m] extents in the design frame.
        symmetric: axes of symmetry, design frame.
    """
    if len(symmetric) == 3:
        return "resting"
    flat = size[0] < 0.6 * size.max()  # A disc or bowl, whose natural pose is on its base.
    if abs(up[0]) > 0.85:
        return ("lying" if flat else "standing") if up[0] > 0 else "upside down"
    if abs(up[0]) > 0.5:
        return "leaning"
    if flat:
        return "on edge"
    if 0 in symmetric or abs(up[2]) > 0.7:
        return "lying" if 0 in symmetric or up[2] > 0 else "face down"
    return "on its side"


def _named(poses: list[RestingPose]) -> list[RestingPose]:
    """Poses with a number after names that occur more than once."""
    seen: dict[str, int] = {}
    out = []
    for pose in poses:
        seen[pose.name] = seen.get(pose.name, 0) + 1
        count = seen[pose.name]
        name = pose.name if count == 1 else f"{pose.name} {count}"
        out.append(RestingPose(name, pose.quat_wxyz, pose.height, pose.probability))
    return out
