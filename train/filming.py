"""What a policy looks like: one deterministic episode as a video, and its trajectory if asked."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from torch import Tensor

from maniskill_taskgrasp.train import environments
from maniskill_taskgrasp.train.policy_eval import run_episodes
from maniskill_taskgrasp.train.ppo_config import PPOConfig

VIDEO_FPS = 20  # ManiSkill's control rate, so that videos run in real time.


def film_episode(
    config: PPOConfig,
    device: str,
    folder: Path,
    name: str,
    policy: Callable[[Tensor], Tensor],
    *,
    trajectory: bool,
) -> Path | None:
    """Film the first evaluation episode into `folder`/`name`.mp4.

    Args:
        policy: (1, obs_dim) raw observations -> (1, action_dim) task actions.
        trajectory: also write ManiSkill's trajectory files `name`.h5 and .json.

    Returns:
        The video; None where rendering is impossible.
    """
    from mani_skill.utils.wrappers.record import RecordEpisode
    from mani_skill.vector.wrappers.gymnasium import ManiSkillVectorEnv

    from maniskill_taskgrasp.tasks.rendering import rendering_available

    if not rendering_available():
        return None
    recorder = RecordEpisode(
        environments.make_env(config, 1, device, render_mode="rgb_array"),
        str(folder),
        save_trajectory=trajectory,
        trajectory_name=name,
        video_fps=VIDEO_FPS,
    )
    envs = ManiSkillVectorEnv(
        recorder,
        auto_reset=False,
        ignore_terminations=not config.eval_partial_reset,
        record_metrics=True,
    )
    seeds = environments.derived_seeds(config.seed, environments.EVALUATION, 0, 0, 1)
    run_episodes(envs, policy, seeds, reconfigure=True, step_limit=config.num_eval_steps)
    recorder.flush_video(name=name)
    recorder.close()
    return folder / f"{name}.mp4"
