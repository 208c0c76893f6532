"""A start for PPO: the network first imitates a rule that needs no learning, where there is one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch
from torch import Tensor

from maniskill_taskgrasp.tasks.closing import ConstantClosing, FollowRule, GuardedRule, Oracle
from maniskill_taskgrasp.train.ppo_agent import ActionScaler, Agent, ObsNormalizer, sample_moments
from maniskill_taskgrasp.train.ppo_update import make_batch
from maniskill_taskgrasp.train.rollout import Rollout, collect

if TYPE_CHECKING:
    from maniskill_taskgrasp.train.ppo_config import PPOConfig
    from maniskill_taskgrasp.train.rollout import VectorEnv

LESSON_EPOCHS = 3
LESSON_SIZE = 512  # Samples of a gradient step.
SOLO = 0.5  # Share of the lessons from which on the pupil acts and the teacher only corrects.


TEACHERS = {
    "constant": ConstantClosing,
    "follow": FollowRule,
    "guarded": GuardedRule,
    "oracle": Oracle,
}


class Teacher:
    """A rule of tasks/closing.py whose actions are noted, and carried out in early lessons."""

    def __init__(self, rule: Any, scaler: ActionScaler, agent: Agent) -> None:
        """
        Args:
            rule: observations -> task actions; ours look at the environment instead.
            agent: the pupil; its deviation is the noise of both.
        """
        self._rule = rule
        self._scaler = scaler
        self._agent = agent
        self.acts = True
        self.advice: list[Tensor] = []

    def act(self, obs: Tensor) -> tuple[Tensor, Tensor]:
        """Noisy actions in the network's range for normalised observations, as `Agent.act`."""
        advice = self._scaler.inverse(self._rule(obs))
        self.advice.append(advice)
        action, logprob = self._agent.act(obs)
        if self.acts:
            action = advice + (action - self._agent.actor_mean(obs))
        return action, logprob


def teach(
    envs: VectorEnv,
    agent: Agent,
    normalizer: ObsNormalizer,
    scaler: ActionScaler,
    rule: Any,
    obs: Tensor,
    config: PPOConfig,
) -> float:
    """Imitate a rule and learn its returns (behaviour cloning, then the pupil's own states).

    Returns:
        Mean squared difference of the pupil's and the teacher's actions in the last lesson.
    """
    optimizer = torch.optim.Adam(agent.parameters(), lr=1e-3)
    with torch.no_grad():
        agent.actor_logstd.fill_(config.teacher_logstd)
    rollouts: list[Rollout] = []
    advice: list[Tensor] = []
    difference = float("nan")
    for lesson in range(config.teacher_lessons):
        teacher = Teacher(rule, scaler, agent)
        teacher.acts = lesson < SOLO * config.teacher_lessons
        rollout = collect(envs, teacher, normalizer, scaler, obs, config.num_steps)
        obs = rollout.last_obs
        if config.norm_obs:
            normalizer.merge(*sample_moments(rollout.obs.flatten(0, 1)))
        rollouts.append(rollout)
        advice.append(torch.stack(teacher.advice).flatten(0, 1))
        difference = _lesson(agent, optimizer, normalizer, rollouts, advice, config)
    return difference


def _lesson(
    agent: Agent,
    optimizer: torch.optim.Optimizer,
    normalizer: ObsNormalizer,
    rollouts: list[Rollout],
    advice: list[Tensor],
    config: PPOConfig,
) -> float:
    """Go over everything seen so far; returns of old rollouts are taken with today's values."""
    batches = [make_batch(rollout, agent, normalizer, config) for rollout in rollouts]
    obs = torch.cat([batch.obs for batch in batches])
    returns = torch.cat([batch.returns for batch in batches])
    wanted = torch.cat(advice)
    errors = []
    for _ in range(LESSON_EPOCHS):
        for index in torch.randperm(len(obs), device=obs.device).split(LESSON_SIZE):
            error = (agent.actor_mean(obs[index]) - wanted[index]).square().mean()
            value_error = (agent.value(obs[index]) - returns[index]).square().mean()
            optimizer.zero_grad(set_to_none=True)
            (error + 0.5 * value_error).backward()
            torch.nn.utils.clip_grad_norm_(agent.parameters(), 1.0)
            optimizer.step()
            errors.append(error.item())
    last = errors[-(len(errors) // LESSON_EPOCHS) :]
    return sum(last) / len(last)
