"""Form of a grasp: every clause of the definition, one at a time."""

import math

import pytest
import torch

from maniskill_taskgrasp.agents.fidelity import (
    ContactShares,
    ContactSurfaces,
    arc_cosine,
    asked_of,
    in_topology,
)
from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.topology import resolve_topology

FINGERS = ("index", "middle", "ring", "little")
LINKS = [link for links in AR10.part_links.values() for link in links]
ABDUCTED, ADDUCTED = 1.33, 0.90  # [rad]
BENT, STRAIGHT = 1.0, 0.3  # [rad]


def share(force, good=1.0, back=0.0, distal=1.0):
    """Force of a part [N] and which shares of it are on good surface, back and last link."""
    return {"force": force, "good": good * force, "back": back * force, "distal": distal * force}


def formed(topology, parts, thumb=ABDUCTED, pip=BENT):
    """Whether a grasp with these parts (name -> share) is in the topology."""
    rows = [parts.get(part, share(0.0)) for part in PARTS]
    columns = {key: torch.tensor([[row[key] for row in rows]]) for key in rows[0]}
    index = torch.tensor([resolve_topology(topology).index])
    result = in_topology(
        ContactShares(**columns),
        asked_of(index),
        torch.tensor([thumb]),
        torch.full((1, 4), pip),
        AR10,
    )
    return bool(result[0])


def all_named(topology, newtons=2.0):
    """Every part that the name lists presses as it should."""
    return {part: share(newtons) for part in resolve_topology(topology).parts}


# -- surfaces ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("normal", "cosine"),
    [
        ((1.0, 0.0, 0.0), 1.0),  # The pad itself.
        ((0.6, 0.8, 0.0), 1.0),  # Between pad and end.
        ((0.6, 0.0, 0.8), 0.6),  # Off the arc's plane.
        ((-0.6, 0.8, 0.0), 0.8),  # Beyond the end: the end is nearest.
        ((-1.0, 0.0, 0.0), 0.0),  # The back is a right angle off the end.
        ((-0.6, -0.8, 0.0), -0.6),  # Both behind: the nearer of the two.
    ],
)
def test_arc_cosine_is_that_to_the_nearest_direction(normal, cosine):
    pad, end = torch.tensor([1.0, 0.0, 0.0]), torch.tensor([0.0, 1.0, 0.0])
    assert arc_cosine(torch.tensor(normal), pad, end).item() == pytest.approx(cosine, abs=1e-6)


def test_pad_arcs_are_quarter_circles():
    """The hand's pad and end directions are unit vectors, square to each other."""
    for pad, end in (AR10.thumb_pad_arc, AR10.finger_pad_arc):
        assert math.hypot(*pad) == pytest.approx(1.0, abs=1e-3)
        assert math.hypot(*end) == pytest.approx(1.0, abs=1e-3)
        assert sum(a * b for a, b in zip(pad, end, strict=True)) == pytest.approx(0.0, abs=1e-3)


def direction(degrees_off_pad):
    """Outward normal of a finger, so many degrees from the pad away from the end."""
    angle = math.radians(degrees_off_pad)
    return (0.0, math.cos(angle), -math.sin(angle))


@pytest.mark.parametrize(
    ("link", "normal", "good", "back"),
    [
        ("index_distal", (0.0, 1.0, 0.0), True, False),  # Pad.
        ("index_distal", (0.0, 0.0, 1.0), True, False),  # End.
        ("index_distal", (1.0, 0.0, 0.0), False, False),  # Side.
        ("index_distal", (0.0, -1.0, 0.0), False, True),  # Back.
        ("index_distal", direction(59.0), True, False),  # Within 60 degrees of the arc.
        ("index_distal", direction(61.0), False, False),
        ("index_distal", direction(119.0), False, False),  # The back begins at 120 degrees.
        ("index_distal", direction(121.0), False, True),
        ("thumb_distal", (0.764, 0.0, 0.645), True, False),
        ("thumb_distal", (-0.645, 0.0, 0.764), True, False),
        ("thumb_distal", (0.0, 1.0, 0.0), False, False),
        ("thumb_distal", (-0.764, 0.0, -0.645), False, True),
        ("hand_base", (0.0, 0.51, math.sqrt(1 - 0.51**2)), True, False),  # The palm's face.
        ("hand_base", (0.0, 0.49, math.sqrt(1 - 0.49**2)), False, False),
    ],
)
def test_surfaces_sort_a_contact_by_its_normal(link, normal, good, back):
    """Outward normals decide; the force on the link points the other way."""
    surfaces = ContactSurfaces(AR10, LINKS, torch.device("cpu"))
    forces = torch.zeros(1, len(LINKS), 3)
    forces[0, LINKS.index(link)] = -3.0 * torch.tensor(normal)
    shares = surfaces.shares(forces)
    part = next(p for p, links in AR10.part_links.items() if link in links)
    column = PARTS.index(part)
    assert shares.force[0, column].item() == pytest.approx(3.0, abs=1e-2)
    assert (shares.good[0, column] > 0).item() is good
    assert (shares.back[0, column] > 0).item() is back
    assert shares.force.sum() == shares.force[0, column]


def test_shares_add_up_over_the_links_of_a_part():
    """A part's force is the sum of its links' magnitudes; the last link's is told apart."""
    surfaces = ContactSurfaces(AR10, LINKS, torch.device("cpu"))
    forces = torch.zeros(1, len(LINKS), 3)
    forces[0, LINKS.index("ring_middle"), 1] = -1.0
    forces[0, LINKS.index("ring_distal"), 1] = 2.0  # On the back.
    shares = surfaces.shares(forces)
    ring = PARTS.index("ring")
    found = [getattr(shares, name)[0, ring].item() for name in ("force", "good", "back", "distal")]
    assert found == pytest.approx([3.0, 1.0, 2.0, 2.0])


# -- clauses -----------------------------------------------------------------------------------

PAD_TYPES = ("power pad abd 2", "precision pad abd 2-3", "precision pad abd 2-5")
PALM_ABD, PALM_ADD = "power palm abd 2-5", "power palm add 2-5"
SIDE_TYPES = (
    "intermediate abd 2",
    "intermediate add 2",
    "intermediate add 3",
    "precision side abd 3",
)


@pytest.mark.parametrize("topology", [*PAD_TYPES, PALM_ABD, *SIDE_TYPES])
def test_all_named_parts_pressing_well_is_the_topology(topology):
    assert formed(topology, all_named(topology))


@pytest.mark.parametrize("topology", ["power palm add 3-5", PALM_ADD])
def test_adducted_palm_types_want_the_thumb_beside(topology):
    assert formed(topology, all_named(topology), thumb=ADDUCTED)
    assert not formed(topology, all_named(topology), thumb=ABDUCTED)


@pytest.mark.parametrize("topology", [*PAD_TYPES, PALM_ABD, *SIDE_TYPES])
def test_nothing_touched_is_no_topology(topology):
    assert not formed(topology, {})


def test_a_touch_needs_a_twentieth_of_a_newton():
    """The thumb at 0.05 N touches, at 0.04 N it does not."""
    parts = all_named("power pad abd 2")
    assert formed("power pad abd 2", parts | {"thumb": share(0.05)})
    assert not formed("power pad abd 2", parts | {"thumb": share(0.04)})


def test_an_object_on_the_thumbs_back_is_trapped_not_pinched():
    parts = all_named("power pad abd 2-3") | {"thumb": share(2.0, good=0.0, back=1.0)}
    assert not formed("power pad abd 2-3", parts)


@pytest.mark.parametrize(("good", "expected"), [(0.5, True), (0.49, False)])
@pytest.mark.parametrize("part", ["thumb", "index"])
def test_half_of_a_digits_force_must_be_on_good_surface(part, good, expected):
    parts = all_named("power pad abd 2") | {part: share(2.0, good=good)}
    assert formed("power pad abd 2", parts) is expected


@pytest.mark.parametrize(
    ("topology", "distal", "expected"),
    [
        ("precision pad abd 2", 0.5, True),
        ("precision pad abd 2", 0.49, False),
        ("power pad abd 2", 0.0, True),  # Power grasps may use the whole finger.
    ],
)
def test_precision_needs_half_of_the_force_on_the_last_link(topology, distal, expected):
    parts = all_named(topology) | {"index": share(2.0, distal=distal)}
    assert formed(topology, parts) is expected


@pytest.mark.parametrize("missing", FINGERS)
def test_three_of_four_fingers_are_enough(missing):
    """2-5 forgives one finger; 2-4 forgives none."""
    without = {p: s for p, s in all_named("precision pad abd 2-5").items() if p != missing}
    assert formed("precision pad abd 2-5", without)
    two = {p: s for p, s in without.items() if p != FINGERS[(FINGERS.index(missing) + 1) % 4]}
    assert not formed("precision pad abd 2-5", two)


@pytest.mark.parametrize("missing", ["index", "middle", "ring"])
def test_up_to_three_named_fingers_are_all_needed(missing):
    parts = all_named("power pad abd 2-4")
    assert not formed("power pad abd 2-4", {p: s for p, s in parts.items() if p != missing})


@pytest.mark.parametrize(("force", "expected"), [(0.4, True), (0.5, False)])
@pytest.mark.parametrize("topology", ["power pad abd 2", "intermediate add 2"])
def test_unnamed_fingers_carry_a_tenth_at_most(topology, force, expected):
    """0.4 of 4.4 N is below a tenth, 0.5 of 4.5 N is above."""
    parts = all_named(topology) | {"ring": share(force)}
    assert formed(topology, parts) is expected


def test_the_thumb_has_no_part_in_a_scissor_grasp():
    """Index against middle: a thumb that carries more than a tenth makes another grasp of it."""
    parts = all_named("intermediate abd 2")
    assert formed("intermediate abd 2", parts | {"thumb": share(0.4)})
    assert not formed("intermediate abd 2", parts | {"thumb": share(0.5)})


@pytest.mark.parametrize("topology", SIDE_TYPES)
def test_side_types_need_every_named_part_on_whatever_surface(topology):
    parts = {p: share(2.0, good=0.0, distal=0.0) for p in resolve_topology(topology).parts}
    assert formed(topology, parts)
    for missing in parts:
        assert not formed(topology, {p: s for p, s in parts.items() if p != missing})


@pytest.mark.parametrize(
    ("topology", "palm", "expected"),
    [
        ("precision pad abd 2", 0.2, True),  # 0.2 of 4.2 N = 4.8 %.
        ("precision pad abd 2", 0.22, False),  # 5.2 %
        ("power pad abd 2", 1.3, True),  # 24.5 %
        ("power pad abd 2", 1.4, False),  # 25.9 %
    ],
)
def test_pad_types_leave_little_to_the_palm(topology, palm, expected):
    assert formed(topology, all_named(topology) | {"palm": share(palm)}) is expected


@pytest.mark.parametrize(("thumb", "expected"), [(1.10, True), (1.09, False)])
@pytest.mark.parametrize("topology", [*PAD_TYPES, PALM_ABD])
def test_abducted_types_want_the_thumb_opposite(topology, thumb, expected):
    assert formed(topology, all_named(topology), thumb=thumb) is expected


@pytest.mark.parametrize(("pip", "expected"), [(STRAIGHT, True), (BENT, False)])
def test_parallel_extension_wants_straight_fingers(pip, expected):
    topology = "precision pad add 2-5"
    assert formed(topology, all_named(topology), pip=pip) is expected


def test_palm_types_need_the_palms_face():
    """An object on the palm's edge, or none there at all, is no palm grasp."""
    parts = all_named(PALM_ABD)
    assert not formed(PALM_ABD, parts | {"palm": share(2.0, good=0.0)})
    assert not formed(PALM_ABD, parts | {"palm": share(0.0)})


@pytest.mark.parametrize(
    ("thumb", "expected"),
    [
        (share(2.0, good=0.0), True),  # On its side.
        (share(2.0, good=0.5, back=0.5), True),
        (share(2.0, good=0.4, back=0.6), False),
        (share(0.0), False),
    ],
)
def test_palm_abducted_forgives_half_on_the_thumbs_back(thumb, expected):
    assert formed(PALM_ABD, all_named(PALM_ABD) | {"thumb": thumb}) is expected


@pytest.mark.parametrize(
    ("thumb", "expected"),
    [
        (share(0.0), True),  # Absent.
        (share(0.9, good=0.0, back=1.0), True),  # 0.9 of 10.9 N: below a tenth.
        (share(3.0, good=0.0, back=1.0), False),
        (share(3.0, good=0.0, back=0.5), True),
    ],
)
def test_palm_adducted_tolerates_a_weak_thumb(thumb, expected):
    parts = all_named(PALM_ADD) | {"thumb": thumb}
    assert formed(PALM_ADD, parts, thumb=ADDUCTED) is expected


def test_environments_are_judged_each_by_its_own_topology():
    """One batch, same contacts, two names: two fingers are right for one of them."""
    columns = {
        key: torch.tensor([[share(2.0 if p in ("index", "thumb") else 0.0)[key] for p in PARTS]])
        for key in ("force", "good", "back", "distal")
    }
    shares = ContactShares(**{key: column.expand(2, -1) for key, column in columns.items()})
    names = ("precision pad abd 2", "precision pad abd 2-3")
    index = torch.tensor([resolve_topology(name).index for name in names])
    found = in_topology(
        shares, asked_of(index), torch.full((2,), ABDUCTED), torch.full((2, 4), BENT), AR10
    )
    assert found.tolist() == [True, False]
