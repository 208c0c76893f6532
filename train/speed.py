"""Speed of simulations, each measured in a process of its own: ours, bare physics and others."""

from __future__ import annotations

import os
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median
from typing import Any

import gymnasium as gym
import torch

from maniskill_taskgrasp.episode import CLOSE_START, CONTROL_FREQ, MAX_EPISODE_STEPS
from maniskill_taskgrasp.train.stopwatch import Stopwatch

STEPS = MAX_EPISODE_STEPS - 1  # Control steps of a repeat: an episode without its automatic reset.
BARE_EVERY = 5  # Control steps between two looks at bare physics.
SETTLING = 20  # Steps before anything is measured.


@dataclass(frozen=True, kw_only=True)
class Speed:
    """One simulation's speed; every list has one entry a repeat."""

    name: str
    num_envs: int
    processes: int
    control_freq: float
    """[Hz]"""
    wall: list[float]
    """[s] for one control step of all environments."""
    cpu: list[float]
    """[s] of this process's CPU time for the same; empty where several processes work."""
    sections: dict[str, float] = field(default_factory=dict)
    """Share of the CPU time of env.step in each section."""
    bare: list[float] = field(default_factory=list)
    """[s] of CPU time of bare physics of the same scene, for a control step."""
    memory_mib: float = 0.0
    """[MiB] that the environments added to this process and its children."""

    @property
    def rate(self) -> float:
        """Environment steps a second."""
        return self.num_envs / median(self.wall)

    @property
    def cpu_rate(self) -> float:
        """Environment steps a second of CPU time: what a core that is shared would do alone."""
        return self.num_envs / median(self.cpu) if self.cpu else float("nan")

    @property
    def simulated(self) -> float:
        """Simulated seconds a second."""
        return self.rate / self.control_freq

    def summary(self) -> dict[str, Any]:
        """All of it, fit for JSON."""
        return {
            **vars(self),
            "steps_per_s": self.rate,
            "steps_per_cpu_s": self.cpu_rate if self.cpu else None,
            "simulated_s_per_s": self.simulated,
            "memory_mib_per_env": self.memory_mib / self.num_envs,
        }


def in_own_process(measure: Callable[..., Speed], *args: Any) -> Speed:
    """Run a measurement in a fresh process, so that none sees another's memory or threads.

    Raises:
        RuntimeError: it failed, with its traceback, or its process died.
    """
    context = get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_send, args=(sender, measure, args))
    process.start()
    sender.close()
    try:
        result = receiver.recv()
    except EOFError:
        result = "its process died"
    process.join()
    if isinstance(result, str):
        raise RuntimeError(f"{measure.__name__}{args} failed: {result}")
    return result


def _send(end: Connection, measure: Callable[..., Speed], args: tuple) -> None:
    try:
        end.send(measure(*args))
    except Exception:
        end.send(traceback.format_exc())


def measure_ours(num_envs: int, processes: int, repeats: int, cores: int) -> Speed:
    """TaskGrasp-v0 under constant closing.

    Args:
        num_envs: environments in one instance.
        processes: of the physics; 1 keeps to this one.
        repeats: episodes to measure.
        cores: how many this process may use.
    """
    _use_cores(cores)
    before = _memory()
    base = _make(num_envs, processes)
    base.reset(seed=0)
    acts = [torch.zeros_like(base._memory.last_action), torch.ones_like(base._memory.last_action)]
    wall, cpu = [], []
    for repeat in range(repeats + 1):  # The first one warms up and is not counted.
        base.reset(seed=repeat)
        start = time.perf_counter(), time.process_time()
        for step in range(STEPS):
            base.step(acts[step >= CLOSE_START])
        if repeat:
            wall.append((time.perf_counter() - start[0]) / STEPS)
            cpu.append((time.process_time() - start[1]) / STEPS)
    memory = _memory() - before
    alone = processes == 1
    sections = _sections(base, acts) if alone else {}
    bare = _bare_physics(base, acts, repeats) if alone else []
    base.close()
    return Speed(
        name="TaskGrasp-v0",
        num_envs=num_envs,
        processes=processes,
        control_freq=CONTROL_FREQ,
        wall=wall,
        cpu=cpu if alone else [],
        sections=sections,
        bare=bare,
        memory_mib=memory,
    )


def _make(num_envs: int, processes: int) -> Any:
    import maniskill_taskgrasp  # noqa: F401  (Registers the task.)

    sim_config = {"scene_config": {"cpu_workers": processes}} if num_envs > 1 else {}
    return gym.make(
        "TaskGrasp-v0",
        num_envs=num_envs,
        obs_mode="state",
        render_backend="none",
        reconfiguration_freq=0,
        sim_config=sim_config,
    ).unwrapped


def _sections(base: Any, acts: list[torch.Tensor]) -> dict[str, float]:
    """Shares of env.step over one episode: physics, reading the state, sensing, reward, the rest.

    "physics" is the time inside SAPIEN's `step`, "state" that of drive targets and packed states.
    """
    watch = Stopwatch()
    for name, section in (
        ("step", "other Python"),
        ("get_obs", "observation"),
        ("evaluate", "evaluation"),
        ("get_reward", "reward"),
    ):
        watch.wrap(base, name, section)
    watch.wrap(base._senses, "read", "sensing")
    watch.wrap(base.agent, "set_action", "controllers")
    groups = [share.local for share in base.scene.px._shares] if base.gpu_sim_enabled else []
    for group in groups:
        watch.wrap(group, "advance", "state")
        watch.wrap(group, "run_physics", "physics")
        watch.wrap(group._contacts, "table", "contacts")
    if not groups:
        watch.wrap(base.scene, "step", "physics")
    base.reset(seed=1)
    watch.clear()
    for step in range(STEPS):
        base.step(acts[step >= CLOSE_START])
    total = sum(watch.seconds.values())
    shares = {name: value / total for name, value in watch.seconds.items()}
    return dict(sorted(shares.items(), key=lambda pair: -pair[1]))


def _bare_physics(base: Any, acts: list[torch.Tensor], repeats: int) -> list[float]:
    """[s] of CPU time that nothing but `step()` of the same scene takes, for a control step."""
    bare = []
    for repeat in range(repeats):
        base.reset(seed=repeat + 1)  # Gives every environment a new system.
        systems = base.scene.px.systems if base.gpu_sim_enabled else [base.scene.px]
        seconds = 0.0
        for step in range(STEPS):
            base.step(acts[step >= CLOSE_START])  # Brings the scene to a state like those measured.
            if step % BARE_EVERY == 0:
                start = time.process_time()
                for system in systems:
                    for _ in range(base._sim_steps_per_control):
                        system.step()
                seconds += time.process_time() - start
        bare.append(seconds / len(range(0, STEPS, BARE_EVERY)))
    return bare


def measure_async(num_processes: int, repeats: int) -> Speed:
    """Our single environment under gymnasium's AsyncVectorEnv, one in each process."""
    before = _memory()
    envs = gym.vector.AsyncVectorEnv([_single] * num_processes)
    space: Any = envs.action_space
    wall = []
    for repeat in range(repeats + 1):
        envs.reset(seed=repeat)
        start = time.perf_counter()
        for step in range(STEPS):
            envs.step(space.low if step < CLOSE_START else space.high)
        if repeat:
            wall.append((time.perf_counter() - start) / STEPS)
    memory = _memory() - before
    envs.close()
    return Speed(
        name="TaskGrasp-v0 under AsyncVectorEnv",
        num_envs=num_processes,
        processes=num_processes,
        control_freq=CONTROL_FREQ,
        wall=wall,
        cpu=[],
        memory_mib=memory,
    )


def _single() -> gym.Env:
    torch.set_num_threads(1)
    from mani_skill.utils.wrappers.gymnasium import CPUGymWrapper

    import maniskill_taskgrasp  # noqa: F401

    env = gym.make("TaskGrasp-v0", render_backend="none", reconfiguration_freq=0)
    return CPUGymWrapper(env)


def measure_other(env_id: str, package: str, repeats: int) -> Speed:
    """Another task, one environment on one core, random actions.

    Args:
        env_id: gymnasium's name of it.
        package: what to import first.
    """
    import importlib

    _use_cores(1)
    importlib.import_module(package)
    before = _memory()
    kwargs: dict[str, Any] = {"obs_mode": "state"} if package.startswith("mani_skill") else {}
    env = gym.make(env_id, **kwargs)
    base: Any = env.unwrapped
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(STEPS)]
    frequency = getattr(base, "control_freq", None) or 1 / base.dt
    wall, cpu = [], []
    for repeat in range(repeats + 1):
        env.reset(seed=repeat)
        for action in actions[:SETTLING]:
            env.step(action)
        start = time.perf_counter(), time.process_time()
        for action in actions:
            env.step(action)
        if repeat:
            wall.append((time.perf_counter() - start[0]) / STEPS)
            cpu.append((time.process_time() - start[1]) / STEPS)
    memory = _memory() - before
    env.close()
    return Speed(
        name=env_id,
        num_envs=1,
        processes=1,
        control_freq=float(frequency),
        wall=wall,
        cpu=cpu,
        memory_mib=memory,
    )


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _use_cores(count: int) -> None:
    """Keep to so many cores, where the system lets us."""
    torch.set_num_threads(1)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, set(sorted(os.sched_getaffinity(0))[:count]))


def _memory() -> float:
    """[MiB] of this process and its children; pages they share count once. 0 where not known."""
    kib = 0
    for pid in [os.getpid(), *_children()]:
        rollup = Path(f"/proc/{pid}/smaps_rollup")
        if rollup.is_file():
            lines = rollup.read_text().splitlines()
            kib += next(int(line.split()[1]) for line in lines if line.startswith("Pss:"))
    return kib / 1024


def _children() -> list[int]:
    listing = Path(f"/proc/self/task/{os.getpid()}/children")
    return [int(pid) for pid in listing.read_text().split()] if listing.is_file() else []
