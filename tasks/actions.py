"""Which actions a simulation may be given."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from gymnasium import spaces

if TYPE_CHECKING:
    from mani_skill.agents.base_agent import BaseAgent


def check_action(action: Any, agent: BaseAgent, num_envs: int) -> None:
    """Refuse an action that would corrupt the simulation; values outside the box are fine.

    Args:
        action: what `env.step` received: None, an array or tensor of (num_envs, dims), (dims,) if
            num_envs is 1, or a dict of "control_mode" and "action".

    Raises:
        ValueError: wrong shape, or a value that is not finite.
    """
    space: spaces.Space = agent.single_action_space
    if isinstance(action, dict) and "control_mode" in action:
        controller = agent.controllers.get(action["control_mode"])
        action = action["action"]
        if controller is None:  # Made by this step; its own shape check comes before any motion.
            _check_finite(action)
            return
        space = controller.single_action_space
    if not isinstance(action, np.ndarray | torch.Tensor) or not isinstance(space, spaces.Box):
        return  # None steps without an action; ManiSkill refuses other types itself.
    shape = tuple(action.shape)
    batched = (num_envs, *space.shape)
    if shape != batched and not (num_envs == 1 and shape == space.shape):
        raise ValueError(f"action has shape {shape}: {batched} is wanted")
    _check_finite(action)


def _check_finite(action: Any) -> None:
    values = torch.as_tensor(action)
    if math.isfinite(values.sum()):
        return  # Each one is, then; a sum may also overflow.
    finite = torch.isfinite(values)
    if not bool(finite.all()):
        where = torch.nonzero(~finite)[0].tolist()
        value = values[tuple(where)].item()
        raise ValueError(f"action{where} is {value}: only finite numbers can be carried out")
