"""Which train objects a policy practises with: those that its topologies can hold."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, zip_longest

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.topology import TOPOLOGIES, resolve_topology
from maniskill_taskgrasp.train.compatibility import compatible_pairs

DEFAULT_TOPOLOGY = "precision pad abd 2-3"  # The task's own default.


def training_pairs(topologies: Sequence[str] | None) -> tuple[list[str], list[str]]:
    """Objects and their topologies, aligned; topologies take turns, the commonest pairs first.

    Args:
        topologies: names, or "all"; the task's default where it is None.

    Raises:
        InputError: an unknown topology, or none that holds any train object.
    """
    names = list(topologies or [DEFAULT_TOPOLOGY])
    if names == ["all"]:
        names = [topology.name for topology in TOPOLOGIES]
    wanted = [resolve_topology(name).name for name in names]
    affordances = [library.load(name).affordance for name in library.names("train")]
    pairs = compatible_pairs(affordances, load_knowledge()).feasible
    queues = [
        sorted((p for p in pairs if p.topology == name), key=lambda p: (-p.rows, p.object))
        for name in wanted
    ]
    turns = [pair for pair in chain.from_iterable(zip_longest(*queues)) if pair is not None]
    if not turns:
        raise InputError(f"no train object suits {', '.join(wanted)}; name some with --objects")
    return [pair.object for pair in turns], [pair.topology for pair in turns]
