"""What the hand can hold: limits that decide, and the human ranking that they leave alone."""

from dataclasses import replace

import pytest

from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import Affordance, load_knowledge
from maniskill_taskgrasp.selection import feasible
from maniskill_taskgrasp.selection.feasibility import HandLimits, closing_extents, hand_limits
from maniskill_taskgrasp.topology import TOPOLOGIES

ROD = Affordance("rod", (0.14, 0.04, 0.04), 0.1, "b/c", "rigid", "a", "prolate", "cylinder")
LIMITS = hand_limits()
FORMED = [topology for topology in TOPOLOGIES if topology.name not in LIMITS.unformed]


@pytest.mark.parametrize("topology", FORMED, ids=lambda t: t.slug)
def test_limits_decide_and_are_named(topology):
    """Each topology takes its limits' edges and refuses what is just beyond, saying the number."""
    reach = LIMITS.reach[topology.name]
    for extent in (reach.thickest_m, max(reach.thinnest_m, 0.001)):
        fits = replace(ROD, dimensions_m=(0.15, extent, extent), mass_kg=reach.payload_kg)
        assert feasible(topology, fits)[0]
    wide = reach.thickest_m + 0.001
    able, why = feasible(topology, replace(ROD, dimensions_m=(0.15, wide, wide), mass_kg=0.01))
    assert not able
    assert f"{1000 * wide:.4g} mm" in why
    heavy = replace(fits, mass_kg=reach.payload_kg + 0.001)
    able, why = feasible(topology, heavy)
    assert not able
    assert " g" in why


@pytest.mark.parametrize("name", LIMITS.unformed)
def test_what_the_hand_cannot_form_fits_nothing(name):
    """Not even a thing within the reach that the topology would have."""
    reach = LIMITS.reach[name]
    fits = replace(ROD, dimensions_m=(0.15,) + 2 * (reach.thickest_m,), mass_kg=0.01)
    assert feasible(name, fits) == (False, LIMITS.unformed[name])


def test_heavier_or_wider_never_helps():
    """Feasibility is monotone in mass, and in size above the least extent."""
    for topology in TOPOLOGIES:
        masses = [
            feasible(topology, replace(ROD, dimensions_m=(0.15, 0.03, 0.03), mass_kg=m))[0]
            for m in (0.05, 0.15, 0.25, 0.35, 0.5)
        ]
        assert masses == sorted(masses, reverse=True)


def test_one_fitting_extent_is_enough():
    """A book too wide to span is held across its thickness."""
    book = replace(ROD, dimensions_m=(0.15, 0.11, 0.03), grasped_dimension="b/c")
    assert closing_extents(book) == (0.03, 0.11)
    assert feasible("power palm abd 2-5", book)[0]
    spine_up = replace(book, grasped_dimension="b")
    assert not feasible("power palm abd 2-5", spine_up)[0]


def test_floppy_objects_are_refused():
    """Zero extents are a code, not a size that fits."""
    towel = load_knowledge().affordance("towel")
    for topology in TOPOLOGIES:
        able, why = feasible(topology, towel)
        assert not able
        assert "floppy" in why


def test_reasons_are_one_line():
    """Every answer for every object is one clause."""
    for affordance in load_knowledge().objects.values():
        for topology in TOPOLOGIES:
            assert "\n" not in feasible(topology, affordance)[1]


def test_half_of_what_people_did_remains():
    """The rule keeps at least half of the rigid (object, topology) pairs that people showed."""
    knowledge = load_knowledge()
    shown = {
        (obj, index)
        for (obj, _), counts in knowledge.pair_counts.items()
        for index, rows in enumerate(counts)
        if rows and not knowledge.objects[obj].is_floppy
    }
    kept = [feasible(TOPOLOGIES[i], knowledge.objects[obj])[0] for obj, i in shown]
    assert sum(kept) >= len(kept) / 2


def test_unknown_topology_is_input_error():
    """A wrong name is refused with a close one."""
    with pytest.raises(InputError, match="power palm abd 2-5"):
        feasible("power palm abd 25", ROD)


def test_another_hand_is_another_file():
    """The file is all that a hand's limits need; one that lacks a topology is refused."""
    row = {"thinnest_m": 0.0, "thickest_m": 0.1, "payload_kg": 1.0}
    names = [topology.name for topology in TOPOLOGIES]
    found = HandLimits.from_json({"reach": dict.fromkeys(names, row), "unformed": {}})
    assert {reach.payload_kg for reach in found.reach.values()} == {1.0}
    with pytest.raises(ValueError, match="in this order"):
        HandLimits.from_json({"reach": dict.fromkeys(names[1:], row), "unformed": {}})


def test_the_limits_and_the_postures_agree_on_what_the_hand_forms():
    """A topology that selection never offers is one that the description calls infeasible."""
    unformed = {t.name for t in TOPOLOGIES if not AR10.postures[t.slug].feasible}
    assert unformed == set(LIMITS.unformed)
