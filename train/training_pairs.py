"""Which train objects a policy practises with: those that its topologies can hold."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, zip_longest

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.tasks.grasp_library import stored_grasps
from maniskill_taskgrasp.topology import TOPOLOGIES, resolve_topology
from maniskill_taskgrasp.train.compatibility import Pair, compatible_pairs

DEFAULT_TOPOLOGY = "precision pad abd 2-3"  # The task's own default.

HOLDS = 0.6  # Share of trials in lift and form from which a stored grasp counts as proven.


def training_pairs(topologies: Sequence[str] | None) -> tuple[list[str], list[str]]:
    """Objects and their topologies, aligned; topologies take turns, the commonest pairs first.

    Pairs for which a grasp is stored that holds come before all others.

    Args:
        topologies: names, or "all"; the task's default where it is None.

    Raises:
        InputError: an unknown topology, or none that holds any train object.
    """
    names = list(topologies or [DEFAULT_TOPOLOGY])
    if names == ["all"]:
        names = [topology.name for topology in TOPOLOGIES]
    wanted = [resolve_topology(name) for name in names]
    affordances = [library.load(name).affordance for name in library.names("train")]
    pairs = compatible_pairs(affordances, load_knowledge()).feasible
    proven = {(grasp.topology, grasp.obj) for grasp in stored_grasps() if grasp.both >= HOLDS}
    queues: dict[bool, list[list[Pair]]] = {True: [], False: []}
    for topology in wanted:
        own = sorted(
            (pair for pair in pairs if pair.topology == topology.name),
            key=lambda pair: (-pair.rows, pair.object),
        )
        for known, lists in queues.items():
            lists.append([p for p in own if ((topology.slug, p.object) in proven) == known])
    rounds = chain(zip_longest(*queues[True]), zip_longest(*queues[False]))
    turns = [pair for pair in chain.from_iterable(rounds) if pair is not None]
    if not turns:
        raise InputError(
            f"no train object suits {', '.join(t.name for t in wanted)}; name some with --objects"
        )
    return [pair.object for pair in turns], [pair.topology for pair in turns]
