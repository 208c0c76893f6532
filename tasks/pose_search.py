"""Searches palm pose and posture for one object in batched physics, scoring lift and form."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import torch
from numpy.typing import NDArray

from maniskill_taskgrasp.agents.fidelity import ContactSurfaces
from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.episode import LIFT_START, MAX_EPISODE_STEPS
from maniskill_taskgrasp.tasks.closing import ConstantClosing, FollowRule
from maniskill_taskgrasp.topology import Topology

Array = NDArray[np.float64]

EARLY_STEPS = LIFT_START + 14  # Early generations stop here: a lost object is lost by then.
OFF_GROUND = 0.05  # [m] rise that earns the score of a lift-off.
EARLY_LIFT = 0.06  # [m] rise that a held object has reached by then.
CENTRE_SHIFT = 0.03  # [m] sideways push while closing that costs a full point of the score.


class GraspTrials:
    """Trials of candidate grasps on one object, many at once."""

    def __init__(
        self,
        obj: str,
        topology: Topology,
        presentation: str,
        noise: str,
        num_envs: int,
        processes: int = 0,
        follow: bool = False,
        distance: str = "exact",
    ) -> None:
        """
        Args:
            processes: that share the physics; 0 chooses.
            follow: the palm follows the object by its distances, else it stays on its path.
            distance: what the distances know, one of `arguments.DISTANCES`.

        Raises:
            InputError: unknown object, presentation or noise.
        """
        self.env: Any = gym.make(
            "TaskGrasp-v0",
            num_envs=num_envs,
            objects=[obj],
            topology=topology.name,
            presentation=presentation,
            noise=noise,
            reward_mode="none",
            obs="full" if follow else "paper",
            control_mode="pd_synergy_wrist" if follow else "pd_synergy",
            distance=distance,
            sim_config={"scene_config": {"cpu_workers": processes}},
        ).unwrapped
        self.num_envs = num_envs
        self._policy = (FollowRule if follow else ConstantClosing)(self.env)
        self._named = torch.tensor([p in topology.parts for p in PARTS])
        self._precise = topology.pip == "Precision" and topology.opposition == "Pad"
        env: Any = self.env
        hand = env.agent.hand
        links = [link for part in PARTS for link in hand.part_links[part]]
        self._surfaces = ContactSurfaces(hand, links, env.device)

    def run(
        self, pregrasp: Array, preshape: Array, closing: Array, seed: int, *, whole: bool
    ) -> tuple[Array, Array, Array]:
        """Try one candidate in each environment.

        Args:
            pregrasp: (num_envs, 6).
            preshape: (num_envs, num_actuators) [rad].
            closing: (num_envs, num_actuators) [rad].
            seed: of the noise.
            whole: run to the end of the clock, else only until losses show.

        Returns:
            lifted, lifted in the named topology, and a score that guides the search; (num_envs,).
        """
        env = self.env
        tensor = lambda rows: torch.tensor(rows, dtype=torch.float32)  # noqa: E731
        options = {
            "pregrasp": tensor(pregrasp),
            "postures": (tensor(preshape), tensor(closing)),
        }
        obs, _ = env.reset(seed=seed, options=options)
        info: dict[str, Any] = {}
        for step in range(MAX_EPISODE_STEPS if whole else EARLY_STEPS):
            obs, _, _, _, info = env.step(self._policy(obs))
            if step == LIFT_START - 1:
                closed = self._closed_score(info)
        lift = env.outcome.max_lift.cpu()
        reach = env.outcome.reachable.cpu().numpy()
        lifted = info["success"].cpu() if whole else info["lift"].cpu() >= EARLY_LIFT
        form = lifted & info["fidelity"].cpu()
        rise = (lift / OFF_GROUND).clamp(0, 1)
        guide = 2.0 * form + lifted.float() + rise * (1 + self._likeness()) + closed
        score = np.where(reach, guide.numpy(), -1.0)
        return lifted.numpy() & reach, form.numpy() & reach, score

    def _closed_score(self, info: dict[str, Any]) -> torch.Tensor:
        """What the closed hand promises: form, named parts that touch, object not pushed away."""
        env = self.env
        touching = (info["part_forces"].cpu() >= 0.05) & self._named
        contact = touching.sum(1) / self._named.sum()
        pushed = (env.obj.pose.p - env.nominal_pose[:, :3])[:, :2].norm(dim=1).cpu()
        promise = 0.4 * info["fidelity"].cpu() + 0.4 * contact
        return promise - 0.2 * (pushed / CENTRE_SHIFT).clamp(max=1)

    def _likeness(self) -> torch.Tensor:
        """(num_envs,) in [0, 1]: how near the contacts are to the named topology.

        Share of all force that the named parts carry on the right surface, times the share of
        named parts that touch; unlike the yes or no of the form, a search can climb it.
        """
        shares = self._surfaces.shares(self.env.outcome.mean_forces)
        right = torch.minimum(shares.good, shares.distal) if self._precise else shares.good
        right = torch.where(self._named, right, 0.0).cpu().sum(1)
        touching = ((shares.force.cpu() >= 0.05) & self._named).sum(1) / self._named.sum()
        return touching * right / shares.force.cpu().sum(1).clamp(min=1e-6)

    def close(self) -> None:
        """Free the simulation."""
        self.env.close()
