"""A batched task small enough for unit tests, with ManiSkill's vector interface.

The action, in a box [0, 1], must name the target that the observation shows. As in PhysX, a hidden
cache carries over plain resets and disturbs the rewards; only a rebuilt scene clears it.

As a script it trains on itself: python tests/toy_reach.py [flags of train/ppo.py].
"""

from __future__ import annotations

import sys
import time

import gymnasium as gym
import numpy as np
import torch

HORIZON = 5
ACTION_DIM = 2
TOLERANCE = 0.25


class ToyReach:
    """Vector environment; success ends an episode early when terminations count."""

    def __init__(self, num_envs, *, auto_reset=True, terminate=True, delay=0.0):
        self.num_envs = num_envs
        self.device = torch.device("cpu")
        self.single_observation_space = gym.spaces.Box(-np.inf, np.inf, (ACTION_DIM + 1,))
        self.single_action_space = gym.spaces.Box(0.0, 1.0, (ACTION_DIM,))
        self.auto_reset, self.terminate, self.delay = auto_reset, terminate, delay
        self.cache = 0.0
        self.seeds = None
        self.closed = False

    def _restart(self, mask):
        for i in mask.nonzero().flatten().tolist():
            self.target[i] = torch.rand(ACTION_DIM, generator=self.generators[i])
        self.elapsed[mask] = 0
        self.returns[mask] = 0
        self.success_once[mask] = False

    def _obs(self):
        # Far from unit scale, so that learning needs the normaliser.
        return torch.cat([1000 * self.target, self.elapsed[:, None].float()], dim=1)

    def reset(self, *, seed=None, options=None):
        n = self.num_envs
        if (options or {}).get("reconfigure"):
            self.cache = 0.0
        self.seeds = list(seed)
        self.generators = [torch.Generator().manual_seed(s) for s in seed]
        self.target = torch.zeros(n, ACTION_DIM)
        self.elapsed = torch.zeros(n, dtype=torch.int32)
        self.returns = torch.zeros(n)
        self.success_once = torch.zeros(n, dtype=torch.bool)
        self._restart(torch.ones(n, dtype=torch.bool))
        return self._obs(), {}

    def step(self, actions):
        assert actions.shape == (self.num_envs, ACTION_DIM)
        assert ((actions >= 0) & (actions <= 1)).all()
        time.sleep(self.delay)
        self.cache += 1e-3
        error = (actions - self.target).abs().amax(dim=1)
        reward = 1 - error + self.cache * 1e-2
        success = error < TOLERANCE
        self.elapsed += 1
        self.returns += reward
        self.success_once |= success
        truncated = self.elapsed >= HORIZON
        terminated = success & self.terminate
        info = {
            "success": success,
            "episode": {
                "success_once": self.success_once.clone(),
                "return": self.returns.clone(),
                "episode_len": self.elapsed.clone(),
                "reward": self.returns / self.elapsed,
            },
        }
        done = terminated | truncated
        obs = self._obs()
        if self.auto_reset and done.any():
            final = info
            self._restart(done)
            info = {"final_info": final, "_final_info": done, "final_observation": obs}
            obs = self._obs()
        return obs, reward, terminated, truncated, info

    def close(self):
        self.closed = True


def factories(delay=0.0):
    """What `train(config, factories)` needs to train on this task."""
    from maniskill_taskgrasp.train.trainer import EnvFactories

    def training(config, num_envs, device, run_dir):
        return ToyReach(num_envs, terminate=config.partial_reset, delay=delay)

    def evaluation(config, num_envs, device, run_dir):
        return ToyReach(num_envs, auto_reset=False, terminate=config.eval_partial_reset)

    return EnvFactories(training, evaluation, can_film=False)


if __name__ == "__main__":
    from maniskill_taskgrasp.train.ppo import parse_config, train

    train(parse_config(sys.argv[1:]), factories(delay=0.002))
