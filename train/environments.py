"""Which environments a configuration trains, evaluates and films in, and with what arguments."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

from maniskill_taskgrasp.errors import InputError, echo, unknown_name
from maniskill_taskgrasp.train.policy import INTERFACE_FLAGS
from maniskill_taskgrasp.train.ppo_config import PPOConfig, is_task_grasp
from maniskill_taskgrasp.train.rollout import VectorEnv
from maniskill_taskgrasp.train.training_pairs import training_pairs

TASK_FLAGS = (*INTERFACE_FLAGS, "topology", "objects", "presentation", "noise", "reward_mode")
SEED_LIMIT = 2**31
SIM_BACKENDS = ("auto", "physx_cpu", "physx_cpu_batched", "physx_cuda")
TRAINING, EVALUATION = 0, 1  # Streams of seeds that never meet.


def derived_seeds(config_seed: int, stream: int, rank: int, index: int, count: int) -> list[int]:
    """Seeds of `count` environments, different for every stream, process and index."""
    sequence = np.random.SeedSequence((config_seed % SEED_LIMIT, stream, rank, index))
    return [int(word) for word in sequence.generate_state(count) % SEED_LIMIT]


def task_kwargs(config: PPOConfig, flags: tuple[str, ...] = TASK_FLAGS) -> dict[str, Any]:
    """Arguments of gym.make that the user gave; what was not given stays the task's business."""
    given = {name: getattr(config, name) for name in flags}
    kwargs = {name: value for name, value in given.items() if value is not None}
    for name in ("topology", "objects"):
        if name in kwargs:
            values = kwargs[name]
            kwargs[name] = values[0] if len(values) == 1 else list(values)
    return kwargs


def _sim_backend(config: PPOConfig, device: str) -> str:
    if config.sim_backend != "auto":
        return config.sim_backend
    return "physx_cuda" if device == "cuda" else "physx_cpu"


def make_env(config: PPOConfig, num_envs: int, device: str, **kwargs: Any) -> gym.Env:
    """gym.make with a user's flags.

    Raises:
        InputError: the task does not exist or refuses a flag; says what would do.
    """
    import mani_skill.envs  # noqa: F401  # Registers ManiSkill's own tasks.

    import maniskill_taskgrasp  # noqa: F401  # Registers ours.

    arguments = task_kwargs(config)
    if is_task_grasp(config.env_id) and config.objects is None:
        objects, topologies = training_pairs(config.topology)
        arguments |= {"objects": objects, "topology": topologies}
    arguments |= kwargs
    arguments |= {"obs_mode": "state", "sim_backend": _sim_backend(config, device)}
    try:
        return gym.make(config.env_id, num_envs=num_envs, **arguments)
    except Exception as error:
        refusal = _refusal(error, config.env_id, num_envs, arguments["sim_backend"])
        if refusal is None:
            raise
        raise refusal from error


def _refusal(error: Exception, env_id: str, num_envs: int, sim_backend: str) -> InputError | None:
    """What a user should be told when a task could not be made; None where it is no mistake."""
    text = str(error)
    if isinstance(error, gym.error.UnregisteredEnv):
        known = (name for name in gym.registry if "-v" in name)
        more = "python -c 'import mani_skill.envs, gymnasium as g; g.pprint_registry()'"
        return unknown_name("environment", env_id, known, more)
    if isinstance(error, RuntimeError) and num_envs > 1 and "multiple environments" in text:
        return InputError(
            f"{echo(env_id)} cannot run {num_envs} environments in one process on a CPU: use "
            "--num-envs 1 (or torchrun with one each), --env-vectorization cpu, or a CUDA GPU"
        )
    if isinstance(error, KeyError) and error.args == (sim_backend,):
        return unknown_name("--sim-backend", sim_backend, SIM_BACKENDS)
    unknown = re.search(r"unexpected keyword argument '(\w+)'", text)
    if isinstance(error, TypeError) and unknown is not None:
        flag = "--" + unknown[1].replace("_", "-")
        return InputError(f"{echo(env_id)} has no {flag}: leave it out")
    if isinstance(error, AssertionError) and "not in supported modes" in text:
        return InputError(f"--control-mode {text.replace(' not in', ': not in')}")
    if isinstance(error, NotImplementedError):
        return InputError(f"{echo(env_id)} refuses its arguments: {' '.join(text.split())}")
    return None


def checked(envs: Any, config: PPOConfig) -> VectorEnv:
    """The vector environment, if its observations and actions are what the networks take."""
    space = envs.single_observation_space
    if not (isinstance(space, gym.spaces.Box) and len(space.shape) == 1):
        raise InputError(f"{echo(config.env_id)} gives no flat state observation, but {space}")
    if not isinstance(envs.single_action_space, gym.spaces.Box):
        raise InputError(
            f"only one Box of actions can be learned, but {echo(config.env_id)} takes "
            f"{envs.single_action_space}: choose another --control-mode"
        )
    return envs


def make_training_envs(config: PPOConfig, num_envs: int, device: str, run_dir: Path) -> VectorEnv:
    """Training environments of one process, which restart by themselves."""
    from mani_skill.vector.wrappers.gymnasium import ManiSkillVectorEnv

    kwargs: dict[str, Any] = {}
    if config.reconfiguration_freq is not None:
        if config.partial_reset and num_envs > 1:
            raise InputError(
                "--reconfiguration-freq does not go with partial resets of several environments: "
                "use --no-partial-reset, or --save-freq, as checkpoints rebuild the scene too"
            )
        kwargs["reconfiguration_freq"] = config.reconfiguration_freq
    if config.env_vectorization == "cpu":
        return _process_envs(config, num_envs, kwargs, training=True)
    if config.save_train_video_freq is not None:
        kwargs["render_mode"] = "rgb_array"
    env = make_env(config, num_envs, device, **kwargs)
    if config.save_train_video_freq is not None:
        env = _filmed(env, config, run_dir / "train_videos")
    envs = ManiSkillVectorEnv(
        env, num_envs, ignore_terminations=not config.partial_reset, record_metrics=True
    )
    return checked(envs, config)


def make_evaluation_envs(config: PPOConfig, num_envs: int, device: str, run_dir: Path) -> VectorEnv:
    """Evaluation environments of one process; they go on after an episode's end until reset."""
    from mani_skill.vector.wrappers.gymnasium import ManiSkillVectorEnv

    del run_dir  # Nothing of theirs is recorded: films are made apart.
    if config.env_vectorization == "cpu":
        return _process_envs(config, num_envs, {}, training=False)
    envs = ManiSkillVectorEnv(
        make_env(config, num_envs, device),
        num_envs,
        auto_reset=False,
        ignore_terminations=not config.eval_partial_reset,
        record_metrics=True,
    )
    return checked(envs, config)


def _process_envs(
    config: PPOConfig, num_envs: int, kwargs: dict[str, Any], *, training: bool
) -> VectorEnv:
    from maniskill_taskgrasp.train.process_envs import ProcessEnvs

    if config.save_train_video_freq is not None:
        raise InputError("--save-train-video-freq does not go with --env-vectorization cpu")
    partial_reset = config.partial_reset if training else config.eval_partial_reset
    envs = ProcessEnvs(
        config, num_envs, kwargs, ignore_terminations=not partial_reset, auto_reset=training
    )
    return checked(envs, config)


def _filmed(env: gym.Env, config: PPOConfig, folder: Path) -> gym.Env:
    from mani_skill.utils.wrappers.record import RecordEpisode

    assert config.save_train_video_freq is not None
    period = config.save_train_video_freq * config.num_steps
    return RecordEpisode(
        env,
        str(folder),
        save_trajectory=False,
        save_video_trigger=lambda step: step % period < config.num_steps,
        max_steps_per_video=config.num_steps,
    )
