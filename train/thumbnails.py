"""Pictures of example episodes: run again alone, before a camera."""

from __future__ import annotations

import io
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from numpy.typing import NDArray

import maniskill_taskgrasp  # noqa: F401  (Registers the task.)
from maniskill_taskgrasp.episode import LIFT_START, MAX_EPISODE_STEPS, PHASE_ENDS
from maniskill_taskgrasp.tasks.outcome import FAILURES
from maniskill_taskgrasp.train.cells import Json

SHOWN_STEPS = (LIFT_START, (LIFT_START + PHASE_ENDS[-2]) // 2, MAX_EPISODE_STEPS)
"""Closed, half-way up, and the end."""
CROP = (0.1, 0.9), (0.2, 0.8)  # Rows and columns of the camera's picture around the hand.
HEIGHT = 280  # [pixel]


def photograph(cell: Json, config: Json, seed: int) -> tuple[bytes, str]:
    """Strip of pictures of one episode, and how it ended before the camera.

    Args:
        cell: a measured cell of results.json.
        config: the evaluation's.
        seed: of the episode.
    """
    from maniskill_taskgrasp.pipeline import policy_maker

    make_policy, env_kwargs = policy_maker(config["policy"], config["distance"])
    env: Any = gym.make(
        "TaskGrasp-v0",
        objects=[cell["source"]],
        topology=cell["topology"],
        noise=config["noise"],
        presentation=config["presentation"],
        render_mode="rgb_array",
        reward_mode="none",
        **env_kwargs,
    )
    try:
        frames, outcome = _film(env, make_policy, seed, _grasp_options(cell))
    finally:
        env.close()
    return _strip(frames), outcome


@torch.no_grad()
def _film(
    env: Any, make_policy: Any, seed: int, options: dict[str, Any]
) -> tuple[list[NDArray[np.uint8]], str]:
    obs, info = env.reset(seed=seed, options={"reconfigure": True, **options})
    policy = make_policy(env)
    frames = []
    for step in range(1, MAX_EPISODE_STEPS + 1):
        obs, _, _, _, info = env.step(policy(obs))
        if step in SHOWN_STEPS:
            frames.append(env.render()[0].cpu().numpy())
    name = FAILURES[int(info["failure"][0])]
    form = "in form" if bool(info["fidelity"][0]) else "not in form"
    return frames, f"lifted, {form}" if name == "none" else name.replace("_", " ")


def _grasp_options(cell: Json) -> dict[str, Any]:
    """The grasp that was searched for the cell, if there was a search."""
    if not cell.get("search"):
        return {}
    grasp = cell["search"]["grasp"]
    shapes = tuple(torch.tensor([grasp[name]]) for name in ("preshape", "closing"))
    return {"pregrasp": torch.tensor([grasp["pregrasp"]]), "postures": shapes}


def _strip(frames: list[NDArray[np.uint8]]) -> bytes:
    from PIL import Image

    height, width, _ = frames[0].shape
    (top, bottom), (left, right) = CROP
    rows = slice(round(top * height), round(bottom * height))
    columns = slice(round(left * width), round(right * width))
    joined = np.concatenate([frame[rows, columns] for frame in frames], axis=1)
    scale = HEIGHT / joined.shape[0]
    picture = Image.fromarray(joined).resize((round(scale * joined.shape[1]), HEIGHT))
    buffer = io.BytesIO()
    picture.save(buffer, "PNG", optimize=True)
    return buffer.getvalue()
