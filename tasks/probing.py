"""What touch alone can do about an object that is not where it should be: come down feeling."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.episode import CLOSE_START, HOVER, PHASE_ENDS
from maniskill_taskgrasp.tasks.closing import GuardedRule

RAISED = 0.02  # [m] above its path at which the palm waits until the descent has ended.
LANDED = 0.1  # [N] on a digit, at least `UPRIGHT` of it upward: it has come down on the object.
UPRIGHT = 0.6
FEELING = PHASE_ENDS[HOVER], CLOSE_START + 7  # First and last step of landings; then it is down.
RISE = 0.008  # [m] by which the palm rises from where a digit landed, while it
ASIDE = 0.018  # [m] steps aside, for
ASIDE_STEPS = 6  # control steps.
DOWN = 0.004  # [m] above the path at which the palm is down, and the hand may close,
LATEST_CLOSING = CLOSE_START + 20  # at the latest from this step on.
NEVER = 10_000  # Step of no landing.


class ProbingRule(GuardedRule):
    """`GuardedRule` that comes down slowly for the last 2 cm and steps aside where a digit lands.

    A thumb or a finger that comes down on top of the object says on which side the object is: the
    palm rises a little, moves so that the object comes between thumb and fingers, and comes down
    again. The hand stays open until then. All numbers were chosen on train objects
    (docs/planning.md). It feels forces' directions, and needs `pd_synergy_wrist`.
    """

    def __init__(self, env: Any, activation: float = 1.0) -> None:
        super().__init__(env, activation)
        num_envs, device = self._env.num_envs, self._env.device
        hand = self._env.agent.hand
        names = [link for part in PARTS for link in hand.part_links[part]]
        owners = [i for i, part in enumerate(PARTS) for _ in hand.part_links[part]]
        self._part_of_link = torch.tensor(owners, device=device)
        tips = [names.index(hand.tip_links[part]) for part in PARTS if part != "palm"]
        self._tips = torch.tensor(tips, device=device)
        digits = [part for part in PARTS if part != "palm"]
        self._digits = torch.tensor([PARTS.index(digit) for digit in digits], device=device)
        self._thumb = torch.tensor([digit == "thumb" for digit in digits], device=device)
        self._landed_at = torch.full((num_envs,), NEVER, device=device)
        self._aside = torch.zeros(num_envs, 2, device=device)
        self._height = torch.zeros(num_envs, device=device)

    def __call__(self, obs: Tensor) -> Tensor:
        arm = self._env.agent.controller.controllers["arm"]
        step = self._env.elapsed_steps.long()
        self._feel(step, arm.residual)
        action = super().__call__(obs)
        action[:, : self._num_palm] = arm.action_for(self._palm(step))
        coming_down = (arm.residual[:, 2] > DOWN) & (step < LATEST_CLOSING)
        action[:, self._num_palm :] *= ~coming_down[:, None]
        return action

    def _feel(self, step: Tensor, residual: Tensor) -> None:
        """Note where a digit has landed, once an episode."""
        self._landed_at[step == 0] = NEVER
        upward = self._landings()
        thumb, finger = (upward & self._thumb).any(1), (upward & ~self._thumb).any(1)
        feeling = (step >= FEELING[0]) & (step <= FEELING[1]) & (step < self._landed_at)
        new = feeling & (thumb ^ finger)
        tips = self._env.reading.link_frames[:, self._tips, :2, 3]
        towards = tips[:, ~self._thumb].mean(1) - tips[:, self._thumb].mean(1)
        towards = torch.nn.functional.normalize(towards, dim=1, eps=1e-3)
        way = torch.where(finger[:, None], towards, -towards) * ASIDE
        self._aside = torch.where(new[:, None], residual[:, :2] + way, self._aside)
        risen = (residual[:, 2] + RISE).clamp(max=RAISED)
        self._height = torch.where(new, risen, self._height)
        self._landed_at = torch.where(new, step, self._landed_at)

    def _landings(self) -> Tensor:
        """(num_envs, digits) bool: the object pushes it up."""
        reading = self._env.reading
        forces = (reading.link_frames[..., :3] @ reading.local_forces[..., None])[..., 0]
        total = forces.new_zeros(len(forces), len(PARTS), 3)
        total = total.index_add_(1, self._part_of_link, forces)[:, self._digits]
        force = torch.linalg.vector_norm(total, dim=-1)
        return (force >= LANDED) & (total[..., 2] > UPRIGHT * force)

    def _palm(self, step: Tensor) -> Tensor:
        """(num_envs, 4) [m, m, m, rad] where the palm shall be, off its path."""
        since = step - self._landed_at
        landed = since >= 0
        x, y, yaw = self._shift().unbind(1)
        place = torch.where(landed[:, None], self._aside, torch.stack([x, y], 1))
        raised = torch.where(step < CLOSE_START, RAISED, 0.0)
        height = torch.where(landed, torch.where(since < ASIDE_STEPS, self._height, 0.0), raised)
        return torch.cat([place, height[:, None], torch.where(landed, 0.0, yaw)[:, None]], 1)
