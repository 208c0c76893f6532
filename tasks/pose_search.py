"""Searches palm pose and posture for one object in batched physics, scoring lift and form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from numpy.typing import NDArray

from maniskill_taskgrasp.agents.fidelity import ContactSurfaces
from maniskill_taskgrasp.agents.hand import PARTS, HandDescription
from maniskill_taskgrasp.episode import LIFT_START, MAX_EPISODE_STEPS
from maniskill_taskgrasp.tasks.closing import ConstantClosing
from maniskill_taskgrasp.topology import Topology

Array = NDArray[np.float64]

EARLY_STEPS = LIFT_START + 14  # Early generations stop here: a lost object is lost by then.
OFF_GROUND = 0.05  # [m] rise that earns the score of a lift-off.
EARLY_LIFT = 0.06  # [m] rise that a held object has reached by then.
CENTRE_SHIFT = 0.03  # [m] sideways push while closing that costs a full point of the score.

# Numbers that are searched: six of the pregrasp, then eight of the posture.
PREGRASP_LOWER = (-0.09, -0.01, -0.05, -0.35, -1.75, -1.75)
PREGRASP_UPPER = (0.05, 0.13, 0.11, 0.80, 1.75, 1.75)
PREGRASP_SPREAD = (0.018, 0.022, 0.022, 0.28, 0.25, 0.12)
PREGRASP_FLOOR = (0.0015, 0.0015, 0.0015, 0.02, 0.02, 0.02)
POSTURE_SPREAD = (0.12, 0.20, 0.08, 0.25, 0.15, 0.25, 0.25, 0.35)
POSTURE_FLOOR = (0.01,) * 8
THUMB_ABDUCTED, THUMB_ADDUCTED = 1.12, 1.07  # [rad] bounds of the thumb's rotation (fidelity).
PINCH_THUMB_FLEX = 0.95  # [rad] beyond it pinch types trap objects on the thumb's back.
STRAIGHT_PIP = 0.45  # [rad] most bend of the fingers in a parallel extension.


@dataclass(frozen=True)
class PostureSpace:
    """Eight numbers that stand for a posture pair of one topology.

    Thumb rotation open and closed, thumb flexion open and closed, then the mean knuckle and middle
    joint of the moving fingers, open and closed; fingers keep their differences.
    """

    preshape: Array
    closing: Array
    lower: Array
    upper: Array
    rotates: bool
    """Whether the thumb's rotation is part of the closing."""

    @classmethod
    def of(cls, hand: HandDescription, topology: Topology) -> PostureSpace:
        """Bounds that keep the posture within the topology's name."""
        posture = hand.postures[topology.slug]
        lower = np.array([0.85, 0.85, 0.34, 0.34, 0.17, 0.17, 0.50, 0.17])
        upper = np.array([1.90, 1.90, 0.70, 1.50, 1.10, 1.40, 1.57, 1.57])
        if topology.opposition == "Pad":
            upper[3] = PINCH_THUMB_FLEX
            lower[:2] = THUMB_ABDUCTED
            if not topology.thumb_abducted:
                upper[[5, 7]] = STRAIGHT_PIP
        elif topology.opposition == "Palm":
            if topology.thumb_abducted:
                lower[:2] = THUMB_ABDUCTED
            else:
                upper[:2] = THUMB_ADDUCTED
        return cls(
            preshape=np.array(posture.preshape),
            closing=np.array(posture.closing),
            lower=lower,
            upper=upper,
            rotates=bool(posture.moving[0]),
        )

    @property
    def _moving(self) -> list[int]:
        """First joint's place of each finger that closes."""
        return [i for i in range(2, len(self.preshape), 2) if self.preshape[i] != self.closing[i]]

    def start(self) -> Array:
        """(8,) the hand's own posture."""
        return self.compress(self.preshape, self.closing)

    def compress(self, preshape: Array, closing: Array) -> Array:
        """(8,) numbers of a posture pair, each (num_actuators,) [rad]."""
        fingers = [
            float(np.mean([side[i + joint] for i in self._moving])) if self._moving else 0.5
            for side in (preshape, closing)
            for joint in (0, 1)
        ]
        thumb = [preshape[0], closing[0], preshape[1], closing[1]]
        return np.clip([*thumb, *fingers], self.lower, self.upper)

    def expand(self, numbers: Array) -> tuple[Array, Array]:
        """Preshapes and closings, each (n, num_actuators) [rad], of numbers (n, 8)."""
        n = len(numbers)
        preshape, closing = np.tile(self.preshape, (n, 1)), np.tile(self.closing, (n, 1))
        preshape[:, 0] = numbers[:, 0]
        closing[:, 0] = numbers[:, 1] if self.rotates else numbers[:, 0]
        preshape[:, 1] = numbers[:, 2]
        thumb_moves = self.preshape[1] != self.closing[1]
        closing[:, 1] = numbers[:, 3].clip(min=numbers[:, 2]) if thumb_moves else numbers[:, 2]
        centre = self.start()[4:]
        for i in self._moving:
            for joint in (0, 1):
                at = i + joint
                preshape[:, at] += numbers[:, 4 + joint] - centre[joint]
                closing[:, at] += numbers[:, 6 + joint] - centre[2 + joint]
        preshape[:, 2:] = preshape[:, 2:].clip(0.17, 1.57)
        closing[:, 2:] = closing[:, 2:].clip(0.17, 1.57)
        return preshape, closing


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
    ) -> None:
        """
        Args:
            processes: that share the physics; 0 chooses.

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
            obs="paper",
            sim_config={"scene_config": {"cpu_workers": processes}},
        ).unwrapped
        self.num_envs = num_envs
        self._policy = ConstantClosing(self.env)
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
