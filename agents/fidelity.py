"""Form: are the contacts those that the topology's name says? (facts: grasping, section 6)

A hand may lift an object that is trapped on the back of the thumb. That is a lift, and not the
grasp that was asked for; this file tells the two apart from forces alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.hand import PARTS, HandDescription
from maniskill_taskgrasp.topology import TOPOLOGIES

TOUCH_FORCE = 0.05  # [N] a digit touches from here on.
SURFACE_ANGLE = 60.0  # [deg] a contact this close to the arc from pad to end is on good surface.
BACK_COSINE = -0.5  # Normal against the pad's direction: the back of the digit.
GOOD_SHARE = 0.5  # Least share of a digit's force on good surface.
UNNAMED_SHARE = 0.10  # Most force on fingers that the name does not list.
PALM_SHARE = {
    "Precision": 0.05,
    "Power": 0.25,
    "Intermediate": 0.25,
}  # Most force on the palm in pad types.
THUMB_ABDUCTED = 1.10  # [rad] commanded thumb rotation between adducted and abducted.
STRAIGHT_PIP = 0.5  # [rad] most bend of a finger in a parallel extension.
PALM_NORMAL = 0.5  # Least component of the contact normal along the palm's.

PALM, THUMB = PARTS.index("palm"), PARTS.index("thumb")
FINGERS = [PARTS.index(name) for name in ("index", "middle", "ring", "little")]


@dataclass(frozen=True)
class ContactShares:
    """Force a part exerts, and on which surface; each (num_envs, num_parts) [N]."""

    force: Tensor
    good: Tensor
    back: Tensor
    distal: Tensor


class ContactSurfaces:
    """Sorts a hand's link forces into good surface, back and last link, part by part."""

    def __init__(self, hand: HandDescription, link_names: list[str], device: torch.device) -> None:
        owner = {link: PARTS.index(p) for p, links in hand.part_links.items() for link in links}
        self.part_of_link = torch.tensor([owner[name] for name in link_names], device=device)
        arcs, distal = [], []
        for name in link_names:
            is_thumb = owner[name] == THUMB
            arcs.append(hand.thumb_pad_arc if is_thumb else hand.finger_pad_arc)
            distal.append(name in hand.tip_links.values())
        self._pad = torch.tensor([pad for pad, _ in arcs], device=device)
        self._end = torch.tensor([end for _, end in arcs], device=device)
        self._distal = torch.tensor(distal, device=device)

    def shares(self, link_forces: Tensor) -> ContactShares:
        """Split forces by surface.

        Args:
            link_forces: (num_envs, num_links, 3) [N] force of the object ON each link, link frame;
                it points into the link, so the outward contact normal is its negative.
        """
        force = link_forces.norm(dim=-1)
        normal = -link_forces / force.clamp(min=1e-9)[..., None]
        along_pad = (normal * self._pad).sum(-1)
        along_end = (normal * self._end).sum(-1)
        on_arc = (along_pad >= 0) & (along_end >= 0)
        inside = torch.sqrt(along_pad**2 + along_end**2)
        cosine = torch.where(on_arc, inside, torch.maximum(along_pad, along_end))
        good = cosine >= torch.cos(torch.deg2rad(torch.tensor(SURFACE_ANGLE)))
        # The palm works with its face, whose normal is +y; its pad arc says so too.
        palm = self.part_of_link == PALM
        good = torch.where(palm, along_pad >= PALM_NORMAL, good)
        return ContactShares(
            force=self._by_part(force),
            good=self._by_part(force * good),
            back=self._by_part(force * (along_pad < BACK_COSINE)),
            distal=self._by_part(force * self._distal),
        )

    def _by_part(self, force: Tensor) -> Tensor:
        total = force.new_zeros(len(force), len(PARTS))
        return total.index_add_(1, self.part_of_link, force)


@cache
def _topology_table(device: torch.device) -> dict[str, Tensor]:
    """What each topology asks for; every column is (15, ...)."""
    parts = torch.tensor([[part in t.parts for part in PARTS] for t in TOPOLOGIES])
    columns = {
        "parts": parts,
        "fingers": parts[:, FINGERS],
        # Three of four are enough where the name lists all four fingers.
        "needed": parts[:, FINGERS].sum(1).clamp(max=3),
        "abducted": torch.tensor([t.thumb_abducted for t in TOPOLOGIES]),
        "pad": torch.tensor([t.opposition == "Pad" for t in TOPOLOGIES]),
        "palm": torch.tensor([t.opposition == "Palm" for t in TOPOLOGIES]),
        "precision": torch.tensor([t.pip == "Precision" for t in TOPOLOGIES]),
        "palm_share": torch.tensor([PALM_SHARE[t.pip] for t in TOPOLOGIES]),
    }
    return {name: column.to(device) for name, column in columns.items()}


def in_topology(
    shares: ContactShares, topology_index: Tensor, thumb_rotation: Tensor, pip: Tensor
) -> Tensor:
    """Is the hand in the topology it was asked for?

    Args:
        shares: forces averaged over the last moments of the hold.
        topology_index: (num_envs,) long, `topology.TOPOLOGIES`.
        thumb_rotation: (num_envs,) [rad] commanded rotation of the thumb.
        pip: (num_envs, 4) [rad] middle joints of index, middle, ring, little.

    Returns:
        (num_envs,) bool
    """
    asked = {k: v[topology_index] for k, v in _topology_table(shares.force.device).items()}
    touches = shares.force >= TOUCH_FORCE
    total = shares.force.sum(1).clamp(min=1e-9)
    unnamed = (shares.force[:, FINGERS] * ~asked["fingers"]).sum(1) <= UNNAMED_SHARE * total
    abducted = thumb_rotation >= THUMB_ABDUCTED
    side = (touches | ~asked["parts"]).all(1)
    pad = _fingers_work(shares, touches, asked) & _pad(shares, touches, asked, abducted, pip, total)
    palm = _fingers_work(shares, touches, asked) & _palm(shares, touches, asked, abducted, total)
    return unnamed & torch.where(asked["pad"], pad, torch.where(asked["palm"], palm, side))


def _fingers_work(shares: ContactShares, touches: Tensor, asked: dict[str, Tensor]) -> Tensor:
    """Enough named fingers press with their pads; in precision types with the last link."""
    force = shares.force[:, FINGERS]
    works = touches[:, FINGERS] & (shares.good[:, FINGERS] >= GOOD_SHARE * force)
    works &= (shares.distal[:, FINGERS] >= GOOD_SHARE * force) | ~asked["precision"][:, None]
    return (works & asked["fingers"]).sum(1) >= asked["needed"]


def _pad(
    shares: ContactShares,
    touches: Tensor,
    asked: dict[str, Tensor],
    abducted: Tensor,
    pip: Tensor,
    total: Tensor,
) -> Tensor:
    """The thumb's pad or end opposes, little is left to the palm, adducted fingers are straight."""
    thumb = touches[:, THUMB] & (shares.good[:, THUMB] >= GOOD_SHARE * shares.force[:, THUMB])
    bend = torch.where(touches[:, FINGERS], pip, torch.zeros_like(pip)).amax(1)
    straight = asked["abducted"] | (bend <= STRAIGHT_PIP)
    return thumb & straight & abducted & (shares.force[:, PALM] <= asked["palm_share"] * total)


def _palm(
    shares: ContactShares,
    touches: Tensor,
    asked: dict[str, Tensor],
    abducted: Tensor,
    total: Tensor,
) -> Tensor:
    """The palm's face carries, and the thumb stands where the name says."""
    thumb = shares.force[:, THUMB]
    not_back = shares.back[:, THUMB] <= GOOD_SHARE * thumb
    face = touches[:, PALM] & (shares.good[:, PALM] >= GOOD_SHARE * shares.force[:, PALM])
    opposing = touches[:, THUMB] & not_back & abducted
    beside = ~abducted & (not_back | (thumb < UNNAMED_SHARE * total))
    return face & torch.where(asked["abducted"], opposing, beside)
