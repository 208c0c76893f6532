"""What an evaluation measures: pairs, noise, policy, search budget and number of episodes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from maniskill_taskgrasp.errors import InputError, unknown_name
from maniskill_taskgrasp.topology import resolve_topology

TABLES = ("paper", "feasible")
MAX_ENVS = 1024


@dataclass(frozen=True, kw_only=True)
class EvaluateConfig:
    """Measure how often grasps lift, and lift in the named topology; with intervals."""

    topologies: tuple[str, ...] = ()
    """Topologies to use on every object, or "all"; left out, the selector chooses one for each
    object (action "picking up")."""
    objects: tuple[str, ...] = ()
    """Library names, mesh files, train, test, all or imported; left out, the test objects."""
    mesh_dir: Path | None = None
    """Folder of meshes that are the objects."""
    table: str | None = None
    """A committed list of pairs: "paper" is Table I, "feasible" all compatible pairs
    (assets/evaluation_pairs.json)."""
    instructions: Path | None = None
    """File of sentences, one a line (or JSON lines with "text" and "objects", those meant): each
    is understood and carried out."""
    limit: int | None = None
    """Only so many of the pairs or sentences, evenly from the whole list."""
    episodes: int = 100
    """Episodes for each pair."""
    noise: str = "paper"
    """How far the object is from where the planner thinks: none, paper, hard or blind."""
    presentation: str = "auto"
    """How the object is offered: auto, table, stand, rail, rack or holder."""
    policy: str = "constant"
    """"constant" closes all the way; with "follow" the palm also follows the object by what is
    sensed; "guarded" also waits with what touches first; "probing" also comes down feeling, for
    touch alone; "learned" is the shipped policy; or a checkpoint file."""
    distance: str | None = None
    """What the distances know: exact, noisy or none; left out, as the policy was trained."""
    search: int = 0
    """Generations of a grasp search on each evaluated object; 0 uses the stored grasps alone."""
    seed: int = 0
    """Episodes of a pair have the same seeds whatever the policy."""
    num_envs: int = 64
    """Episodes that run at once."""
    out: Path | None = None
    """Folder for results.json (resumed if it is there), report.html and pictures."""

    def __post_init__(self) -> None:
        for name, least in (("episodes", 1), ("search", 0), ("seed", 0), ("num_envs", 1)):
            if getattr(self, name) < least:
                value = getattr(self, name)
                raise InputError(f"--{name.replace('_', '-')} must be {least} or more, got {value}")
        if self.limit is not None and self.limit < 1:
            raise InputError(f"--limit must be 1 or more, got {self.limit}")
        if self.num_envs > MAX_ENVS:
            raise InputError(f"--num-envs must be at most {MAX_ENVS}, got {self.num_envs}")
        if self.table is not None and self.table not in TABLES:
            raise unknown_name("table", self.table, TABLES)
        given = [flag for flag, value in self._sources().items() if value]
        if len(given) > 1:
            raise InputError(f"{' and '.join(given)} each say what to grasp: give one of them")
        if self.topologies and (self.table or self.instructions):
            raise InputError("--topologies does not go with --table or --instructions")
        for name in self.topologies:
            if name != "all":
                resolve_topology(name)

    def _sources(self) -> dict[str, object]:
        return {
            "--objects": self.objects,
            "--mesh-dir": self.mesh_dir,
            "--table": self.table,
            "--instructions": self.instructions,
        }
