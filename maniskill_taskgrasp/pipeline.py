"""From a sentence to a grasp: the one place that knows all rooms of the house."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from maniskill_taskgrasp.errors import InputError, echo
from maniskill_taskgrasp.topology import Topology, resolve_topology

if TYPE_CHECKING:
    from maniskill_taskgrasp.knowledge import Affordance
    from maniskill_taskgrasp.language.instruction import Instruction
    from maniskill_taskgrasp.selection.strategy import GraspStrategy
    from maniskill_taskgrasp.tasks.own_search import FoundGrasp

TOP = 3  # Topologies that a report names.
SEED_LIMIT = 2**32  # Numpy's generators take less.


@dataclass(frozen=True)
class RankedTopology:
    """A topology with what people and the hand say of it."""

    name: str
    probability: float
    """Share of people who would use it, as far as the selector knows."""
    feasible: bool
    """Whether this hand can hold this object so."""
    why: str


@dataclass(frozen=True)
class Selection:
    """The front end's answer to a sentence."""

    text: str
    action: str | None = None
    action_score: float = 0.0
    actions_top3: list[dict[str, Any]] = field(default_factory=list)
    object: str | None = None
    object_score: float = 0.0
    rejected: bool = False
    reason: str | None = None
    topologies: list[RankedTopology] = field(default_factory=list)
    """All 15, most probable first."""
    opposition: dict[str, float] = field(default_factory=dict)
    pip: dict[str, float] = field(default_factory=dict)
    evidence: int = 0
    """Human grasps of exactly this object and action behind the probabilities."""
    notes: list[str] = field(default_factory=list)

    def to_json(self) -> dict[str, Any]:
        """JSON-able, with the keys of the command line's contract."""
        return asdict(self)


@dataclass(frozen=True)
class GraspResult:
    """What became of one instruction."""

    instruction: str
    action: str | None
    object: str
    strategy: list[RankedTopology]
    topology: str
    presentation: str
    episodes: int
    successes: int
    lift_m: list[float]
    """Highest rise of the object in each episode."""
    failure: list[str]
    """Failure class of each episode; "none" is success."""
    fidelity: list[bool]
    """Whether the contacts at the end were those of the topology's name."""
    video: str | None
    seconds: float
    notes: list[str]
    search: dict[str, Any] | None = None
    """What a search on the object itself took and found; None where the stored grasps decided."""

    def to_json(self) -> dict[str, Any]:
        """JSON-able, with the keys of the command line's contract."""
        return asdict(self)


@dataclass(frozen=True, kw_only=True)
class GraspOptions:
    """How an instruction is carried out."""

    object: str | None = None
    """A library object or a mesh file that overrides the sentence's object."""
    topology: str | None = None
    """A topology that overrides the selector's choice."""
    policy: str = "follow"
    """"constant" (closes all the way), "follow" (the palm also follows the object by what is
    sensed), another rule of docs/planning.md, "learned" (the shipped policy) or a checkpoint of
    train/ppo.py."""
    distance: str | None = None
    """What the distances know: exact, noisy or none; None leaves it to the policy."""
    episodes: int = 1
    seed: int = 0
    noise: str = "paper"
    presentation: str = "auto"
    video: Path | None = None
    """Where to write an mp4 of the first episode."""
    search: int = 0
    """Generations of a grasp search on the object before it is grasped."""

    def __post_init__(self) -> None:
        if self.episodes < 1:
            raise InputError(f"episodes must be at least 1, got {self.episodes}")
        if not 0 <= self.seed <= SEED_LIMIT - self.episodes:
            raise InputError(f"seed must be from 0 to 2**32 - episodes, got {self.seed}")
        if self.search < 0:
            raise InputError(f"search must be 0 or more, got {self.search}")
        if self.topology is not None:
            resolve_topology(self.topology)


class Pipeline:
    """Sentence -> strategy -> rollout; parts load when they are first needed."""

    def select(self, text: str, object_override: str | None = None) -> Selection:
        """Understand a sentence and rank topologies; rejections come back as such.

        Args:
            text: what a person typed.
            object_override: a library object or mesh file that the hand shall take.

        Raises:
            InputError: the overriding object does not exist.
        """
        from maniskill_taskgrasp.language import Rejected, parse

        affordance = None if object_override is None else _affordance(object_override)
        answer = parse(text, object_override)
        if isinstance(answer, Rejected):
            return Selection(text=text, rejected=True, reason=answer.reason)
        if affordance is None:
            assert answer.object is not None  # Without one the front end rejects.
            affordance = _affordance(answer.object)
        return self._rank(answer, affordance)

    def _rank(self, answer: Instruction, affordance: Affordance) -> Selection:
        from maniskill_taskgrasp.selection import Selector, feasible

        strategy: GraspStrategy = Selector.load().rank(affordance, answer.action, answer.parameters)
        ranked = []
        for topology in strategy.ranked():
            able, why = feasible(topology, affordance)
            probability = strategy.probabilities[topology.index]
            ranked.append(RankedTopology(topology.name, round(probability, 4), able, why))
        return Selection(
            text=answer.text,
            action=answer.action,
            action_score=round(answer.action_score, 4),
            actions_top3=[{"name": n, "score": round(s, 4)} for n, s in answer.actions_top3],
            object=affordance.name,
            object_score=round(answer.object_score, 4),
            topologies=ranked,
            opposition={k: round(v, 4) for k, v in strategy.opposition.items()},
            pip={k: round(v, 4) for k, v in strategy.pip.items()},
            evidence=strategy.evidence,
            notes=list(answer.notes),
        )

    def grasp(self, text: str, options: GraspOptions) -> GraspResult:
        """Carry an instruction out in simulation.

        Raises:
            InputError: the sentence is rejected, or something it names does not exist.
        """
        start = time.perf_counter()
        selection = self.select(text, options.object)
        if selection.rejected:
            raise InputError(selection.reason or "the instruction was not understood")
        assert selection.object is not None
        topology = choose_topology(selection, options.topology)
        from maniskill_taskgrasp.tasks.rollout import roll_out

        make_policy, env_kwargs = policy_maker(options.policy, options.distance)
        source = options.object or selection.object
        found = _search(source, topology, options)
        rollout = roll_out(
            source,
            topology,
            grasp=found.grasp if found else None,
            make_policy=make_policy,
            episodes=options.episodes,
            seed=options.seed,
            noise=options.noise,
            presentation=options.presentation,
            video=options.video,
            env_kwargs=env_kwargs,
        )
        return GraspResult(
            instruction=text,
            action=selection.action,
            object=selection.object,
            strategy=selection.topologies[:TOP],
            topology=topology.name,
            presentation=rollout.presentation,
            episodes=options.episodes,
            successes=sum(name == "none" for name in rollout.failure),
            lift_m=rollout.lift_m,
            failure=rollout.failure,
            fidelity=rollout.fidelity,
            video=rollout.video,
            seconds=round(time.perf_counter() - start, 2),
            notes=selection.notes + rollout.notes + ([found.note] if found else []),
            search=found.summary() if found else None,
        )


def choose_topology(selection: Selection, wanted: str | None) -> Topology:
    """The topology asked for, else the most probable one that the hand can hold the object in.

    Raises:
        InputError: none of the 15 is feasible for the object.
    """
    if wanted is not None:
        return resolve_topology(wanted)
    for ranked in selection.topologies:
        if ranked.feasible:
            return resolve_topology(ranked.name)
    raise InputError(
        f"this hand can hold {echo(selection.object)} in none of the 15 topologies "
        f"({selection.topologies[0].why}); --topology NAME tries one all the same"
    )


def policy_maker(
    name: str, distance: str | None = None
) -> tuple[Callable[[Any], Any], dict[str, Any]]:
    """Maker of a policy for an environment, and the arguments the environment must have.

    Args:
        name: "constant", "follow", "guarded", "probing", "hover-rule", "learned", or a checkpoint.
        distance: what the distances shall know; None leaves it to the policy.

    Raises:
        InputError: there is no such policy.
    """
    given = {} if distance is None else {"distance": distance}
    from functools import partial

    from maniskill_taskgrasp.tasks.closing import (
        ConstantClosing,
        FollowRule,
        GuardedRule,
        HoverRule,
    )

    if name == "constant":
        return ConstantClosing, given
    from maniskill_taskgrasp.tasks.probing import ProbingRule

    rules = {
        "follow": FollowRule,
        "guarded": GuardedRule,
        "probing": ProbingRule,
        "hover-rule": HoverRule,
    }
    if name in rules:
        return rules[name], {"control_mode": "pd_synergy_wrist"} | given
    from maniskill_taskgrasp.train.policy import load_policy, policy_env_kwargs

    path = _shipped_policy(distance) if name == "learned" else Path(name)
    return partial(load_policy, path), policy_env_kwargs(path) | given


def _search(source: str, topology: Topology, options: GraspOptions) -> FoundGrasp | None:
    """The grasp found on the object itself, where a search is asked for."""
    if not options.search:
        return None
    from maniskill_taskgrasp.tasks.own_search import SearchBudget, find_grasp

    budget = SearchBudget.on_object(options.search, options.seed, options.noise)
    return find_grasp(source, topology, options.presentation, budget)


def _shipped_policy(distance: str | None) -> Path:
    """The policy that feels distances, or the one that has touch alone."""
    from importlib.resources import files

    name = "policy_touch.pt" if distance == "none" else "policy_distance.pt"
    return Path(str(files("maniskill_taskgrasp.assets").joinpath(f"checkpoints/{name}")))


def _affordance(name: str) -> Affordance:
    """Measurements of a library object, of one the data know, or of a mesh file."""
    from maniskill_taskgrasp.knowledge import load_knowledge

    known = load_knowledge().objects
    if name in known:
        return known[name]
    from maniskill_taskgrasp.assets.objects import library

    return library.load(name).affordance
