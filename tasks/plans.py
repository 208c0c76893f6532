"""The plan of each environment's episode: pregrasp, posture and arm path, kept between episodes."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from maniskill_taskgrasp.tasks.arm_ik import ArmIK
from maniskill_taskgrasp.tasks.placement import Placement
from maniskill_taskgrasp.tasks.planner import CANDIDATES, PregraspPlanner
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


class PlanBook:
    """Plans from nominal data. Noise is drawn afterwards, so a plan serves all episodes."""

    def __init__(self, planner: PregraspPlanner, ik: ArmIK, device: torch.device) -> None:
        self._candidates = planner.candidates
        self._ik = ik
        self._device = device
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
            grasps = [g for slug, env in missing for g in self._candidates(slug, placements[env])]
            rows = [torch.tensor(row, device=self._device) for row in zip(*grasps, strict=True)]
            owners = [placements[env] for _, env in missing for _ in range(CANDIDATES)]
            made = self.custom(owners, *rows)
            # argmax: the first that the arm can reach, or the first of all.
            best = made.reachable.view(-1, CANDIDATES).int().argmax(1).tolist()
            for i, key in enumerate(missing):
                row = i * CANDIDATES + best[i]
                self._kept[key] = Plans(*(field[row : row + 1] for field in vars(made).values()))
        found = [vars(self._kept[key]) for key in keys]
        return Plans(*(torch.cat([f[name] for f in found]) for name in found[0]))

    def custom(
        self, placements: list[Placement], pregrasp: Tensor, preshape: Tensor, closing: Tensor
    ) -> Plans:
        """Plans from given numbers, one row for each placement."""
        centre = torch.tensor([p.centre.tolist() for p in placements], device=self._device)
        pregrasp = pregrasp.to(self._device)
        path, reachable = self._ik.path(palm_path(pregrasp, centre))
        shapes = preshape.to(self._device), closing.to(self._device)
        return Plans(pregrasp, *shapes, path, reachable)
