"""Same seed, same bits: over processes, resets and neighbours; memory does not grow."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import gymnasium as gym
import pytest
import torch
from mani_skill.vector.wrappers.gymnasium import ManiSkillVectorEnv

import maniskill_taskgrasp  # noqa: F401  (Registers the task.)
from maniskill_taskgrasp.episode import MAX_EPISODE_STEPS


def make(num_envs, processes=1):
    kwargs = {"sim_config": {"scene_config": {"cpu_workers": processes}}} if num_envs > 1 else {}
    return gym.make(
        "TaskGrasp-v0",
        num_envs=num_envs,
        topology="all",
        noise="hard",
        render_backend="none",
        **kwargs,
    )


def actions(num_envs, steps):
    """(steps, num_envs, 10) that close and open at random."""
    generator = torch.Generator().manual_seed(0)
    return torch.rand(steps, num_envs, 10, generator=generator)


def fingerprint(num_envs, seed, steps, late=0):
    """Hash of every observation and reward of a run with automatic resets, the first `late` steps
    before the end of the clock."""
    env = ManiSkillVectorEnv(make(num_envs), auto_reset=True)
    digest = hashlib.sha256()
    obs, _ = env.reset(seed=seed)
    env.base_env._elapsed_steps += MAX_EPISODE_STEPS - late if late else 0
    for action in actions(num_envs, steps):
        obs, reward, *_ = env.step(action)
        digest.update(obs.numpy().tobytes() + reward.numpy().tobytes())
    env.close()
    return digest.hexdigest()


def elsewhere(*args):
    """`fingerprint` in a process of its own."""
    script = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); "
        f"from test_determinism import fingerprint; print(fingerprint{args})"
    )
    run = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", script], capture_output=True, text=True, check=True
    )
    return run.stdout.split()[-1]


def test_same_seed_gives_same_bits_in_another_process():
    here = fingerprint(2, 7, 12, 6)
    assert elsewhere(2, 7, 12, 6) == here
    assert fingerprint(2, 8, 12, 6) != here


@pytest.mark.slow
@pytest.mark.parametrize("num_envs", [1, 64])
def test_same_seed_gives_same_bits_over_five_hundred_steps(num_envs):
    first = elsewhere(num_envs, 7, 500)
    assert elsewhere(num_envs, 7, 500) == first
    assert elsewhere(num_envs, 8, 500) != first


def test_a_partial_reset_changes_no_bit_of_the_others():
    env = make(3)
    moves = actions(3, 20)

    def run(reset_at):
        env.reset(seed=4)
        seen = []
        for step, move in enumerate(moves):
            if step == reset_at:
                env.reset(options={"env_idx": torch.tensor([1])})
            seen.append(env.step(move)[0].clone())
        return torch.stack(seen)

    whole, broken = run(None), run(10)
    assert torch.equal(whole[:, [0, 2]], broken[:, [0, 2]])
    assert not torch.equal(whole[10:, 1], broken[10:, 1])
    env.close()


@pytest.mark.slow
def test_memory_stays_where_it_is():
    """At most 16 MiB an environment, and no growth in 100,000 environment steps."""

    def resident():
        pages = Path("/proc/self/statm").read_text().split()[1]
        return int(pages) * os.sysconf("SC_PAGE_SIZE") / 2**20

    before = resident()
    env = ManiSkillVectorEnv(make(64), auto_reset=True)
    env.reset(seed=0)
    moves = actions(64, 200)
    sizes = []
    for _ in range(8):  # 102,400 environment steps; the first quarter fills pools and caches.
        for move in moves:
            env.step(move)
        sizes.append(resident())
    assert (sizes[-1] - before) / 64 < 16
    assert sizes[-1] - sizes[1] < 4, sizes
    env.close()
