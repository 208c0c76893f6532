"""What became of a grasp: running statistics of an episode, and its failure class."""

from __future__ import annotations

from functools import cache

import torch
from torch import Tensor

from maniskill_taskgrasp.episode import HELD_STEPS, LIFT_START, MAX_EPISODE_STEPS
from maniskill_taskgrasp.tasks.rewards import CONTACT_FORCE

FAILURES = (
    "none",
    "no_contact",
    "not_lifted",
    "slipped",
    "dropped",
    "unstable",
    "unreachable",
)
LIFT_HEIGHT = 0.20  # [m] rise of the object that counts as lifted (paper, section III).
OFF_TABLE = 0.03  # [m] rise at which the object has left its support.
WILD_SPEED = 10.0  # [m/s] no object on a table moves so fast: the physics blew up.
MEMORY = 0.8  # Weight of the past in the running mean of forces; 10 steps leave 11 % of it.


class Outcome:
    """Per-environment record of the running episode; every field is (num_envs, ...)."""

    def __init__(self, num_envs: int, num_links: int, device: torch.device) -> None:
        self.touched = torch.zeros(num_envs, dtype=torch.bool, device=device)
        self.max_lift = torch.zeros(num_envs, device=device)
        self.held_steps = torch.zeros(num_envs, dtype=torch.long, device=device)
        self.was_up = torch.zeros(num_envs, dtype=torch.bool, device=device)
        self.wild = torch.zeros(num_envs, dtype=torch.bool, device=device)
        self.reachable = torch.ones(num_envs, dtype=torch.bool, device=device)
        self.mean_forces = torch.zeros(num_envs, num_links, 3, device=device)

    def reset(self, env_idx: Tensor, reachable: Tensor) -> None:
        """Start new episodes; reachable (n,) bool says whether the arm can follow the plan."""
        for field in (self.touched, self.max_lift, self.held_steps, self.was_up, self.wild):
            field[env_idx] = 0
        self.mean_forces[env_idx] = 0
        self.reachable[env_idx] = reachable

    def record(self, lift: Tensor, link_forces: Tensor, touch: Tensor, speed: Tensor) -> None:
        """Take in one control step.

        Args:
            lift: (num_envs,) [m] rise of the object.
            link_forces: (num_envs, num_links, 3) [N] in link frames.
            touch: (num_envs, num_links) [N] their sizes.
            speed: (num_envs,) [m/s] of the object.
        """
        pressing = (touch >= CONTACT_FORCE).any(1)
        up = (lift >= LIFT_HEIGHT) & pressing
        self.touched |= pressing
        self.max_lift = torch.maximum(self.max_lift, lift)
        self.held_steps = torch.where(up, self.held_steps + 1, 0)
        self.was_up |= up
        self.wild |= ~(speed < WILD_SPEED)  # Also catches NaN.
        self.mean_forces = MEMORY * self.mean_forces + (1 - MEMORY) * link_forces

    @property
    def success(self) -> Tensor:
        """(num_envs,) bool: 0.2 m up and held by the hand alone for the last 0.5 s."""
        return (self.held_steps >= HELD_STEPS) & ~self.wild

    def failure(self, step: Tensor, lift: Tensor) -> Tensor:
        """(num_envs,) long into `FAILURES`; 0 while nothing is lost yet.

        Args:
            step: (num_envs,) control steps taken.
            lift: (num_envs,) [m] rise of the object now.
        """
        tried = step > LIFT_START
        over = step >= MAX_EPISODE_STEPS
        lifted = self.max_lift >= OFF_TABLE
        lost = over | (tried & (lift < 0.5 * self.max_lift))
        happened = {  # Later ones explain more.
            "slipped": lifted & lost,
            "dropped": self.was_up & lost,
            "not_lifted": over & ~lifted,
            "no_contact": tried & ~self.touched,
            "unstable": self.wild,
            "unreachable": over & ~self.reachable,
            "none": self.success,
        }
        ranks, codes = _explanations(tuple(happened), step.device)
        return codes[(torch.stack(list(happened.values())) * ranks).amax(0)]


@cache
def _explanations(names: tuple[str, ...], device: torch.device) -> tuple[Tensor, Tensor]:
    """(n, 1) ranks from 1 on, and (n + 1,) places in `FAILURES` by rank, 0 for none of them."""
    ranks = torch.arange(1, len(names) + 1, device=device)[:, None]
    return ranks, torch.tensor([0, *map(FAILURES.index, names)], device=device)
