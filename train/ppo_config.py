"""Which settings PPO has: ManiSkill's flags, ours, and their defaults for a task and a machine."""

from __future__ import annotations

import importlib.util
import math
from dataclasses import dataclass, replace
from typing import Any, Literal

from maniskill_taskgrasp.errors import InputError, echo

TASK_GRASP = "TaskGrasp-v0"
CPU_ROLLOUT = 2048  # Samples per update that a few environments on a CPU collect.

Preset = Literal["paper"]


@dataclass(frozen=True, kw_only=True)
class PPOConfig:
    """Train a policy with PPO on any ManiSkill task; flags as in ManiSkill's own baseline."""

    exp_name: str | None = None
    """Name of the run's folder; by default {env}__ppo__{seed}__{time}."""
    seed: int = 1
    """Seed of everything: weights, action noise, environments, minibatches."""
    torch_deterministic: bool = True
    """Ask cuDNN for deterministic kernels."""
    cuda: bool = True
    """Use a CUDA device where there is one."""
    track: bool = False
    """Also log to Weights and Biases (needs `pip install wandb`)."""
    wandb_project_name: str = "ManiSkill"
    """Weights and Biases project."""
    wandb_entity: str | None = None
    """Weights and Biases entity (team)."""
    wandb_group: str | None = "PPO"
    """Weights and Biases group."""
    capture_video: bool = True
    """Film one episode at each evaluation of a trained policy, where rendering is possible."""
    save_model: bool = True
    """Write checkpoints (ckpt_<iteration>.pt and final_ckpt.pt)."""
    evaluate: bool = False
    """Do not train: evaluate --checkpoint, and save a video and its trajectory."""
    checkpoint: str | None = None
    """Policy file to start from (ours, or ManiSkill's bare weights)."""

    env_id: str = TASK_GRASP
    """ManiSkill task to train on."""
    total_timesteps: int = 10_000_000
    """Samples to collect, over all environments and processes."""
    learning_rate: float = 3e-4
    """Adam's step size."""
    num_envs: int = 512
    """Parallel environments, over all processes of torchrun."""
    num_eval_envs: int = 8
    """Parallel environments of an evaluation, per process."""
    partial_reset: bool = True
    """End training episodes at success or failure, not only at the time limit."""
    eval_partial_reset: bool = False
    """The same for evaluation episodes."""
    num_steps: int = 50
    """Steps per environment and rollout."""
    num_eval_steps: int | None = None
    """Cut evaluation episodes at this many steps; by default at the task's own time limit."""
    reconfiguration_freq: int | None = None
    """Rebuild the training scene every this many resets; by default as the task has it."""
    eval_reconfiguration_freq: int | None = 1
    """Rebuild the evaluation scene every this many batches of episodes."""
    control_mode: str | None = None
    """The robot's control mode; by default the task's."""
    anneal_lr: bool = False
    """Lower the learning rate linearly to zero."""
    gamma: float = 0.8
    """Discount per step."""
    gae_lambda: float = 0.9
    """Lambda of the generalised advantage estimate."""
    num_minibatches: int = 32
    """Minibatches per epoch."""
    update_epochs: int = 4
    """Passes over each rollout."""
    norm_adv: bool = True
    """Normalise advantages in each minibatch."""
    clip_coef: float = 0.2
    """Clipping range of the probability ratio."""
    clip_vloss: bool = False
    """Clip the value loss as well."""
    ent_coef: float = 0.0
    """Weight of the entropy bonus."""
    vf_coef: float = 0.5
    """Weight of the value loss."""
    max_grad_norm: float = 0.5
    """Largest norm of the gradient."""
    target_kl: float | None = 0.1
    """Stop an update once the approximate KL divergence exceeds this."""
    reward_scale: float = 1.0
    """Factor on rewards before learning; logged returns stay unscaled."""
    eval_freq: int = 25
    """Evaluate before training and then every this many iterations; always at the end."""
    save_train_video_freq: int | None = None
    """Film the training environments every this many iterations (one environment, or CUDA)."""
    finite_horizon_gae: bool = False
    """Average n-step returns with weights that sum to one at the horizon."""
    env_vectorization: Literal["gpu", "cpu"] = "gpu"
    """gpu: one batched simulation (on the CPU where the task can); cpu: a process for each."""
    compile: bool = False
    """Compile the network with torch.compile."""
    cudagraphs: bool = False
    """Replay the compiled network as CUDA graphs (needs --compile and CUDA)."""

    topology: tuple[str, ...] | None = None
    """TaskGrasp: topologies to train on, or "all"."""
    objects: tuple[str, ...] | None = None
    """TaskGrasp: "train", "test", "all", or names and mesh files."""
    presentation: str | None = None
    """TaskGrasp: auto, stand, table, rail, rack or holder."""
    noise: str | None = None
    """TaskGrasp: "none", "paper", "hard" or "blind"."""
    distance: str | None = None
    """TaskGrasp: what the distances know, "exact", "noisy" or "none"."""
    obs: str | None = None
    """TaskGrasp: "full", or "paper" for exactly its 12 numbers."""
    reward_mode: str | None = None
    """The task's reward mode; by default the task's first."""
    sim_backend: str = "auto"
    """ManiSkill's simulation back end; auto: CUDA where there is one, else the CPU."""
    teacher: Literal["constant", "follow", "guarded", "oracle"] | None = None
    """TaskGrasp: rule that the network imitates before PPO starts; the oracle knows where the
    object is, which the network must learn to tell from what it observes."""
    teacher_lessons: int = 8
    """Rollouts of imitation."""
    teacher_logstd: float = -1.6
    """Log deviation of the actions, in the network's range, during imitation and after it."""
    preset: Preset | None = None
    """paper: the settings of the TaskGrasp paper; flags given beside it win."""
    resume: str | None = None
    """Go on with a run: its name, folder, or one of its checkpoints."""
    norm_obs: bool = True
    """Normalise observations by their running mean and deviation (kept in the checkpoint)."""
    bootstrap_at_done: Literal["always", "truncated"] = "always"
    """Which ended episodes still have a future: all (upstream), or those cut by the time limit."""
    eval_episodes: int = 100
    """Episodes of an evaluation, rounded up to whole batches."""
    save_freq: int | None = None
    """Checkpoint every this many iterations and rebuild the scene; by default eval_freq."""
    torch_threads: int = 1
    """CPU threads of torch per process; these networks are too small for more."""
    runs_dir: str = "runs"
    """Folder that holds the runs."""

    @property
    def batch_size(self) -> int:
        """Samples per iteration, over all processes."""
        return self.num_envs * self.num_steps

    @property
    def minibatch_size(self) -> int:
        """Samples per gradient step, over all processes."""
        return self.batch_size // self.num_minibatches

    @property
    def num_iterations(self) -> int:
        """Rollouts that the sample budget pays for."""
        return self.total_timesteps // self.batch_size

    @property
    def checkpoint_freq(self) -> int:
        """Iterations between checkpoints."""
        return self.save_freq or self.eval_freq


TASK_GRASP_DEFAULTS: dict[str, Any] = {
    "total_timesteps": 1_000_000,
    "num_envs": 64,
    "num_eval_envs": 50,
    "num_minibatches": 16,
    "gamma": 0.95,
    "gae_lambda": 0.95,
    "bootstrap_at_done": "truncated",
    # Failed episodes run on: ended ones only start over with an approach, which takes no skill.
    "partial_reset": False,
}
CPU_OTHER: dict[str, Any] = {"num_envs": 1, "num_eval_envs": 1, "num_steps": CPU_ROLLOUT}

PRESETS: dict[str, dict[str, Any]] = {
    # The paper's learning rate, discount, clipping range and sample budget; 20 updates of 2500.
    # Failed episodes must run on (TASK_GRASP_DEFAULTS): with a reward that is negative until
    # something is touched, ended ones teach to fail soon.
    "paper": {
        "env_id": TASK_GRASP,
        "obs": "paper",
        "reward_mode": "paper",
        "control_mode": "pd_synergy",
        "noise": "paper",
        "learning_rate": 2.5e-4,
        "gamma": 0.9,
        "clip_coef": 0.2,
        "total_timesteps": 50_000,
        "num_envs": 50,
        "num_steps": 50,
        "num_minibatches": 10,
        # Rewards reach 1000; a plain change of unit keeps the value loss in a range Adam likes.
        "reward_scale": 1e-3,
    },
}


def is_task_grasp(env_id: str) -> bool:
    """Whether an id, with or without its module prefix, names our own task."""
    return env_id.rpartition(":")[2] == TASK_GRASP


def default_config(env_id: str, preset: Preset | None, has_cuda: bool) -> PPOConfig:
    """Settings before the user's own flags: upstream's, then the machine's, the task's, a preset's.

    Raises:
        InputError: the preset belongs to another task.
    """
    config = PPOConfig(env_id=env_id, preset=preset)
    if is_task_grasp(env_id):
        config = replace(config, **TASK_GRASP_DEFAULTS)
    elif not has_cuda:
        config = replace(config, **CPU_OTHER)
    if preset is None:
        return config
    if not is_task_grasp(env_id):
        raise InputError(f"--preset {preset} is for {TASK_GRASP}, but --env-id is {echo(env_id)}")
    return replace(config, **PRESETS[preset] | {"env_id": env_id})


def _positive(config: PPOConfig, *names: str) -> None:
    for name in names:
        value = getattr(config, name)
        if value is not None and not (math.isfinite(value) and value > 0):
            flag = "--" + name.replace("_", "-")
            raise InputError(f"{flag} must be a number greater than 0, got {value}")


def _check_teacher(config: PPOConfig) -> None:
    if config.teacher is not None and not is_task_grasp(config.env_id):
        raise InputError(f"--teacher {config.teacher} is for {TASK_GRASP}, not {config.env_id}")
    if (
        config.teacher in ("follow", "guarded", "oracle")
        and config.control_mode != "pd_synergy_wrist"
    ):
        raise InputError(
            f"--teacher {config.teacher} moves the palm: add --control-mode pd_synergy_wrist"
        )


def check_config(config: PPOConfig, world_size: int) -> None:
    """Refuse settings that cannot run, before anything is built.

    Raises:
        InputError: a value is out of range or contradicts another; says what would do.
    """
    _positive(config, "total_timesteps", "num_envs", "num_eval_envs", "num_steps", "num_eval_steps")
    _positive(config, "learning_rate", "num_minibatches", "update_epochs", "clip_coef", "target_kl")
    _positive(config, "max_grad_norm", "reward_scale", "eval_freq", "save_freq", "eval_episodes")
    _positive(config, "torch_threads", "save_train_video_freq", "teacher_lessons")
    for name in ("gamma", "gae_lambda"):
        if not 0.0 <= getattr(config, name) <= 1.0:
            flag = "--" + name.replace("_", "-")
            raise InputError(f"{flag} must lie in [0, 1], got {getattr(config, name)}")
    if config.num_envs % world_size:
        raise InputError(
            f"--num-envs {config.num_envs} does not divide among {world_size} processes: "
            f"use a multiple of {world_size}"
        )
    if config.minibatch_size < 2 * world_size:
        raise InputError(
            f"--num-minibatches {config.num_minibatches} leaves fewer than 2 of the "
            f"{config.batch_size} samples (num_envs x num_steps) in each: use fewer minibatches"
        )
    if not config.evaluate and config.num_iterations < 1:
        raise InputError(
            f"--total-timesteps {config.total_timesteps} is less than one rollout of "
            f"{config.batch_size} samples (num_envs x num_steps)"
        )
    if config.evaluate and config.checkpoint is None:
        raise InputError("--evaluate needs --checkpoint FILE, the policy to evaluate")
    _check_teacher(config)
    if config.track and importlib.util.find_spec("wandb") is None:
        raise InputError("--track needs wandb: pip install wandb, or leave --track out")
    if config.cudagraphs and not config.compile:
        raise InputError("--cudagraphs needs --compile")
