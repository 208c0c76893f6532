"""Form: are the contacts those that the topology's name says? (facts: grasping, section 6)

A hand may lift an object that is trapped on the back of the thumb. That is a lift, and not the
grasp that was asked for; this file tells the two apart from forces alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.hand import PARTS, HandDescription
from maniskill_taskgrasp.topology import TOPOLOGIES

TOUCH_FORCE = 0.05  # [N] a digit touches from here on.
SURFACE_ANGLE = 60.0  # [deg] a contact this close to the arc from pad to end is on good surface.
BACK_COSINE = -0.5  # Normal against the pad's direction: the back of the digit.
GOOD_SHARE = 0.5  # Least share of a digit's force on good surface.
UNNAMED_SHARE = 0.10  # Most force on digits that the name does not list.
PALM_SHARE = {"Precision": 0.05, "Power": 0.25}  # Most force on the palm in pad types.
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


def arc_cosine(normal: Tensor, pad: Tensor, end: Tensor) -> Tensor:
    """Cosine of the angle between directions and the quarter circle from a pad to an end.

    Args:
        normal: (..., 3) unit directions.
        pad: (..., 3) unit direction that the quarter circle starts at.
        end: (..., 3) unit direction that it ends at, square to `pad`.

    Returns:
        (...)
    """
    return _arc_cosine((normal * pad).sum(-1), (normal * end).sum(-1))


def _arc_cosine(along_pad: Tensor, along_end: Tensor) -> Tensor:
    """The same from the cosines of the angles to both ends."""
    between = (along_pad >= 0) & (along_end >= 0)
    return torch.where(
        between, torch.hypot(along_pad, along_end), torch.maximum(along_pad, along_end)
    )


class ContactSurfaces:
    """Sorts a hand's link forces into good surface, back and last link, part by part.

    The pad's quarter circle of the last link serves the whole digit; the thumb's other link has
    its working side in the middle of it.
    """

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
        force = torch.linalg.vector_norm(link_forces, dim=-1)
        normal = -link_forces / force.clamp(min=1e-9)[..., None]
        along_pad, along_end = (normal * self._pad).sum(-1), (normal * self._end).sum(-1)
        good = _arc_cosine(along_pad, along_end) >= math.cos(math.radians(SURFACE_ANGLE))
        # The palm works with its face, whose normal is +y, as that of a finger's pad.
        palm = self.part_of_link == PALM
        good = torch.where(palm, along_pad >= PALM_NORMAL, good)
        back = along_pad < BACK_COSINE
        by_link = torch.stack([force, force * good, force * back, force * self._distal])
        total = force.new_zeros(len(by_link), len(force), len(PARTS))
        return ContactShares(*total.index_add_(2, self.part_of_link, by_link))


@cache
def _topology_table(device: torch.device) -> dict[str, Tensor]:
    """What each topology asks for; every column is (15, ...)."""
    parts = torch.tensor([[part in t.parts for part in PARTS] for t in TOPOLOGIES])
    side = torch.tensor([t.opposition == "Side" for t in TOPOLOGIES])
    digits = torch.tensor([part != "palm" for part in PARTS]).expand_as(parts).clone()
    digits[:, THUMB] = side  # Elsewhere the thumb is named or has a clause of its own.
    columns = {
        "parts": parts,
        "unnamed": digits & ~parts,
        "fingers": parts[:, FINGERS],
        # Three of four are enough where the name lists all four fingers.
        "needed": parts[:, FINGERS].sum(1).clamp(max=3),
        "abducted": torch.tensor([t.thumb_abducted for t in TOPOLOGIES]),
        "pad": torch.tensor([t.opposition == "Pad" for t in TOPOLOGIES]),
        "side": side,
        "precision": torch.tensor([t.pip == "Precision" for t in TOPOLOGIES]),
        "palm_share": torch.tensor([PALM_SHARE.get(t.pip, 1.0) for t in TOPOLOGIES]),
    }
    return {name: column.to(device) for name, column in columns.items()}


@dataclass(frozen=True)
class _Grasp:
    """A batch of grasps beside what was asked for."""

    shares: ContactShares
    asked: dict[str, Tensor]
    thumb_rotation: Tensor
    pip: Tensor
    hand: HandDescription

    @cached_property
    def touches(self) -> Tensor:
        """(num_envs, num_parts) bool"""
        return self.shares.force >= TOUCH_FORCE

    @cached_property
    def total(self) -> Tensor:
        """(num_envs,) [N]"""
        return self.shares.force.sum(1)

    @cached_property
    def abducted(self) -> Tensor:
        """(num_envs,) bool: the thumb stands opposite the fingers."""
        return self.thumb_rotation >= self.hand.thumb_abducted


def asked_of(topology_index: Tensor) -> dict[str, Tensor]:
    """What topologies (num_envs,), places in `topology.TOPOLOGIES`, ask for, row by row."""
    return {k: v[topology_index] for k, v in _topology_table(topology_index.device).items()}


def in_topology(
    shares: ContactShares,
    asked: dict[str, Tensor],
    thumb_rotation: Tensor,
    pip: Tensor,
    hand: HandDescription,
) -> Tensor:
    """Is the hand in the topology it was asked for?

    Pad and palm types follow fact sheet "grasping", section 6. Side types are ours: every part that
    the topology names touches; as everywhere, unnamed digits (here the thumb too) carry little.

    Args:
        shares: forces averaged over the last moments of the hold.
        asked: what `asked_of` says of the topologies.
        thumb_rotation: (num_envs,) [rad] commanded rotation of the thumb.
        pip: (num_envs, 4) [rad] middle joints of index, middle, ring, little.
        hand: whose thresholds of rotation and bend count.

    Returns:
        (num_envs,) bool
    """
    grasp = _Grasp(shares, asked, thumb_rotation, pip, hand)
    unnamed = (shares.force * asked["unnamed"]).sum(1)
    named = (grasp.touches | ~asked["parts"]).all(1)
    opposed = torch.where(asked["pad"], _pad_opposes(grasp), _palm_opposes(grasp))
    contacts = torch.where(asked["side"], named, _fingers_work(grasp) & opposed)
    return contacts & (unnamed <= UNNAMED_SHARE * grasp.total)


def _fingers_work(grasp: _Grasp) -> Tensor:
    """Enough named fingers press with their pads; in precision types with the last link."""
    shares, asked = grasp.shares, grasp.asked
    enough = GOOD_SHARE * shares.force
    works = grasp.touches & (shares.good >= enough)
    works &= (shares.distal >= enough) | ~asked["precision"][:, None]
    return (works[:, FINGERS] & asked["fingers"]).sum(1) >= asked["needed"]


def _pad_opposes(grasp: _Grasp) -> Tensor:
    """The thumb's pad or end opposes, little is left to the palm, adducted fingers are straight."""
    shares, asked = grasp.shares, grasp.asked
    thumb = grasp.touches[:, THUMB]
    thumb = thumb & (shares.good[:, THUMB] >= GOOD_SHARE * shares.force[:, THUMB])
    bend = (grasp.pip * grasp.touches[:, FINGERS]).amax(1)
    straight = asked["abducted"] | (bend <= grasp.hand.straight_pip)
    palm = shares.force[:, PALM] <= asked["palm_share"] * grasp.total
    return thumb & grasp.abducted & straight & palm


def _palm_opposes(grasp: _Grasp) -> Tensor:
    """The palm's face carries, and the thumb stands where the name says."""
    force, back = grasp.shares.force[:, THUMB], grasp.shares.back[:, THUMB]
    face = grasp.shares.good[:, PALM] >= TOUCH_FORCE
    not_back = back <= GOOD_SHARE * force
    opposite = grasp.touches[:, THUMB] & not_back & grasp.abducted
    beside = (grasp.thumb_rotation <= grasp.hand.thumb_abducted) & (
        not_back | (force < UNNAMED_SHARE * grasp.total)
    )
    return face & torch.where(grasp.asked["abducted"], opposite, beside)
