"""How a training run proceeds: rollouts, updates, evaluations and checkpoints, in which order."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch

from maniskill_taskgrasp.train import environments
from maniskill_taskgrasp.train.checkpoint import (
    FINAL_NAME,
    checkpoint_name,
    preserved_rng,
    rng_state,
    save_checkpoint,
    set_rng_state,
)
from maniskill_taskgrasp.train.distributed import Processes
from maniskill_taskgrasp.train.filming import film_episode
from maniskill_taskgrasp.train.policy_eval import Evaluation, merge, run_episodes
from maniskill_taskgrasp.train.ppo_agent import ActionScaler, Agent, ObsNormalizer, sample_moments
from maniskill_taskgrasp.train.ppo_config import PPOConfig
from maniskill_taskgrasp.train.ppo_update import make_batch, update
from maniskill_taskgrasp.train.rollout import Rollout, VectorEnv, collect
from maniskill_taskgrasp.train.run_log import RunLog, note

ADAM_EPS = 1e-5
WORKER_STREAM = 2  # Seeds of the generators that draw actions and minibatches.

EnvFactory = Callable[[PPOConfig, int, str, Path], VectorEnv]


@dataclass(frozen=True)
class EnvFactories:
    """How environments are made: (config, num_envs, device, run folder) -> vector environment."""

    training: EnvFactory = environments.make_training_envs
    evaluation: EnvFactory = environments.make_evaluation_envs
    can_film: bool = True


def seed_generators(seed: int, rank: int) -> None:
    """Seed torch, numpy and python for one process."""
    word = environments.derived_seeds(seed, WORKER_STREAM, rank, 0, 1)[0]
    torch.manual_seed(word)
    np.random.seed(word)  # noqa: NPY002  # Tasks may draw from the global generator.
    random.seed(word)


class Trainer:
    """One process's part in a training run."""

    def __init__(
        self,
        config: PPOConfig,
        processes: Processes,
        factories: EnvFactories,
        run_dir: Path,
        device: torch.device,
    ) -> None:
        self.config = config
        self.processes = processes
        self.factories = factories
        self.run_dir = run_dir
        self.device = device
        self.iteration = 0
        self.seconds = 0.0  # Of all sessions of the run, evaluations included.
        self._evaluation_envs: VectorEnv | None = None

        local_envs = config.num_envs // processes.world_size
        self.envs = factories.training(config, local_envs, device.type, run_dir)
        obs_shape = self.envs.single_observation_space.shape
        assert obs_shape is not None
        self.scaler = ActionScaler(self.envs.single_action_space, device)
        torch.manual_seed(config.seed)  # The same initial weights in every process.
        action_dim = math.prod(self.envs.single_action_space.shape or ())
        self.agent = Agent(obs_shape[0], action_dim).to(device)
        self.normalizer = ObsNormalizer(obs_shape[0], device)
        self.optimizer = torch.optim.Adam(
            self.agent.parameters(), lr=config.learning_rate, eps=ADAM_EPS, fused=True
        )
        network: torch.nn.Module = self.agent
        if config.compile:
            network.compile(mode="reduce-overhead" if config.cudagraphs else "default")
        self._network = processes.wrap(network)
        seed_generators(config.seed, processes.rank)

    # State ---------------------------------------------------------------------------------

    @property
    def global_step(self) -> int:
        """Samples collected so far, over all processes."""
        return self.iteration * self.config.batch_size

    def load_weights(self, checkpoint: dict[str, Any]) -> None:
        """Start from another policy's weights and normaliser."""
        self.agent.load_state_dict(checkpoint["agent"])
        if "normalizer" in checkpoint:
            self.normalizer.load_state_dict(checkpoint["normalizer"])

    def resume(self, checkpoint: dict[str, Any]) -> None:
        """Take up a run of the same configuration where its checkpoint was written."""
        self.load_weights(checkpoint)
        self.optimizer.load_state_dict(checkpoint["optimizer"])
        self.iteration = checkpoint["iteration"]
        self.seconds = checkpoint["seconds"]
        set_rng_state(checkpoint["rng"][self.processes.rank])

    def _save(self, name: str) -> None:
        generators = self.processes.gather(rng_state())
        if not (self.processes.is_main and self.config.save_model):
            return
        content = {
            "agent": self.agent.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "normalizer": self.normalizer.state_dict(),
            "iteration": self.iteration,
            "global_step": self.global_step,
            "seconds": self.seconds,
            "rng": generators,
            "config": asdict(self.config),
        }
        save_checkpoint(self.run_dir / name, content)

    # Training ------------------------------------------------------------------------------

    def run(self) -> Evaluation:
        """Train to the end of the sample budget and evaluate the result."""
        settings = asdict(self.config)
        log = None
        if self.processes.is_main:
            log = RunLog(self.run_dir, self.config, settings, self.iteration, self.global_step)
        session_start, earlier_seconds = time.perf_counter(), self.seconds
        last = self.config.num_iterations
        if self.iteration == 0:
            self._teach()
            self._evaluate_and_log(log)
            self._save(checkpoint_name(0))
        obs = self._rebuild()
        busy_seconds, busy_steps = 0.0, 0
        while self.iteration < last:
            started = time.perf_counter()
            obs, scalars = self._iterate(obs)
            self.iteration += 1
            busy_seconds += time.perf_counter() - started
            busy_steps += self.config.batch_size
            self.seconds = earlier_seconds + time.perf_counter() - session_start
            scalars["charts/SPS"] = busy_steps / busy_seconds
            if log is not None:
                log.iteration(self.iteration, self.global_step, scalars)
            if self.iteration == last:
                break
            if self.iteration % self.config.eval_freq == 0:
                self._evaluate_and_log(log)
            if self.iteration % self.config.checkpoint_freq == 0:
                self._save(checkpoint_name(self.iteration))
                obs = self._rebuild()
        self._save(FINAL_NAME)
        evaluation = self._evaluate_and_log(log)
        if log is not None:
            log.close()
        return evaluation

    def _teach(self) -> None:
        """Let the network imitate the teacher before anything else, where there is one."""
        if self.config.teacher is None:
            return
        from maniskill_taskgrasp.train.teaching import TEACHERS, teach

        rule = TEACHERS[self.config.teacher](self.envs)
        difference = teach(
            self.envs,
            self.agent,
            self.normalizer,
            self.scaler,
            rule,
            self._rebuild(),
            self.config,
        )
        # Every process has seen other episodes: all go on with what the first one learned.
        state = {"agent": self.agent.state_dict(), "normalizer": self.normalizer.state_dict()}
        self.load_weights(self.processes.gather(state)[0])
        if self.processes.is_main:
            note(f"imitates {self.config.teacher}: mean squared difference {difference:.3g}")

    def _rebuild(self) -> torch.Tensor:
        """Rebuild the scene and restart every episode with seeds of this iteration.

        PhysX keeps solver caches that no saved state brings back, so a resumed run could not
        follow the uninterrupted one. Both therefore pass through this reset at checkpoints.
        """
        seeds = environments.derived_seeds(
            self.config.seed,
            environments.TRAINING,
            self.processes.rank,
            self.iteration,
            self.envs.num_envs,
        )
        obs, _ = self.envs.reset(seed=seeds, options={"reconfigure": True})
        return obs.clone()

    def _iterate(self, obs: torch.Tensor) -> tuple[torch.Tensor, dict[str, float]]:
        config = self.config
        if config.anneal_lr:
            left = 1.0 - self.iteration / config.num_iterations
            for group in self.optimizer.param_groups:
                group["lr"] = left * config.learning_rate
        started = time.perf_counter()
        rollout = collect(
            self.envs, self.agent, self.normalizer, self.scaler, obs, config.num_steps
        )
        rolled_out = time.perf_counter()
        losses = self._learn(rollout)
        updated = time.perf_counter()
        rollout_seconds = rolled_out - started
        scalars = {f"train/{name}": mean for name, mean in self._episode_means(rollout).items()}
        scalars |= {f"losses/{name}": value for name, value in losses.items()}
        scalars |= {
            "charts/learning_rate": self.optimizer.param_groups[0]["lr"],
            "time/step": float(self.global_step + config.batch_size),
            "time/update_time": updated - rolled_out,
            "time/rollout_time": rollout_seconds,
            "time/rollout_fps": config.batch_size / rollout_seconds,
        }
        return rollout.last_obs, scalars

    def _learn(self, rollout: Rollout) -> dict[str, float]:
        if self.config.norm_obs:
            moments = sample_moments(rollout.obs.flatten(0, 1))
            for count, mean, sum_squares in self.processes.gather(moments):
                self.normalizer.merge(count, mean.to(self.device), sum_squares.to(self.device))
        batch = make_batch(rollout, self.agent, self.normalizer, self.config)
        return update(self._network, self.optimizer, batch, self.config, self.processes)

    def _episode_means(self, rollout: Rollout) -> dict[str, float]:
        parts = self.processes.gather(rollout.episodes)
        return merge(parts).means()

    # Evaluation ----------------------------------------------------------------------------

    def act_deterministically(self, obs: torch.Tensor) -> torch.Tensor:
        """(num_envs, obs_dim) raw observations -> (num_envs, action_dim) mean actions."""
        with torch.no_grad():
            return self.scaler(self.agent.actor_mean(self.normalizer(obs)))

    def evaluate(self) -> Evaluation:
        """Deterministic episodes, the same seeds every time, shared among the processes."""
        config, processes = self.config, self.processes
        with preserved_rng():
            if self._evaluation_envs is None:
                self._evaluation_envs = self.factories.evaluation(
                    config, config.num_eval_envs, self.device.type, self.run_dir
                )
            envs = self._evaluation_envs
            own: dict[int, dict[str, list[float]]] = {}
            freq = config.eval_reconfiguration_freq
            batches = math.ceil(config.eval_episodes / envs.num_envs)
            for index in range(processes.rank, batches, processes.world_size):
                own[index] = run_episodes(
                    envs,
                    self.act_deterministically,
                    environments.derived_seeds(
                        config.seed, environments.EVALUATION, 0, index, envs.num_envs
                    ),
                    reconfigure=bool(freq) and index % (freq or 1) == 0,
                    step_limit=config.num_eval_steps,
                )
        parts = {index: part for each in processes.gather(own) for index, part in each.items()}
        return merge([parts[index] for index in sorted(parts)])

    def _evaluate_and_log(self, log: RunLog | None) -> Evaluation:
        evaluation = self.evaluate()
        if log is not None:
            log.evaluation(self.iteration, self.global_step, evaluation.summary())
            note(f"iteration {self.iteration}, step {self.global_step}: {evaluation.headline()}")
            if self.config.capture_video and self.iteration > 0 and self.factories.can_film:
                self.film(f"iteration_{self.iteration}", trajectory=False)
        return evaluation

    def film(self, name: str, *, trajectory: bool) -> None:
        """Film one deterministic episode into the run's folder, where rendering is possible."""
        with preserved_rng():
            path = film_episode(
                self.config,
                self.device.type,
                self.run_dir / "videos",
                name,
                self.act_deterministically,
                trajectory=trajectory,
            )
        note(f"video: {path}" if path else "no video: SAPIEN finds no Vulkan device to render with")

    def close(self) -> None:
        """Free the simulations."""
        self.envs.close()
        if self._evaluation_envs is not None:
            self._evaluation_envs.close()
