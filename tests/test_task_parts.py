"""What the task is put together from: its arguments, what controllers know, what parts are for."""

import pytest
import torch

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.episode import MAX_EPISODE_STEPS, PHASE_ENDS, PHASES
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.tasks.arguments import one_of, resolve_objects, resolve_topologies
from maniskill_taskgrasp.tasks.observation import KnownFacts
from maniskill_taskgrasp.tasks.rewards import PartRoles
from maniskill_taskgrasp.topology import TOPOLOGIES, resolve_topology

CPU = torch.device("cpu")


def test_topologies_are_one_some_or_all():
    pad = resolve_topology("precision pad abd 2")
    assert resolve_topologies("precision pad abd 2", None) == [pad]
    assert resolve_topologies("precision pad abd 2", f"pd_synergy_{pad.slug}") == [pad]
    assert resolve_topologies([pad.name, pad.name], None) == [pad, pad]
    assert resolve_topologies("all", "pd_synergy") == list(TOPOLOGIES)
    with pytest.raises(InputError, match="at least one topology"):
        resolve_topologies([], None)


def test_a_control_mode_of_another_topology_is_refused():
    slug = resolve_topology("power palm abd 2-5").slug
    with pytest.raises(InputError, match="closes 'Power palm abd 2-5', not 'Precision pad abd 2'"):
        resolve_topologies("precision pad abd 2", f"pd_synergy_{slug}")


def test_objects_are_one_some_or_a_split():
    assert resolve_objects("marker") == ["marker"]
    assert resolve_objects(["marker", "a.stl"]) == ["marker", "a.stl"]
    train, test = resolve_objects("train"), resolve_objects("test")
    assert sorted(train + test) == sorted(resolve_objects("all"))
    assert resolve_objects(["train", "a.stl"]) == [*train, "a.stl"]
    assert not set(train) & set(test)
    with pytest.raises(InputError, match="at least one object"):
        resolve_objects([])


def test_a_value_that_is_not_allowed_is_named_with_those_that_are():
    assert one_of("obs", "full", ("full", "paper")) == "full"
    with pytest.raises(InputError, match=r"obs must be one of full, paper, got .*all"):
        one_of("obs", "all", ("full", "paper"))


def test_known_facts_follow_the_clock():
    """One phase at a time, each until its end; the share of the episode that is over."""
    facts = KnownFacts(torch.tensor([[0.1, 0.2, 0.3]]))
    plan = torch.tensor([4]), torch.ones(1, 6), torch.zeros(1, 3)
    for step in range(MAX_EPISODE_STEPS + 3):  # The clock of a state may stand past the end.
        known = facts(torch.tensor([step]), *plan)
        phase = sum(step >= end for end in PHASE_ENDS)
        expected = torch.zeros(1, len(PHASES))
        expected[0, min(phase, len(PHASES) - 1)] = 1
        assert torch.equal(known["phase"], expected), step
        assert known["progress"].item() == pytest.approx(step / MAX_EPISODE_STEPS)
    assert known["topology"].argmax(1).item() == 4
    assert known["topology"].sum().item() == 1


def test_every_named_part_either_opposes_or_is_a_finger():
    """And topologies are looked up by their place."""
    roles = PartRoles.of_topologies(CPU)
    assert torch.equal(roles.opposing | roles.fingers, roles.named)
    assert not (roles.opposing & roles.fingers).any()
    index = resolve_topology("precision pad abd 2-3").index
    named, opposing, fingers = roles.of(torch.tensor([index]))
    asked = [
        [p for p, is_in in zip(PARTS, row[0], strict=True) if is_in]
        for row in (named, opposing, fingers)
    ]
    assert asked == [["index", "middle", "thumb"], ["thumb"], ["index", "middle"]]
