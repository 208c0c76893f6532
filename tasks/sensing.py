"""What the hand feels: force and distance of each part, from contacts and geometry alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.agents.rotations import quat_to_matrix
from maniskill_taskgrasp.agents.sawyer_ar10.model import Box, Primitive, rotation


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


@dataclass(frozen=True)
class HandBoxes:
    """The hand's collision boxes, sorted by part."""

    link: Tensor
    """(num_boxes,) long link of each box."""
    position: Tensor
    """(num_boxes, 3) [m] in the link frame."""
    rotation: Tensor
    """(num_boxes, 3, 3) from box to link frame."""
    half_size: Tensor
    """(num_boxes, 3) [m]"""
    parts: tuple[slice, ...]
    """Boxes of each part."""

    @classmethod
    def of(
        cls,
        primitives: dict[str, tuple[tuple[str, Primitive], ...]],
        link_names: list[str],
        device: torch.device,
    ) -> HandBoxes:
        """Boxes of a hand.

        Args:
            primitives: part -> (link, collision primitive in its frame); only boxes are kept.
            link_names: names in the order in which links are numbered.
            device: where the tensors live.
        """
        boxes: list[tuple[str, Box]] = []
        parts = []
        for part in PARTS:
            start = len(boxes)
            boxes += [(link, b) for link, b in primitives[part] if isinstance(b, Box)]
            parts.append(slice(start, len(boxes)))

        def tensor(rows: list[Any]) -> Tensor:
            return torch.tensor(np.array(rows), dtype=torch.float32, device=device)

        return cls(
            link=torch.tensor([link_names.index(link) for link, _ in boxes], device=device),
            position=tensor([box.xyz for _, box in boxes]),
            rotation=tensor([rotation(box.rpy) for _, box in boxes]),
            half_size=tensor([np.asarray(box.size) / 2 for _, box in boxes]),
            parts=tuple(parts),
        )


def part_distances(
    link_poses: Tensor, boxes: HandBoxes, points: Tensor, obj_pose: Tensor
) -> Tensor:
    """Closest distance of each hand part to the object.

    Args:
        link_poses: (num_envs, num_links, 7) [m, wxyz] world.
        boxes: the hand's boxes, numbered by the same links.
        points: (num_envs, num_points, 3) [m] object surface, object frame.
        obj_pose: (num_envs, 7) [m, wxyz] world.

    Returns:
        (num_envs, num_parts) [m]
    """
    poses = link_poses[:, boxes.link]
    link_rotation = quat_to_matrix(poses[..., 3:])
    rotation = link_rotation @ boxes.rotation
    centre = poses[..., :3] + (link_rotation @ boxes.position[..., None])[..., 0]
    obj_rotation = quat_to_matrix(obj_pose[:, 3:])[:, None]
    # Object frame to box frame: p_box = R^T (R_obj p + t_obj - centre).
    turn = rotation.transpose(-1, -2) @ obj_rotation
    shift = rotation.transpose(-1, -2) @ (obj_pose[:, None, :3] - centre)[..., None]
    in_box = points[:, None] @ turn.transpose(-1, -2) + shift.transpose(-1, -2)
    nearest = box_distance(in_box, boxes.half_size).amin(-1)
    return torch.stack([nearest[:, part].amin(1) for part in boxes.parts], 1)
