"""Rewards as pure functions of tensors: the paper's, and shaped terms in [0, 1]."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.topology import TOPOLOGIES

CONTACT_BONUS = 10.0  # b1: reward for each hand link that presses the object.
FORCE_COST = 0.05  # b2 [1/N]: the paper's 5000 Nm fingers need another scale than 0.6 Nm ones.
NO_CONTACT = -1000.0  # Paper, section III.
PAPER_SUCCESS = 1000.0  # Paper, section III.
CONTACT_FORCE = 0.05  # [N] least force that counts as pressing.

CENTRE_SCALE = 60.0  # [1/m] tanh slope: the term is 0.46 at 1 cm and 0.71 at 5 mm.
YAW_LEVER = 0.04  # [m/rad] half the width of a grasp: what a turn moves at the fingertips.
REACH_SCALE = 15.0  # [1/m] tanh slope: the term is 0.37 at 5 cm and 0.86 at 1 cm.
FIRM_FORCE = 4.0  # [N] force of a part at which its grip term saturates.


@dataclass(frozen=True, kw_only=True)
class RewardWeights:
    """Weights of the dense terms; the normalised reward divides by their sum."""

    centre: float = 1.0
    reach: float = 0.5
    contact: float = 1.0
    balance: float = 1.0
    form: float = 1.5
    lift: float = 3.0
    success: float = 5.0

    @property
    def total(self) -> float:
        return sum(vars(self).values())


@dataclass(frozen=True)
class PartRoles:
    """What each part is to each topology; every table is (num_topologies, num_parts) bool."""

    named: Tensor
    opposing: Tensor
    """Named parts that stand against the fingers."""
    fingers: Tensor
    """Named fingers."""

    @classmethod
    def of_topologies(cls, device: torch.device) -> PartRoles:
        """Of `TOPOLOGIES`, in their order."""
        named = torch.tensor(
            [[part in t.parts for part in PARTS] for t in TOPOLOGIES], device=device
        )
        finger = torch.tensor([part not in ("palm", "thumb") for part in PARTS], device=device)
        return cls(named, named & ~finger, named & finger)

    def of(self, index: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """(num_envs, num_parts) named, opposing and fingers of topologies (num_envs,)."""
        return self.named[index], self.opposing[index], self.fingers[index]


def paper_reward(contact_count: Tensor, force: Tensor, success: Tensor) -> Tensor:
    """-1000 without contact, else b1 c - b2 f; +1000 on success (Li et al., section III).

    The paper counts contact points, which a GPU back end cannot; here links are counted.

    Args:
        contact_count: (num_envs,) hand links that press the object.
        force: (num_envs,) [N] summed force.
        success: (num_envs,) bool.
    """
    touching = CONTACT_BONUS * contact_count - FORCE_COST * force
    reward = torch.where(contact_count > 0, touching, torch.full_like(touching, NO_CONTACT))
    return reward + PAPER_SUCCESS * success


def centre_term(shift: Tensor) -> Tensor:
    """Nearness of the palm to where it would stand to the object as planned.

    Args:
        shift: (num_envs, 3) [m, m, rad] displacement (x, y, yaw) that the palm still lacks.
    """
    off = torch.cat([shift[:, :2], YAW_LEVER * shift[:, 2:]], 1)
    return 1 - torch.tanh(CENTRE_SCALE * torch.linalg.vector_norm(off, dim=1))


def reach_term(distances: Tensor, named: Tensor) -> Tensor:
    """Nearness of the parts that the topology names.

    Args:
        distances: (num_envs, num_parts) [m].
        named: (num_envs, num_parts) bool.
    """
    nearness = 1 - torch.tanh(REACH_SCALE * distances)
    return (nearness * named).sum(1) / named.sum(1).clamp(min=1)


def contact_term(forces: Tensor, named: Tensor) -> Tensor:
    """Share of the named parts that press the object; forces (num_envs, num_parts) [N]."""
    pressing = (forces >= CONTACT_FORCE) & named
    return pressing.sum(1) / named.sum(1).clamp(min=1)


def balance_term(forces: Tensor, opposing: Tensor, fingers: Tensor) -> Tensor:
    """How firmly both sides of the grasp press: the weaker side's force, saturating.

    Args:
        forces: (num_envs, num_parts) [N].
        opposing: (num_envs, num_parts) bool parts that stand against the fingers.
        fingers: (num_envs, num_parts) bool named fingers.
    """
    weaker = torch.minimum((forces * opposing).sum(1), (forces * fingers).sum(1))
    return torch.tanh(weaker / FIRM_FORCE)


def lift_term(lift: Tensor, height: float) -> Tensor:
    """(num_envs,) rise of the object [m] as a share of the height asked for [m]."""
    return (lift / height).clamp(0, 1)
