"""Which object is to be held in which topology: from flags, tables, the selector or sentences."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.meshfile import SUFFIXES
from maniskill_taskgrasp.assets.objects.model import ObjectModel
from maniskill_taskgrasp.assets.objects.presentation import KINDS
from maniskill_taskgrasp.errors import InputError, echo, unknown_name
from maniskill_taskgrasp.pipeline import Pipeline, choose_topology
from maniskill_taskgrasp.selection.feasibility import feasible
from maniskill_taskgrasp.tasks.arguments import DISTANCES, one_of
from maniskill_taskgrasp.tasks.noise import resolve_noise
from maniskill_taskgrasp.tasks.placement import place
from maniskill_taskgrasp.topology import TOPOLOGIES, Topology, resolve_topology
from maniskill_taskgrasp.train.compatibility import committed_pairs
from maniskill_taskgrasp.train.evaluation_config import EvaluateConfig

if TYPE_CHECKING:
    from maniskill_taskgrasp.selection import Selector

ACTION = "picking up"  # What the selector is told where no sentence names an action.


@dataclass(frozen=True)
class Offer:
    """One row of an evaluation."""

    object: str
    """Name of the object."""
    source: str
    """What the environment is asked for: a library name or a mesh file."""
    topology: Topology | None
    """None where the selector finds none, or there is no object."""
    offered: bool
    """Whether it is tried."""
    reason: str
    """Why it is offered, or why not."""
    presentation: str = ""
    """Kind of presentation."""
    text: str | None = None
    """The sentence it comes from."""

    @property
    def key(self) -> tuple[str, str, str]:
        """Tells rows apart, and decides the seeds of their episodes."""
        return (self.topology.name if self.topology else "", self.object, self.text or "")


def list_offers(config: EvaluateConfig) -> list[Offer]:
    """All rows of an evaluation, those without an offer too.

    Raises:
        InputError: an object, folder or file that does not exist, or an empty one.
    """
    known = ("auto", "stand", *KINDS)
    if config.presentation not in known:
        raise unknown_name("presentation", config.presentation, known)
    resolve_noise(config.noise)
    if config.distance is not None:
        one_of("--distance", config.distance, DISTANCES)
    if config.table is not None:
        # A committed pair is tried even if the hand's limits were changed since.
        offers = [
            Offer(pair.object, pair.object, resolve_topology(pair.topology), True, pair.reason)
            for pair in committed_pairs(config.table)
        ]
    elif config.instructions is not None:
        pipeline = Pipeline()
        offers = [_understood(pipeline, sentence) for sentence in _sentences(config.instructions)]
    else:
        offers = list(_of_objects(config))
    if not offers:
        raise InputError("there is nothing to evaluate: no object or sentence was found")
    distinct = _told_apart(list(dict.fromkeys(offers)))
    chosen = spread(distinct, config.limit) if config.limit else distinct
    return [_presented(offer, config.presentation) for offer in chosen]


def _told_apart(offers: list[Offer]) -> list[Offer]:
    """The offers, objects from different files that share a name numbered."""
    sources: dict[str, list[str]] = {}
    for offer in offers:
        seen = sources.setdefault(offer.object, [])
        if offer.source not in seen:
            seen.append(offer.source)

    def name(offer: Offer) -> str:
        number = sources[offer.object].index(offer.source) + 1
        return offer.object if number == 1 else f"{offer.object} {number}"

    return [replace(offer, object=name(offer)) for offer in offers]


def spread(offers: list[Offer], limit: int) -> list[Offer]:
    """At most so many of the offers, evenly from first to last."""
    if limit >= len(offers):
        return offers
    return [offers[i * len(offers) // limit] for i in range(limit)]


def _of_objects(config: EvaluateConfig) -> Iterable[Offer]:
    names = [t.name for t in TOPOLOGIES] if "all" in config.topologies else config.topologies
    topologies = [resolve_topology(name) for name in names]
    for source in _sources(config):
        try:
            model = library.load(source)
        except InputError as error:
            if config.mesh_dir is None:
                raise
            yield Offer(Path(source).stem, source, None, False, str(error))
            continue
        if topologies:
            for topology in topologies:
                yield Offer(model.name, source, topology, *feasible(topology, model.affordance))
        else:
            yield _selected(model, source)


def _sources(config: EvaluateConfig) -> list[str]:
    if config.mesh_dir is not None:
        if not config.mesh_dir.is_dir():
            raise InputError(f"--mesh-dir must be a folder of meshes, got {echo(config.mesh_dir)}")
        meshes = sorted(p for p in config.mesh_dir.iterdir() if p.suffix.lower() in SUFFIXES)
        if not meshes:
            known = ", ".join(SUFFIXES)
            raise InputError(f"no mesh in {echo(config.mesh_dir)}: files may end in {known}")
        return [str(path) for path in meshes]
    sources: list[str] = []
    for name in config.objects or ("test",):
        sources += library.names(name) if name in (*library.SPLITS, "all", "imported") else [name]
    return list(dict.fromkeys(sources))


@cache
def _selector() -> Selector:
    from maniskill_taskgrasp.selection import Selector

    return Selector.load()


def _selected(model: ObjectModel, source: str) -> Offer:
    """The topology that people would most likely use, of those the hand can."""
    strategy = _selector().rank(model.affordance, ACTION)
    refusals = []
    for topology in strategy.ranked():
        fits, reason = feasible(topology, model.affordance)
        if fits:
            share = 100 * strategy.probabilities[topology.index]
            return Offer(model.name, source, topology, True, f"{share:.0f} % of people; {reason}")
        refusals.append(reason)
    return Offer(model.name, source, None, False, refusals[0])


def _understood(pipeline: Pipeline, sentence: Sentence) -> Offer:
    """What the front end makes of a sentence."""
    text = sentence.text
    selection = pipeline.select(text)
    if selection.rejected:
        return Offer("", "", None, False, selection.reason or "not understood", text=text)
    assert selection.object is not None
    name = selection.object
    refused = Offer(name, name, None, False, "", text=text)
    if sentence.meant and name not in sentence.meant:
        return replace(refused, reason=f"meant was {' or '.join(sentence.meant)}")
    if name not in library.names():
        return replace(refused, reason="not among the library's simulated objects")
    try:
        topology = choose_topology(selection, None)
    except InputError as error:
        return replace(refused, reason=str(error))
    why = next(ranked.why for ranked in selection.topologies if ranked.name == topology.name)
    return Offer(name, name, topology, True, why, text=text)


@dataclass(frozen=True)
class Sentence:
    """An instruction, and the objects it may mean where the file says so."""

    text: str
    meant: tuple[str, ...] = ()


def _sentences(path: Path) -> list[Sentence]:
    """Lines of a text file; or rows of JSON lines, less those that mean no object we carry."""
    try:
        lines = [line for line in path.read_text("utf-8").splitlines() if line.strip()]
        if path.suffix != ".jsonl":
            return [Sentence(line) for line in lines]
        rows = [json.loads(line) for line in lines]
        all_ = [Sentence(row["text"], tuple(row.get("objects", ()))) for row in rows]
    except (OSError, UnicodeDecodeError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"cannot read sentences from {echo(path)}: {error}") from None
    carried = set(library.names())
    labelled = any("objects" in row for row in rows)
    return [s for s in all_ if not labelled or carried & set(s.meant)]


def _presented(offer: Offer, presentation: str) -> Offer:
    """The offer with its presentation; refused where the object cannot be presented so."""
    if not offer.offered:
        return offer
    try:
        model = library.load(offer.source)
        placement = place(model, presentation, topology=offer.topology)
    except InputError as error:
        return replace(offer, offered=False, reason=str(error))
    return replace(offer, presentation=placement.presentation.kind)
