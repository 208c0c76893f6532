"""Episodes of one object in one topology: what happened, and a film of the first."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium as gym
import torch
from torch import Tensor

from maniskill_taskgrasp.episode import CONTROL_FREQ
from maniskill_taskgrasp.tasks.closing import ConstantClosing
from maniskill_taskgrasp.tasks.grasp_library import Grasp
from maniskill_taskgrasp.tasks.outcome import FAILURES
from maniskill_taskgrasp.tasks.rendering import rendering_available
from maniskill_taskgrasp.topology import Topology


@dataclass(frozen=True)
class Rollout:
    """Results of some episodes; lists have one entry an episode."""

    presentation: str
    lift_m: list[float]
    failure: list[str]
    fidelity: list[bool]
    video: str | None
    notes: list[str]


def roll_out(
    obj: str,
    topology: Topology,
    *,
    make_policy: Callable[[Any], Callable[[Tensor], Tensor]] = ConstantClosing,
    grasp: Grasp | None = None,
    episodes: int = 1,
    seed: int = 0,
    noise: str = "paper",
    presentation: str = "auto",
    video: Path | None = None,
    env_kwargs: dict[str, Any] | None = None,
) -> Rollout:
    """Run episodes one after the other.

    Args:
        obj: library name or mesh file.
        topology: how to grasp it.
        make_policy: environment -> (observation -> action).
        grasp: palm pose and postures to use in place of the planner's.
        video: mp4 to write of the first episode.
        env_kwargs: further arguments of the environment, such as the policy's control mode.

    Raises:
        InputError: unknown object, noise or presentation.
    """
    notes = []
    options = {"reconfigure": True} | ({} if grasp is None else reset_options([grasp]))
    if video is not None and not rendering_available():
        notes.append("no video: no Vulkan device was found (see README, Rendering)")
        video = None
    env: Any = gym.make(
        "TaskGrasp-v0",
        objects=[obj],
        topology=topology.name,
        noise=noise,
        presentation=presentation,
        render_mode="rgb_array" if video is not None else None,
        **(env_kwargs or {}),
    )
    try:
        policy = make_policy(env)
        shown = env.unwrapped.placements[0].presentation
        outcomes = [
            _episode(env, policy, seed + i, options, None if i else video) for i in range(episodes)
        ]
    finally:
        env.close()
    lifts, failures, forms = (list(column) for column in zip(*outcomes, strict=True))
    film = None if video is None else str(video)
    return Rollout(f"{shown.kind}: {shown.reason}", lifts, failures, forms, film, notes)


def reset_options(grasps: Sequence[Grasp]) -> dict[str, Any]:
    """What the environment's reset takes for given grasps, one for each environment."""
    rows = {
        name: torch.tensor([getattr(grasp, name) for grasp in grasps])
        for name in ("pregrasp", "preshape", "closing")
    }
    return {"pregrasp": rows["pregrasp"], "postures": (rows["preshape"], rows["closing"])}


def _episode(
    env: Any,
    policy: Callable[[Tensor], Tensor],
    seed: int,
    options: dict[str, Any],
    video: Path | None,
) -> tuple[float, str, bool]:
    """One episode to its end, and on camera to the end of the clock."""
    frames: list[Any] = []
    obs, info = env.reset(seed=seed, options=options)
    over = False
    while not over:
        obs, _, terminated, truncated, info = env.step(policy(obs))
        if video is not None:
            frames.append(env.render()[0].cpu().numpy())
        over = bool(torch.logical_or(terminated, truncated))
    if video is not None:
        write_video(video, frames)
    lift = float(env.unwrapped.outcome.max_lift[0])
    return round(lift, 4), FAILURES[int(info["failure"][0])], bool(info["fidelity"][0])


def write_video(path: Path, frames: Sequence[Any]) -> None:
    """Write frames (h, w, 3) uint8 as an mp4 that plays in real time, whole or not at all."""
    import imageio

    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.partial.mp4")
    imageio.mimwrite(partial, list(frames), fps=CONTROL_FREQ, quality=8, macro_block_size=8)
    partial.replace(path)
