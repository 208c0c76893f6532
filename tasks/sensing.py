"""What the hand feels: force and distance of each part, from contacts and geometry alone."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from maniskill_taskgrasp.tasks.geometry import quat_to_matrix


def part_forces(link_forces: Tensor, part_of_link: Tensor, num_parts: int) -> Tensor:
    """Magnitude of each part's summed contact force with the object (the paper's "norm force").

    Args:
        link_forces: (num_envs, num_links, 3) [N] force of the object on each hand link.
        part_of_link: (num_links,) long index of the part that a link belongs to.
        num_parts: how many parts there are.

    Returns:
        (num_envs, num_parts) [N]
    """
    total = link_forces.new_zeros(len(link_forces), num_parts, 3)
    return total.index_add_(1, part_of_link, link_forces).norm(dim=-1)


def box_distance(points: Tensor, half_size: Tensor) -> Tensor:
    """Distance of points to a box centred at the origin, 0 inside.

    Args:
        points: (..., num_points, 3) [m] in the box frame.
        half_size: (..., 3) [m], broadcast over the points.

    Returns:
        (..., num_points) [m]
    """
    return (points.abs() - half_size[..., None, :]).clamp_(min=0).norm(dim=-1)


def part_distances(
    link_poses: Tensor,
    box_link: Tensor,
    box_position: Tensor,
    box_rotation: Tensor,
    box_half_size: Tensor,
    part_boxes: Sequence[slice],
    points: Tensor,
    obj_pose: Tensor,
) -> Tensor:
    """Closest distance of each hand part to the object.

    Args:
        link_poses: (num_envs, num_links, 7) [m, wxyz] world.
        box_link: (num_boxes,) long link of each collision box; boxes are sorted by part.
        box_position: (num_boxes, 3) [m] in the link frame.
        box_rotation: (num_boxes, 3, 3) from box to link frame.
        box_half_size: (num_boxes, 3) [m].
        part_boxes: slice of the boxes of each part.
        points: (num_envs, num_points, 3) [m] object surface, object frame.
        obj_pose: (num_envs, 7) [m, wxyz] world.

    Returns:
        (num_envs, num_parts) [m]
    """
    poses = link_poses[:, box_link]
    link_rotation = quat_to_matrix(poses[..., 3:])
    rotation = link_rotation @ box_rotation
    centre = poses[..., :3] + (link_rotation @ box_position[..., None])[..., 0]
    obj_rotation = quat_to_matrix(obj_pose[:, 3:])[:, None]
    # Object frame to box frame: p_box = R^T (R_obj p + t_obj - centre).
    turn = rotation.transpose(-1, -2) @ obj_rotation
    shift = rotation.transpose(-1, -2) @ (obj_pose[:, None, :3] - centre)[..., None]
    in_box = points[:, None] @ turn.transpose(-1, -2) + shift.transpose(-1, -2)
    nearest = box_distance(in_box, box_half_size).amin(-1)
    return torch.stack([nearest[:, part].amin(1) for part in part_boxes], 1)
