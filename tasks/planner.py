"""Chooses the pregrasp of a topology for a placed object, from nominal data alone."""

from __future__ import annotations

import itertools

import numpy as np
import torch
from torch import Tensor

from maniskill_taskgrasp.agents.hand import HandDescription, Posture
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.robot_model import Box, Primitive
from maniskill_taskgrasp.tasks.grasp_library import nearest_grasps
from maniskill_taskgrasp.tasks.placement import Placement
from maniskill_taskgrasp.tasks.pregrasp import palm_rotation
from maniskill_taskgrasp.topology import resolve_topology

CLEARANCE = 0.004  # [m] between the table and the fingers' deepest point while they close.
CANDIDATES = 4  # Grasps of which the first that the arm can reach is taken.
Candidate = tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]
"""Pregrasp (6,), preshape and closing (num_actuators,)."""
SWEEP = 6  # Instants of the closing at which the fingers' depth is taken.


class PregraspPlanner:
    """Pregrasps for one hand; holds what does not change between objects."""

    def __init__(
        self,
        hand: HandDescription,
        primitives: dict[str, tuple[tuple[str, Primitive], ...]],
        kinematics: ArticulationKinematics,
    ) -> None:
        """
        Args:
            hand: postures and joints.
            primitives: part -> (link, collision primitive in its frame).
            kinematics: of the whole robot.
        """
        self._hand = hand
        self._primitives = primitives
        self._kinematics = kinematics
        self._sweeps: dict[str, Tensor] = {}

    def candidates(self, slug: str, placement: Placement) -> list[Candidate]:
        """`CANDIDATES` grasps of a topology for a placed object, the most promising first.

        The stored grasps that suit the object best, then the rule of `bounding_box` with the
        hand's own posture.
        """
        topology, posture = resolve_topology(slug), self._hand.postures[slug]
        stored = nearest_grasps(self._hand, topology, placement, CANDIDATES - 1)
        rule = tuple(self.bounding_box(slug, placement).tolist())
        found = [(grasp.pregrasp, grasp.preshape, grasp.closing) for grasp in stored]
        found += [(rule, posture.preshape, posture.closing)] * (CANDIDATES - len(found))
        return found

    def bounding_box(self, slug: str, placement: Placement) -> Tensor:
        """Pregrasp from the object's box: its centre at the posture's grasp centre, palm raised
        until the closing fingers clear the table.

        Returns:
            (6,) `PREGRASP_FIELDS`.
        """
        posture = self._hand.postures[slug]
        angles = torch.tensor([posture.tilt, posture.roll, posture.yaw])
        rotation = palm_rotation(*angles[:, None])[0]
        centre = torch.tensor(posture.grasp_centre)
        palm_height = float(placement.centre[2]) - float((rotation @ centre)[2])
        lowest = float((self.sweep(slug, posture) @ rotation.T)[:, 2].min())
        rise = max(0.0, CLEARANCE - (palm_height + lowest))
        up = torch.tensor([0.0, 0.0, rise])
        return torch.cat([centre - rotation.T @ up, angles])

    def sweep(self, slug: str, posture: Posture) -> Tensor:
        """(n, 3) [m] corners of the hand's boxes while it closes, palm frame."""
        if slug not in self._sweeps:
            share = torch.linspace(0, 1, SWEEP)[:, None]
            preshape, closing = torch.tensor(posture.preshape), torch.tensor(posture.closing)
            self._sweeps[slug] = self._corners(preshape + share * (closing - preshape))
        return self._sweeps[slug]

    def _corners(self, postures: Tensor) -> Tensor:
        kin = self._kinematics
        qpos = torch.zeros(len(postures), kin.dof)
        for joint, angles in self._hand.joint_angles(postures).items():
            qpos[:, kin.column(joint)] = angles
        poses = kin.link_matrices(qpos.to(kin.device)).cpu()
        palm = torch.linalg.inv(poses[:, kin.link_index(self._hand.palm_frame)])
        points = []
        for link, primitive in itertools.chain.from_iterable(self._primitives.values()):
            if isinstance(primitive, Box):
                corners = torch.tensor(_box_corners(primitive), dtype=torch.float32)
                pose = palm @ poses[:, kin.link_index(link)]
                points.append(corners @ pose[:, :3, :3].transpose(1, 2) + pose[:, None, :3, 3])
        return torch.cat(points, 1).reshape(-1, 3)


def _box_corners(box: Box) -> np.ndarray:
    """(8, 3) [m] in the link frame; the small turn of a pad is left out."""
    signs = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
    return signs * np.asarray(box.size) + np.asarray(box.xyz)
