"""What the hand feels: force and distance of each part, from contacts and geometry alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.agents.robot_model import Box, Primitive, rotation
from maniskill_taskgrasp.tasks.surface import Surface

NEAREST_CELLS = 4  # Cells of the object's surface that are looked at closely for each part.
NOWHERE = 1000.0  # [m] away are boxes that only fill a part up.


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
    total.index_add_(1, part_of_link, link_forces)
    return torch.linalg.vector_norm(total, dim=-1)


@dataclass(frozen=True)
class HandBoxes:
    """The hand's collision boxes, part by part: every part has as many, some of them nowhere."""

    link: Tensor
    """(num_parts * width,) long link of each box."""
    from_link: Tensor
    """(num_parts * width, 3, 4) rotation and shift [m] from the link frame to the box."""
    half_size: Tensor
    """(num_parts * width, 3, 1) [m]"""
    width: int
    """Boxes of a part."""

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
        by_part = [[(k, b) for k, b in primitives[part] if isinstance(b, Box)] for part in PARTS]
        width = max(map(len, by_part))
        boxes = [pair for own in by_part for pair in (own + own[-1:] * width)[:width]]
        fills = [place >= len(own) for own in by_part for place in range(width)]

        def tensor(rows: list[Any]) -> Tensor:
            return torch.tensor(np.array(rows), dtype=torch.float32, device=device)

        turns = [rotation(box.rpy).T for _, box in boxes]
        shifts = [
            -turn @ box.xyz + fill * NOWHERE
            for turn, (_, box), fill in zip(turns, boxes, fills, strict=True)
        ]
        return cls(
            link=torch.tensor([link_names.index(link) for link, _ in boxes], device=device),
            from_link=torch.cat([tensor(turns), tensor(shifts)[..., None]], -1),
            half_size=tensor([np.asarray(box.size) / 2 for _, box in boxes])[:, :, None],
            width=width,
        )


@dataclass(frozen=True)
class ObjectSurfaces:
    """Surfaces of all environments' objects, laid out for batched search (see `surface`)."""

    centres: Tensor
    """(num_envs, 3, num_cells) [m]"""
    middles: Tensor
    """(num_envs * num_cells, 3 * num_patches) [m] coordinate by coordinate."""
    patches: Tensor
    """(num_envs * num_cells * num_patches, 3, 3) [m] middle and half axes, one a column."""

    @classmethod
    def of(cls, surfaces: Sequence[Surface], device: torch.device) -> ObjectSurfaces:
        """One surface for each environment."""
        centres = np.stack([surface.centres for surface in surfaces])
        patches = np.stack([surface.patches for surface in surfaces])
        middles = patches[:, :, :, 0].swapaxes(2, 3).reshape(-1, 3 * patches.shape[2])
        by_column = patches.reshape(-1, 3, 3).swapaxes(1, 2)
        return cls(
            *(
                torch.from_numpy(np.ascontiguousarray(a)).to(device)
                for a in (centres.swapaxes(1, 2), middles, by_column)
            )
        )

    def rows(self, index: Tensor) -> ObjectSurfaces:
        """Surfaces of environments (n,)."""
        num_envs = len(self.centres)

        def pick(field: Tensor) -> Tensor:
            return field.view(num_envs, -1, *field.shape[1:])[index].flatten(0, 1)

        return ObjectSurfaces(self.centres[index], pick(self.middles), pick(self.patches))


def part_distances(
    link_frames: Tensor, boxes: HandBoxes, surfaces: ObjectSurfaces, obj_frames: Tensor
) -> Tensor:
    """Closest distance of each hand part to the object in one or several poses, 0 at contact.

    Every box is compared with every cell's centre; in the nearest cells of each part, with every
    patch's middle; and the nearest patch is measured as the flat piece that it is. The nearest
    cells are those of the first pose, so others must be near it: a centimetre, not more.

    Args:
        link_frames: (num_envs, num_links, 3, 4) rotation and position [m], world.
        boxes: the hand's boxes, numbered by the same links.
        surfaces: of the objects.
        obj_frames: (num_envs, num_poses, 3, 4) rotation and position [m], world.

    Returns:
        (num_envs, num_poses, num_parts) [m]
    """
    num_envs, num_poses = obj_frames.shape[:2]
    num_cells, num_patches = surfaces.centres.shape[2], surfaces.middles.shape[1] // 3
    num_boxes = len(boxes.link)
    frames = _object_to_boxes(link_frames, boxes, obj_frames)
    first = frames.view(num_envs, -1, num_poses, 4)[:, :, 0]
    far = torch.baddbmm(first[..., 3:], first[..., :3], surfaces.centres)
    gaps = box_distance_squared(far.view(-1, num_boxes, 3, num_cells), boxes.half_size)
    near = gaps.view(-1, boxes.width * num_cells).topk(NEAREST_CELLS, largest=False, sorted=False)
    row = torch.arange(len(near.indices), device=first.device)[:, None]
    # Boxes and cells numbered through all environments; index_select is much faster than [].
    box = (near.indices // num_cells + row * boxes.width).flatten()
    cell = (near.indices % num_cells + row * boxes.width // num_boxes * num_cells).flatten()
    frames = frames.index_select(0, box).view(-1, 3 * num_poses, 4)
    half_size = boxes.half_size.index_select(0, box % num_boxes)
    middles = surfaces.middles.index_select(0, cell).view(-1, 3, num_patches)
    middles = torch.baddbmm(frames[..., 3:], frames[..., :3], middles)
    gaps = box_distance_squared(middles.view(-1, 3, num_poses * num_patches), half_size)
    gaps = gaps.view(len(row), NEAREST_CELLS, num_poses, num_patches).transpose(1, 2).flatten(2)
    best = (gaps.argmin(2) + row * gaps.shape[2]).flatten()
    pair = best // num_patches
    patch = cell.index_select(0, pair) * num_patches + best % num_patches
    frames = _of_pose(frames, pair, num_poses)
    in_box = frames[..., :3] @ surfaces.patches.index_select(0, patch)
    in_box[..., :1] += frames[..., 3:]
    distance = patch_distance(in_box, half_size.index_select(0, pair))
    return distance.view(num_envs, -1, num_poses).transpose(1, 2)


def _object_to_boxes(link_frames: Tensor, boxes: HandBoxes, obj_frames: Tensor) -> Tensor:
    """(num_envs * num_boxes, 3, num_poses, 4): p_box = turn p_object + shift, the last column."""
    num_envs, num_poses = obj_frames.shape[:2]
    to_link = link_frames[..., :3].transpose(-1, -2)
    to_link = torch.cat([to_link, -to_link @ link_frames[..., 3:]], -1)
    to_box = boxes.from_link[..., :3] @ to_link.index_select(1, boxes.link)
    to_box[..., 3] += boxes.from_link[..., 3]
    to_box = to_box.view(num_envs, -1, 4)
    side_by_side = obj_frames.transpose(1, 2).reshape(num_envs, 3, -1)
    frames = (to_box[..., :3] @ side_by_side).view(num_envs, -1, num_poses, 4)
    frames[..., 3] += to_box[..., 3:]
    return frames.view(-1, 3, num_poses, 4)


def _of_pose(frames: Tensor, pair: Tensor, num_poses: int) -> Tensor:
    """(len(pair), 3, 4) frames, (n, 3 * num_poses, 4), of pairs for one pose after the other."""
    pose = torch.arange(num_poses, device=pair.device)
    place = (pair.view(-1, num_poses) * num_poses + pose).flatten()
    by_pose = frames.view(-1, 3, num_poses, 4).transpose(1, 2).reshape(-1, 3, 4)
    return by_pose.index_select(0, place)


def box_distance_squared(points: Tensor, half_size: Tensor) -> Tensor:
    """Squared distance of points to a box centred at the origin, 0 inside.

    Args:
        points: (..., 3, num_points) [m] in the box frame; overwritten.
        half_size: (..., 3, 1) [m].

    Returns:
        (..., num_points) [m^2]
    """
    x, y, z = points.abs_().sub_(half_size).clamp_(min=0).square_().unbind(-2)
    return x.add(y).add_(z)  # Faster than a sum over so short an axis.


def patch_distance(patches: Tensor, half_size: Tensor) -> Tensor:
    """Distance of flat patches to a box centred at the origin, 0 where they touch.

    The middle's nearest point of the box is projected onto the patch, and that point's distance is
    taken: exact for flat faces against each other, else right to second order.

    Args:
        patches: (n, 3, 3) [m] middle, then two half axes, one a column, in the box frame.
        half_size: (n, 3, 1) [m].

    Returns:
        (n,) [m]
    """
    middle, axes = patches[..., :1], patches[..., 1:]
    to_box = middle.clamp(-half_size, half_size) - middle
    along = (axes * to_box).sum(1, keepdim=True) / axes.square().sum(1, keepdim=True).clamp(
        min=1e-12
    )
    on_patch = middle + (axes * along.clamp(-1, 1)).sum(2, keepdim=True)
    return box_distance_squared(on_patch, half_size)[:, 0].sqrt()
