"""The plan of each environment's episode: pregrasp, posture and arm path, kept between episodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, is_dataclass
from typing import Any

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.tasks.arm_ik import ArmIK
from maniskill_taskgrasp.tasks.offset import HoverSense, OffsetModel
from maniskill_taskgrasp.tasks.placement import Placement
from maniskill_taskgrasp.tasks.planner import PregraspPlanner
from maniskill_taskgrasp.tasks.pregrasp import palm_path
from maniskill_taskgrasp.topology import Topology


@dataclass(frozen=True)
class Plans:
    """Plans of n environments."""

    pregrasp: Tensor
    """(n, 6) `pregrasp.PREGRASP_FIELDS`."""
    preshape: Tensor
    """(n, num_actuators) [rad] hand posture at activation 0."""
    closing: Tensor
    """(n, num_actuators) [rad] hand posture at activation 1."""
    path: Tensor
    """(n, MAX_EPISODE_STEPS, num_arm) [rad] arm waypoints, one a control step."""
    reachable: Tensor
    """(n,) bool: the arm can follow the path."""
    hover: OffsetModel
    """What distances at hover tell of the object's offset."""

    def rows(self, index: Any) -> Plans:
        """Plans of some of the environments."""
        return _mapped(lambda field: field[index], [self])


def joined(plans: Sequence[Plans]) -> Plans:
    """Plans one after the other."""
    return _mapped(lambda *fields: torch.cat(fields), plans)


def _mapped(change: Callable[..., Tensor], batches: Sequence[Any]) -> Any:
    """A dataclass of tensors, nested or not, made field by field from those of some others."""
    fields = [vars(batch).values() for batch in batches]
    values = (
        _mapped(change, row) if is_dataclass(row[0]) else change(*row)
        for row in zip(*fields, strict=True)
    )
    return type(batches[0])(*values)


class PlanBook:
    """Plans from nominal data. Noise is drawn afterwards, so a plan serves all episodes."""

    def __init__(
        self,
        planner: PregraspPlanner,
        ik: ArmIK,
        device: torch.device,
        sense: HoverSense | None = None,
    ) -> None:
        """
        Args:
            sense: makes the offset models; without it plans are blind to offsets.
        """
        self._planner = planner
        self._ik = ik
        self._device = device
        self._sense = sense
        self._kept: dict[tuple[str, int], Plans] = {}

    def plans(
        self, env_idx: Tensor, topologies: list[Topology], placements: list[Placement]
    ) -> Plans:
        """Plans of environments (n,), each with its topology; placements are of all environments.

        Those that are not known yet are made together, in one batch.
        """
        keys = [(t.slug, int(env)) for env, t in zip(env_idx, topologies, strict=True)]
        missing = [key for key in keys if key not in self._kept]
        if missing:
            grasps = [self._planner.plan(slug, placements[env]) for slug, env in missing]
            rows = [torch.tensor(row, device=self._device) for row in zip(*grasps, strict=True)]
            made = self.custom([placements[env] for _, env in missing], *rows)
            for i, key in enumerate(missing):
                self._kept[key] = made.rows(slice(i, i + 1))
        return joined([self._kept[key] for key in keys])

    def custom(
        self, placements: list[Placement], pregrasp: Tensor, preshape: Tensor, closing: Tensor
    ) -> Plans:
        """Plans from given numbers, one row for each placement."""
        centre = torch.tensor([p.centre.tolist() for p in placements], device=self._device)
        pregrasp, preshape = pregrasp.to(self._device), preshape.to(self._device)
        path, reachable = self._ik.path(palm_path(pregrasp, centre))
        if self._sense is None:
            hover = OffsetModel.blind(len(placements), len(PARTS), self._device)
        else:
            hover = self._sense(path, preshape, placements)
        return Plans(pregrasp, preshape, closing.to(self._device), path, reachable, hover)
