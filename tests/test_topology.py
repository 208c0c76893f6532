"""The 15 topologies: names, slugs, parts, and how users may write them."""

import csv

import pytest

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.agents.sawyer_ar10.description import SAWYER_AR10
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.topology import (
    OPPOSITIONS,
    PIPS,
    TOPOLOGIES,
    TOPOLOGY_NAMES,
    resolve_topology,
)


def test_there_are_fifteen_in_the_datasets_order(shared_dir):
    """The dataset's label columns are the topologies, in our order, and a 16th we do not use."""
    path = next((shared_dir / "data").rglob("*.csv"))
    with path.open(newline="", encoding="utf-8-sig") as file:
        header = [column.strip() for column in next(csv.reader(file))]
    start = header.index(TOPOLOGY_NAMES[0])
    assert tuple(header[start : start + 15]) == TOPOLOGY_NAMES


def test_index_is_the_place_in_the_order():
    """`index` numbers the topologies as every 15-wide array does."""
    assert [t.index for t in TOPOLOGIES] == list(range(15))


def test_opposition_and_pip_are_of_the_known_kinds():
    """No topology falls outside the two vocabularies, and each word is used."""
    assert {t.opposition for t in TOPOLOGIES} == set(OPPOSITIONS)
    assert {t.pip for t in TOPOLOGIES} == set(PIPS)


@pytest.mark.parametrize("topology", TOPOLOGIES, ids=lambda t: t.slug)
def test_every_spelling_of_a_name_resolves(topology):
    """Name, slug, any case, blanks around: the same topology."""
    spellings = (topology.name, topology.slug, topology.name.upper(), f"  {topology.slug} ")
    assert all(resolve_topology(spelling) is topology for spelling in spellings)


def test_slugs_are_identifiers_and_differ():
    """Control modes and keyframes are named after them."""
    slugs = {t.slug for t in TOPOLOGIES}
    assert len(slugs) == 15
    assert all(slug.isidentifier() and slug.islower() for slug in slugs)


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("Power palm add 3-5", {"palm", "middle", "ring", "little"}),
        ("Power palm abd 2-5", {"palm", "thumb", "index", "middle", "ring", "little"}),
        ("Power pad abd 2", {"thumb", "index"}),
        ("Precision pad abd 2-4", {"thumb", "index", "middle", "ring"}),
        ("Intermediate abd 2", {"index", "middle"}),  # Scissors: no thumb.
        ("Intermediate add 2", {"thumb", "index"}),
        ("Precision side abd 3", {"thumb", "index", "middle"}),
    ],
)
def test_parts_are_those_that_press(name, parts):
    """The digits of the name, and what stands against them."""
    assert set(resolve_topology(name).parts) == parts


def test_parts_are_parts_of_the_hand():
    """Sensing knows every part that a topology names."""
    assert all(set(t.parts) <= set(PARTS) for t in TOPOLOGIES)


def test_the_hand_has_a_posture_for_every_topology():
    """One posture a slug, none left over, every number inside the joints' limits."""
    assert set(AR10.postures) == {t.slug for t in TOPOLOGIES}
    joints = [SAWYER_AR10.joint(name) for name in AR10.actuators]
    for posture in AR10.postures.values():
        for angles in (posture.preshape, posture.closing):
            assert len(angles) == len(joints)
            assert all(j.lower <= a <= j.upper for j, a in zip(joints, angles, strict=True))


def test_an_unknown_name_says_what_would_do():
    """One line, with the bad name and the nearest good one."""
    with pytest.raises(InputError) as error:
        resolve_topology("power pad abd 9")
    message = str(error.value)
    assert "power pad abd 9" in message
    assert "power pad abd 2" in message
    assert "\n" not in message
