"""Laws of the trainer on real ManiSkill tasks on a CPU: exact resume, flags, refusals."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
import torch

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.train.checkpoint import load_checkpoint
from maniskill_taskgrasp.train.environments import derived_seeds, make_env
from maniskill_taskgrasp.train.policy import load_policy, policy_env_kwargs
from maniskill_taskgrasp.train.ppo import parse_config, train

pytestmark = pytest.mark.filterwarnings("ignore")
SCRIPT = Path(__file__).resolve().parents[1] / "train" / "ppo.py"
GRASP_FLAGS = (
    "--env-id TaskGrasp-v0 --num-envs 8 --num-steps 60 --num-minibatches 4 --total-timesteps 2880 "
    "--num-eval-envs 4 --eval-episodes 4 --eval-freq 4 --save-freq 2 --no-capture-video"
)
STOCK_FLAGS = "--env-id PickCube-v1 --no-capture-video --num-steps 60 --num-minibatches 4"


def config_of(flags):
    return parse_config(flags.split())


@pytest.fixture(scope="module")
def stock_run(tmp_path_factory):
    """240 steps of PickCube-v1 with checkpoints, evaluated between them."""
    runs_dir = tmp_path_factory.mktemp("runs")
    flags = f"{STOCK_FLAGS} --total-timesteps 240 --eval-episodes 1 --eval-freq 3 --save-freq 2"
    return train(config_of(f"{flags} --exp-name whole --runs-dir {runs_dir}")).run_dir


def test_resumed_physics_follows_the_uninterrupted_run(stock_run, tmp_path):
    """PhysX's caches do not matter: a run taken up from a checkpoint ends with the same bits."""
    resumed = tmp_path / "resumed"
    resumed.mkdir()
    shutil.copy(stock_run / "ckpt_2.pt", resumed)
    train(config_of(f"--resume {resumed}"))
    one, other = (load_checkpoint(run / "final_ckpt.pt") for run in (stock_run, resumed))
    assert one["iteration"] == other["iteration"] == 4
    assert all(torch.equal(one["agent"][name], other["agent"][name]) for name in one["agent"])


@pytest.mark.slow
def test_killed_taskgrasp_run_resumes_bit_identical(tmp_path):
    """kill -9 in the middle of batched grasping; final weights as without it."""

    def start(flags):
        return subprocess.Popen(
            [sys.executable, str(SCRIPT), *flags.split(), "--runs-dir", str(tmp_path)],
            env=os.environ | {"OMP_NUM_THREADS": "1"},
            stderr=subprocess.DEVNULL,
        )

    killed = start(f"{GRASP_FLAGS} --exp-name killed")
    while not (tmp_path / "killed" / "ckpt_2.pt").is_file():
        assert killed.poll() is None
        time.sleep(0.1)
    time.sleep(1)
    killed.kill()
    killed.wait()
    assert not (tmp_path / "killed" / "final_ckpt.pt").exists()
    assert start(f"{GRASP_FLAGS} --exp-name whole").wait() == 0
    assert start("--resume killed").wait() == 0
    one, other = (load_checkpoint(tmp_path / run / "final_ckpt.pt") for run in ("whole", "killed"))
    assert all(torch.equal(one["agent"][name], other["agent"][name]) for name in one["agent"])


def test_a_stock_policy_loads_and_acts(stock_run):
    """The checkpoint becomes a policy whose actions the task takes."""
    path = stock_run / "final_ckpt.pt"
    env = make_env(config_of("--env-id PickCube-v1"), 1, "cpu", **policy_env_kwargs(path))
    policy = load_policy(path, env)
    obs, _ = env.reset(seed=0)
    action = policy(obs)
    assert env.action_space.contains(action[0].numpy())
    env.step(action)
    env.close()


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ("--env-id PickCube-v1 --num-envs 8 --num-minibatches 2", "--env-vectorization cpu"),
        ("--env-id PickCubes-v1", "PickCube-v1"),
        ("--env-id PickCube-v1 --noise hard", "has no --noise"),
        ("--env-id PickCube-v1 --control-mode nosuch", "pd_joint_delta_pos"),
        ("--env-id PickCube-v1 --reward-mode nosuch", "nosuch"),
        ("--env-id TaskGrasp-v0 --noise nosuch", "hard"),
        ("--env-id TaskGrasp-v0 --topology nosuch", "nosuch"),
        ("--env-id PickCube-v1 --sim-backend nosuch", "physx_cuda"),
        (
            "--env-id TaskGrasp-v0 --partial-reset --reconfiguration-freq 1",
            "--no-partial-reset",
        ),
    ],
)
def test_refusals_are_one_line_and_leave_nothing(flags, message, tmp_path):
    """What came and what would do; no empty run folder stays behind."""
    with pytest.raises(InputError, match=message) as caught:
        train(config_of(f"{flags} --runs-dir {tmp_path}"))
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_seeds_of_streams_processes_and_rebuilds_differ():
    """No two environments of a run ever share a seed."""
    keys = [(stream, rank, index) for stream in range(3) for rank in range(3) for index in range(9)]
    seeds = [seed for key in keys for seed in derived_seeds(1, *key, 64)]
    assert len(set(seeds)) == len(seeds)
    assert derived_seeds(1, 0, 0, 0, 4) == derived_seeds(1, 0, 0, 0, 8)[:4]
    assert derived_seeds(2, 0, 0, 0, 4) != derived_seeds(1, 0, 0, 0, 4)
