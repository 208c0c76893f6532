"""What the task's arguments may be, and what they stand for."""

from __future__ import annotations

from collections.abc import Sequence

from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.errors import InputError, echo
from maniskill_taskgrasp.topology import TOPOLOGIES, Topology, resolve_topology

DISTANCES = ("exact", "noisy", "none")
OBSERVATIONS = ("full", "paper")
GROUPS = ("train", "test", "all")


def one_of(name: str, value: str, allowed: Sequence[str]) -> str:
    """The value, if it is allowed.

    Raises:
        InputError: it is not.
    """
    if value not in allowed:
        raise InputError(f"{name} must be one of {', '.join(allowed)}, got {echo(value)}")
    return value


def resolve_topologies(topology: str | Sequence[str], control_mode: str | None) -> list[Topology]:
    """Topologies of the environments, from a name, several or "all".

    Raises:
        InputError: no name, an unknown one, or one that a `pd_synergy_<slug>` contradicts.
    """
    if isinstance(topology, str):
        topology = [t.name for t in TOPOLOGIES] if topology == "all" else [topology]
    topologies = [resolve_topology(name) for name in topology]
    if not topologies:
        raise InputError("topology must name at least one topology, got an empty list")
    own = [t for t in TOPOLOGIES if control_mode == f"pd_synergy_{t.slug}"]
    if own and topologies != own:
        names = ", ".join(t.name for t in topologies)
        raise InputError(f"control mode {control_mode!r} closes {own[0].name!r}, not {names!r}")
    return topologies


def resolve_objects(objects: str | Sequence[str]) -> list[str]:
    """Object names or mesh files, from one or several, a split ("train", "test") or "all".

    Raises:
        InputError: an empty list.
    """
    asked = [objects] if isinstance(objects, str) else list(objects)
    if not asked:
        raise InputError("objects must name at least one object, got an empty list")
    named = lambda name: library.names(name) if name in GROUPS else (name,)  # noqa: E731
    return [resolved for name in asked for resolved in named(name)]
