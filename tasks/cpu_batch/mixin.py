"""When a task runs batched on the CPU, and how its BaseEnv is led there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from mani_skill.envs.utils.system.backend import CPU_SIM_BACKENDS, BackendInfo

from maniskill_taskgrasp.tasks.actions import check_action
from maniskill_taskgrasp.tasks.cpu_batch.scene import BatchedCpuScene, adopting_structs
from maniskill_taskgrasp.tasks.cpu_batch.workers import default_processes
from maniskill_taskgrasp.tasks.rendering import choose_render_backend, needs_cameras

if TYPE_CHECKING:
    from mani_skill.agents.base_agent import BaseAgent
    from mani_skill.envs.sapien_env import BaseEnv as Base
else:
    Base = object

KNOWN_MANISKILL = "3.0.1"
BATCHED_BACKEND = "physx_cpu_batched"  # Not in CPU_SIM_BACKENDS, which BaseEnv limits to one.


class _AppliesTargets:
    """Stands for the simulation's device: BaseEnv then takes its batched branches."""

    def is_cuda(self) -> bool:
        return True


class CpuBatchMixin(Base):
    """Put before BaseEnv: `class MyEnv(CpuBatchMixin, BaseEnv)`.

    `num_envs > 1` then runs on the CPU when `sim_backend` says so, or is "auto" and there is no
    CUDA device; so does a single one under `sim_backend="physx_cpu_batched"`. Else nothing changes,
    except that bad actions are refused before anything moves on every back end.

    The physics is shared among `scene_config.cpu_workers` processes of `sim_config` (0, the
    default: one per core where that pays). Results do not depend on their number.

    Raises:
        ValueError: cameras are asked for on the batched CPU or where nothing can render.
        RuntimeError: batched CPU with a ManiSkill whose inside is not known to fit.
    """

    _cpu_batched = False

    def __init__(
        self,
        *,
        num_envs: int = 1,
        obs_mode: str | None = None,
        sim_backend: str = "auto",
        render_backend: str = "gpu",
        **kwargs: Any,
    ):
        if sim_backend == "auto":
            on_cpu = num_envs == 1 or not torch.cuda.is_available()
            sim_backend = "physx_cpu" if on_cpu else "physx_cuda"
        asked = sim_backend == BATCHED_BACKEND
        self._cpu_batched = asked or (num_envs > 1 and sim_backend in CPU_SIM_BACKENDS)
        if self._cpu_batched:
            _check_version()
            if needs_cameras(obs_mode) or kwargs.get("parallel_in_single_scene"):
                raise ValueError(
                    f"obs_mode={obs_mode!r} with num_envs={num_envs} on the CPU: cameras exist for "
                    "num_envs=1 and on CUDA; use obs_mode='state' or 'state_dict' here"
                )
            sim_backend, render_backend = "physx_cpu", "none"
        else:
            render_backend = choose_render_backend(render_backend, obs_mode)
        super().__init__(
            num_envs=num_envs,
            obs_mode=obs_mode,
            sim_backend=sim_backend,
            render_backend=render_backend,
            **kwargs,
        )

    @property
    def backend(self) -> BackendInfo:
        """Where physics and rendering run."""
        return self._backend

    @backend.setter
    def backend(self, info: BackendInfo) -> None:
        if self._cpu_batched:
            info = replace(info, sim_backend=BATCHED_BACKEND, sim_device=_AppliesTargets())
        self._backend = info

    def _set_scene_config(self) -> None:
        if not self._cpu_batched:
            super()._set_scene_config()
            return
        wanted = self.sim_config.scene_config
        # Threads inside PhysX are of no use to systems of one environment each.
        self.sim_config.scene_config = replace(
            wanted, cpu_workers=0, enable_enhanced_determinism=True
        )
        try:
            super()._set_scene_config()
        finally:
            self.sim_config.scene_config = wanted

    def _setup_scene(self) -> None:
        if not self._cpu_batched:
            super()._setup_scene()
            return
        self._set_scene_config()
        self.scene = BatchedCpuScene(
            self.num_envs,
            self.sim_config.scene_config.cpu_workers or default_processes(self.num_envs),
            sim_config=self.sim_config,
            device=self.device,
            backend=self.backend,
        )
        self.scene.px.timestep = 1.0 / self._sim_freq

    def _clear(self) -> None:
        if self._cpu_batched and self.scene is not None:
            self.scene.px.close()
        super()._clear()

    def reset(self, seed: Any = None, options: dict | None = None) -> Any:
        if not self._cpu_batched:
            return super().reset(seed=seed, options=options)
        envs = None if options is None else options.get("env_idx")
        with adopting_structs(), self._rewriting(envs):
            return super().reset(seed=seed, options=options)

    def set_state_dict(self, state: dict, env_idx: torch.Tensor | None = None) -> None:
        with self._rewriting(env_idx):
            super().set_state_dict(state, env_idx)

    @contextmanager
    def _rewriting(self, envs: Any) -> Iterator[None]:
        """These environments (None: all) are written whole, even where a value stays the same."""
        if self._cpu_batched and self.scene is not None:
            self.scene.px.begin_rewrite(slice(None) if envs is None else np.asarray(envs))
        try:
            yield
        finally:
            if self._cpu_batched and self.scene is not None:  # May have been built meanwhile.
                self.scene.px.end_rewrite()

    def _step_action(self, action: Any) -> Any:
        check_action(action, self.agent, self.num_envs)
        if self._cpu_batched and _switches_controller(action, self.agent):
            self.scene.px.join()  # A new controller sets joint drives on SAPIEN's objects.
        return super()._step_action(action)

    def render(self) -> Any:
        if self._cpu_batched:
            raise ValueError("nothing renders with num_envs > 1 on the CPU: use num_envs=1 or CUDA")
        return super().render()


def _switches_controller(action: Any, agent: BaseAgent) -> bool:
    mode = action.get("control_mode") if isinstance(action, dict) else None
    return mode is not None and mode not in agent.controllers


def _check_version() -> None:
    found = version("mani_skill")
    if found != KNOWN_MANISKILL:
        raise RuntimeError(
            f"num_envs > 1 on the CPU is made for ManiSkill {KNOWN_MANISKILL}, found {found}: "
            "use num_envs=1, CUDA, or that version"
        )
