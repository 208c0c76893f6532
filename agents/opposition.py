"""Which parts of a hand face each other, and how far apart, while it closes: geometry alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from maniskill_taskgrasp.agents.fidelity import SURFACE_ANGLE, arc_cosine
from maniskill_taskgrasp.agents.hand import HandDescription, Posture
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.robot_model import Box, Primitive, rotation
from maniskill_taskgrasp.topology import Topology

INSTANTS = 41  # Of the closing at which gaps are taken, activation 0 to 1.
GRID = 9  # Points along a box's edge; gaps are exact to 0.3 mm for boxes as small as pads.
HELD_SIZE = 0.02  # [m] object at whose thickness the directions are compared.
TOUCHING = 0.001  # [m] gap that counts as contact.

PartPrimitives = dict[str, tuple[tuple[str, Primitive], ...]]


@dataclass(frozen=True)
class Pair:
    """A finger and the part it closes against."""

    against: str
    finger: str
    open_gap: float
    """[m] between their surfaces in the preshape."""
    least_gap: float
    """[m] the smallest while closing."""
    contact: float
    """Activation at which they first touch with nothing between them; 1 if they never do."""
    angle: float
    """[deg] the line between them is off the worse of the two good surfaces, at `HELD_SIZE`."""

    @property
    def opposes(self) -> bool:
        """Whether an object between them is held by good surfaces on both sides."""
        return self.angle <= SURFACE_ANGLE


class OppositionGeometry:
    """Gaps and directions between the parts of one hand."""

    def __init__(
        self, hand: HandDescription, primitives: PartPrimitives, kinematics: ArticulationKinematics
    ) -> None:
        """
        Args:
            hand: postures, parts and pad directions.
            primitives: part -> (link, collision primitive), those that touch objects.
            kinematics: of the robot or of the hand alone.
        """
        self._hand = hand
        self._primitives = primitives
        self._kinematics = kinematics

    def pairs(self, topology: Topology) -> tuple[Pair, ...]:
        """Each finger of a topology with what it closes against, over this hand's posture."""
        poses = self._closing(self._hand.postures[topology.slug])
        against = opposing_part(topology)
        whole = topology.opposition == "Side"  # A finger presses there with any of its links.
        fingers = [part for part in topology.parts if part not in ("palm", "thumb", against)]
        return tuple(self._pair(poses, against, finger, whole) for finger in fingers)

    def _closing(self, posture: Posture) -> Tensor:
        """(INSTANTS, num_links, 4, 4) poses from preshape to closed."""
        share = torch.linspace(0, 1, INSTANTS)[:, None]
        preshape, closing = torch.tensor(posture.preshape), torch.tensor(posture.closing)
        angles = self._hand.joint_angles(preshape + share * (closing - preshape))
        qpos = torch.zeros(INSTANTS, self._kinematics.dof)
        for joint, angle in angles.items():
            qpos[:, self._kinematics.column(joint)] = angle
        return self._kinematics.link_matrices(qpos)

    def _pair(self, poses: Tensor, against: str, finger: str, whole: bool) -> Pair:
        first, second = self._boxes(poses, against, whole), self._boxes(poses, finger, whole)
        gaps = box_sets_gap(first, second)
        at = int((gaps - HELD_SIZE).abs().argmin())
        line = self._centre(poses, against)[at] - self._centre(poses, finger)[at]
        line = line / line.norm()
        cosine = torch.minimum(
            self._surface_cosine(poses[at], finger, line),
            self._surface_cosine(poses[at], against, -line),
        )
        return Pair(
            against=against,
            finger=finger,
            open_gap=float(gaps[0]),
            least_gap=float(gaps.amin()),
            contact=first_contact(gaps),
            angle=float(torch.rad2deg(torch.acos(cosine.clamp(-1, 1)))),
        )

    def _boxes(self, poses: Tensor, part: str, whole: bool) -> list[tuple[Tensor, Tensor]]:
        """Poses (n, 4, 4) and sizes (3,) of a part's boxes, or of its pad alone."""
        boxes = [(link, b) for link, b in self._primitives[part] if isinstance(b, Box)]
        if part != "palm" and not whole:
            boxes = boxes[-1:]  # A digit's last box is its pad.
        placed = []
        for link, box in boxes:
            local = np.eye(4)
            local[:3, :3], local[:3, 3] = rotation(box.rpy), box.xyz
            pose = poses[:, self._kinematics.link_index(link)]
            placed.append((pose @ torch.tensor(local, dtype=pose.dtype), torch.tensor(box.size)))
        return placed

    def _centre(self, poses: Tensor, part: str) -> Tensor:
        """(n, 3) [m] middle of a digit's pad or of the palm's face."""
        if part == "palm":
            return poses[:, self._kinematics.link_index(self._hand.palm_frame), :3, 3]
        return self._boxes(poses, part, whole=False)[0][0][:, :3, 3]

    def _surface_cosine(self, poses: Tensor, part: str, direction: Tensor) -> Tensor:
        """Cosine between a direction (3,) and a part's good surface."""
        hand = self._hand
        link = hand.palm_frame if part == "palm" else hand.tip_links[part]
        local = direction @ poses[self._kinematics.link_index(link), :3, :3]
        arc = hand.thumb_pad_arc if part == "thumb" else hand.finger_pad_arc
        pad, end = (torch.tensor(side) for side in arc)
        return arc_cosine(local, pad, pad if part == "palm" else end)


def opposing_part(topology: Topology) -> str:
    """What a topology's fingers close against: palm, thumb, or in a scissor grasp a finger."""
    if topology.opposition == "Palm":
        return "palm"
    return "thumb" if "thumb" in topology.parts else topology.parts[0]


def first_contact(gaps: Tensor) -> float:
    """Share of a motion after which the gap, (n,) [m] evenly along it, has closed; at most 1."""
    closed = torch.nonzero(gaps <= TOUCHING).flatten()
    return float(closed[0]) / (len(gaps) - 1) if len(closed) else 1.0


def box_sets_gap(first: list[tuple[Tensor, Tensor]], second: list[tuple[Tensor, Tensor]]) -> Tensor:
    """(n,) [m] smallest distance between two sets of boxes, each (pose (n, 4, 4), size (3,))."""
    gaps = [box_gap(*a, *b) for a in first for b in second]
    return torch.stack(gaps).amin(0)


def box_gap(first: Tensor, first_size: Tensor, second: Tensor, second_size: Tensor) -> Tensor:
    """Distance between two boxes, 0 where they overlap.

    Args:
        first: (n, 4, 4) pose of the first box's centre.
        first_size: (3,) [m] its edges.
        second: (n, 4, 4) pose of the second's.
        second_size: (3,) [m] its edges.

    Returns:
        (n,) [m] taken from a grid of points on each box to the other, which is exact.
    """
    relative = torch.linalg.inv(second) @ first
    there = _points_to_box(relative, first_size, second_size)
    back = _points_to_box(torch.linalg.inv(relative), second_size, first_size)
    return torch.minimum(there, back)


def _points_to_box(relative: Tensor, size: Tensor, other_size: Tensor) -> Tensor:
    """(n,) [m] from a grid of points in one box to another box at the origin."""
    line = torch.linspace(-0.5, 0.5, GRID)
    points = torch.cartesian_prod(line, line, line) * size
    there = points @ relative[:, :3, :3].transpose(1, 2) + relative[:, None, :3, 3]
    return (there.abs() - other_size / 2).clamp(min=0).norm(dim=-1).amin(1)
