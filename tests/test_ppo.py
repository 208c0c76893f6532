"""Laws of a whole training run, on a toy task: learning, logs, exact resume, several processes."""

import csv
import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import pytest
import torch

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.train.checkpoint import (
    find_run,
    load_checkpoint,
    preserved_rng,
    rng_state,
    save_checkpoint,
    set_rng_state,
)
from maniskill_taskgrasp.train.policy import load_policy, policy_env_kwargs
from maniskill_taskgrasp.train.ppo import main, parse_config, train
from maniskill_taskgrasp.train.ppo_config import PPOConfig

TOY_SCRIPT = Path(__file__).with_name("toy_reach.py")
TOY_FLAGS = (
    "--env-id Toy-v0 --num-envs 16 --num-eval-envs 20 --num-steps 10 --num-minibatches 2 "
    "--eval-freq 2 --eval-episodes 20"
)
UPSTREAM_FLAGS = (
    "exp_name total_timesteps seed learning_rate torch_deterministic num_envs cuda num_eval_envs "
    "track partial_reset wandb_project_name eval_partial_reset wandb_entity wandb_group num_steps "
    "capture_video num_eval_steps save_model reconfiguration_freq evaluate "
    "eval_reconfiguration_freq checkpoint control_mode env_id anneal_lr gamma gae_lambda "
    "num_minibatches update_epochs norm_adv clip_coef clip_vloss ent_coef vf_coef max_grad_norm "
    "target_kl reward_scale eval_freq save_train_video_freq finite_horizon_gae env_vectorization "
    "compile cudagraphs"
)


@pytest.fixture(scope="module")
def toy():
    """The module toy_reach; the tests folder is no package."""
    spec = importlib.util.spec_from_file_location("toy_reach", TOY_SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def toy_config(tmp_path):
    """A short run in a temporary folder."""
    return config_of(f"{TOY_FLAGS} --total-timesteps 1600 --exp-name toy --runs-dir {tmp_path}")


@pytest.fixture(scope="module")
def trained(toy, tmp_path_factory):
    """A run that was long enough to learn the toy task."""
    runs_dir = tmp_path_factory.mktemp("runs")
    flags = f"{TOY_FLAGS} --total-timesteps 6400 --exp-name toy --runs-dir {runs_dir}"
    return train(config_of(f"{flags} --eval-freq 20 --learning-rate 1e-3"), toy.factories())


def config_of(flags):
    return parse_config(flags.split())


def weights(path):
    return load_checkpoint(path)["agent"]


def assert_identical(one, other):
    assert one.keys() == other.keys()
    assert all(torch.equal(one[name], other[name]) for name in one)


def toy_process(flags, launcher=""):
    """Start the toy script, or `launcher` with it, in processes with one torch thread each."""
    return subprocess.Popen(
        [sys.executable, *launcher.split(), str(TOY_SCRIPT), *TOY_FLAGS.split(), *flags.split()],
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def finish(process):
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors


# A run --------------------------------------------------------------------------------------


def test_learns_and_leaves_curve_results_and_policy(trained):
    """Success rises; every file that the contract names is there and agrees with the others."""
    with (trained.run_dir / "evaluations.csv").open() as file:
        first, *_, last = csv.DictReader(file)
    assert float(first["success_once"]) < 0.5
    assert float(last["success_once"]) > 0.8
    assert (int(last["step"]), int(last["episodes"])) == (6400, 20)
    assert float(last["success_once_ci95_low"]) < float(last["success_once"])
    with (trained.run_dir / "curve.csv").open() as file:
        assert [int(row["iteration"]) for row in csv.DictReader(file)] == list(range(1, 41))
    report = json.loads((trained.run_dir / "result.json").read_text())
    assert report["evaluation"]["success_once"] == float(last["success_once"])
    assert report["global_step"] == 6400


def test_tensorboard_has_maniskills_tags(trained):
    """Curves of both trainers can be laid over each other."""
    accumulator = pytest.importorskip("tensorboard.backend.event_processing.event_accumulator")
    events = accumulator.EventAccumulator(str(trained.run_dir))
    events.Reload()
    tags = set(events.Tags()["scalars"])
    episode = ("success_once", "success_at_end", "return", "episode_len", "reward")
    expected = {f"{part}/{name}" for part in ("train", "eval") for name in episode}
    losses = "value_loss policy_loss entropy old_approx_kl approx_kl clipfrac explained_variance"
    expected |= {f"losses/{name}" for name in losses.split()}
    times = "step update_time rollout_time rollout_fps"
    expected |= {f"time/{name}" for name in times.split()}
    assert expected | {"charts/learning_rate", "charts/SPS"} <= tags


def test_evaluation_is_the_same_every_time_and_disturbs_nothing(toy, toy_config):
    """Fixed seeds, none of training's, and the generators are left as they were."""
    rare = train(replace(toy_config, eval_freq=100, save_freq=2), toy.factories())
    often = train(replace(toy_config, eval_freq=1, save_freq=2, exp_name="often"), toy.factories())
    assert_identical(
        weights(rare.run_dir / "final_ckpt.pt"), weights(often.run_dir / "final_ckpt.pt")
    )
    assert rare.evaluation == often.evaluation
    with (often.run_dir / "evaluations.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 11  # Before, after each of 10; eval_freq 1 works.


@pytest.mark.parametrize(
    "changes",
    [
        {"finite_horizon_gae": True, "clip_vloss": True, "anneal_lr": True, "target_kl": 0.001},
        {"partial_reset": False, "norm_obs": False, "ent_coef": 0.01, "norm_adv": False},
        {"num_eval_steps": 2, "eval_reconfiguration_freq": None, "save_model": False},
    ],
)
def test_other_settings_run(toy, toy_config, changes):
    """Every flag that changes the algorithm trains to the end with finite weights."""
    result = train(replace(toy_config, **changes), toy.factories())
    assert result.evaluation.count == 20
    assert (result.run_dir / "final_ckpt.pt").is_file() == changes.get("save_model", True)
    if changes.get("save_model", True):
        load_checkpoint(result.run_dir / "final_ckpt.pt")  # Raises on weights that are not finite.
    if "num_eval_steps" in changes:
        assert set(result.evaluation.episodes["episode_len"]) == {2.0}


def test_a_taken_run_name_is_refused(toy, toy_config):
    """Nothing is overwritten."""
    train(toy_config, toy.factories())
    with pytest.raises(InputError, match="--resume toy"):
        train(toy_config, toy.factories())


# Resume -------------------------------------------------------------------------------------


def test_killed_and_resumed_run_ends_bit_identical(toy, tmp_path):
    """kill -9 between checkpoints; weights, optimiser, normaliser and curve end as without it."""
    flags = f"--total-timesteps 2400 --runs-dir {tmp_path}"
    killed = toy_process(f"{flags} --exp-name killed")
    curve = tmp_path / "killed" / "curve.csv"
    deadline = time.monotonic() + 120
    while not (curve.is_file() and len(curve.read_text().splitlines()) > 7):
        assert killed.poll() is None, killed.stderr.read()
        assert time.monotonic() < deadline
        time.sleep(0.01)
    killed.send_signal(signal.SIGKILL)
    killed.communicate()
    assert not (tmp_path / "killed" / "final_ckpt.pt").exists()
    train(config_of(f"{TOY_FLAGS} {flags} --exp-name whole"), toy.factories())
    finish(toy_process(f"--resume killed --runs-dir {tmp_path}"))
    one, other = (load_checkpoint(tmp_path / run / "final_ckpt.pt") for run in ("whole", "killed"))
    assert_identical(one["agent"], other["agent"])
    for name in ("mean", "sum_squares"):
        assert torch.equal(one["normalizer"][name], other["normalizer"][name])
    for key, state in one["optimizer"]["state"].items():
        assert torch.equal(state["exp_avg_sq"], other["optimizer"]["state"][key]["exp_avg_sq"])
    timed = {"charts/SPS", "time/update_time", "time/rollout_time", "time/rollout_fps"}
    tables = []
    for run in ("whole", "killed"):
        with (tmp_path / run / "curve.csv").open() as file:
            rows = csv.DictReader(file)
            tables.append([{k: v for k, v in row.items() if k not in timed} for row in rows])
    assert tables[0] == tables[1]


def test_resume_continues_a_finished_run_with_a_larger_budget(toy, toy_config):
    """The old end becomes a checkpoint on the way, and its curve goes on."""
    run_dir = train(toy_config, toy.factories()).run_dir
    more = [
        "--resume",
        str(run_dir),
        "--runs-dir",
        toy_config.runs_dir,
        "--total-timesteps",
        "2400",
    ]
    train(parse_config(more), toy.factories())
    assert load_checkpoint(run_dir / "final_ckpt.pt")["iteration"] == 15
    assert load_checkpoint(run_dir / "ckpt_10.pt")["iteration"] == 10
    with (run_dir / "curve.csv").open() as file:
        assert [int(row["iteration"]) for row in csv.DictReader(file)] == list(range(1, 16))


def test_resume_refuses_other_settings_and_missing_runs(trained, tmp_path):
    """A resumed run is the same run; each refusal says what would do."""
    run_dir = trained.run_dir
    with pytest.raises(InputError, match="--gamma"):
        config_of(f"--resume {run_dir} --gamma 0.5")
    with pytest.raises(InputError, match="no such run"):
        find_run("nosuch", str(tmp_path))
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no checkpoint yet"):
        find_run("empty", str(tmp_path))


# Processes ----------------------------------------------------------------------------------


PAIR_LAUNCHER = "-m torch.distributed.run --standalone --nproc-per-node 2"


def test_two_processes_share_gradients_and_one_log(toy, tmp_path):
    """torchrun: one log of all samples, a generator state each; resumed by as many only."""
    flags = f"--exp-name pair --total-timesteps 800 --runs-dir {tmp_path}"
    finish(toy_process(flags, PAIR_LAUNCHER))
    run_dir = tmp_path / "pair"
    final = load_checkpoint(run_dir / "final_ckpt.pt")
    first, second = (state["torch"] for state in final["rng"])
    assert not torch.equal(first, second)
    assert final["normalizer"]["count"] == 800
    assert len(list(run_dir.glob("events.*"))) <= 1
    report = json.loads((run_dir / "result.json").read_text())
    assert (report["processes"], report["evaluation"]["episodes"]) == (2, 20)
    with pytest.raises(InputError, match="--nproc-per-node 2"):
        train(config_of(f"--resume {run_dir}"), toy.factories())


@pytest.mark.slow
def test_two_processes_resume_bit_identical(tmp_path):
    """As with one process: the run that went on from a checkpoint ends as the one that did not."""
    finish(
        toy_process(f"--exp-name pair --runs-dir {tmp_path} --total-timesteps 1600", PAIR_LAUNCHER)
    )
    run_dir = tmp_path / "pair"
    (run_dir / "final_ckpt.pt").rename(tmp_path / "expected.pt")
    for iteration in (6, 8):
        (run_dir / f"ckpt_{iteration}.pt").unlink()
    finish(toy_process(f"--resume pair --runs-dir {tmp_path}", PAIR_LAUNCHER))
    assert_identical(weights(tmp_path / "expected.pt"), weights(run_dir / "final_ckpt.pt"))


# Files --------------------------------------------------------------------------------------


def test_generator_states_survive_a_file(tmp_path):
    """torch, numpy and python go on with the same numbers after a save and a load."""
    import random

    import numpy as np

    def draw():
        return torch.rand(3).tolist(), np.random.rand(3).tolist(), random.random(), random.gauss()  # noqa: NPY002

    state = rng_state()
    torch.save(state, tmp_path / "rng.pt")
    first = draw()
    set_rng_state(torch.load(tmp_path / "rng.pt", weights_only=True))
    with preserved_rng():
        assert draw() == first
    assert draw() == first


def test_bad_policy_files_are_refused_in_one_line(trained, tmp_path):
    """Missing, truncated, foreign, empty and diverged files: InputError, never a traceback."""
    path = trained.run_dir / "final_ckpt.pt"
    whole = path.read_bytes()
    agent = weights(path)
    bad = tmp_path / "bad"
    bad.mkdir()
    (bad / "truncated.pt").write_bytes(whole[: len(whole) // 2])
    (bad / "text.pt").write_text("not a checkpoint")
    (bad / "empty.pt").write_bytes(b"")
    torch.save({"state": 1}, bad / "foreign.pt")
    torch.save([1, 2], bad / "list.pt")
    torch.save({"agent": Path("evil")}, bad / "pickle.pt")
    agent["actor_logstd"][0, 0] = float("nan")
    save_checkpoint(bad / "nan.pt", {"agent": agent, "config": {}})
    for name in ("missing", "truncated", "text", "empty", "foreign", "list", "pickle", "nan"):
        with pytest.raises(InputError) as caught:
            load_checkpoint(bad / f"{name}.pt")
        assert "\n" not in str(caught.value)


class SpacesOnly:
    """What `load_policy` needs to know of an environment."""

    device = torch.device("cpu")

    def __init__(self, obs_dim, action_dim):
        self.unwrapped = self
        self.single_observation_space = gym.spaces.Box(-1, 1, (obs_dim,))
        self.single_action_space = gym.spaces.Box(0, 1, (action_dim,))


def test_loaded_policy_acts_as_the_trained_one(toy, trained):
    """Deterministic, in the box, with the normaliser; it solves the task it was trained for."""
    path = trained.run_dir / "final_ckpt.pt"
    env = toy.ToyReach(200)
    policy = load_policy(path, SpacesOnly(3, 2))
    obs, _ = env.reset(seed=list(range(200)))
    action = policy(obs)
    assert torch.equal(action, policy(obs))
    assert ((action - env.target).abs().amax(1) < toy.TOLERANCE).float().mean() > 0.8
    assert policy_env_kwargs(path) == {}


def test_bare_weights_act_and_misfits_are_refused(toy, toy_config, tmp_path):
    """ManiSkill's files load too; a policy for other sizes says what it was trained with."""
    path = train(replace(toy_config, obs="paper"), toy.factories()).run_dir / "final_ckpt.pt"
    torch.save(weights(path), tmp_path / "bare.pt")
    obs = torch.rand(4, 3)
    assert load_policy(tmp_path / "bare.pt", SpacesOnly(3, 2))(obs).shape == (4, 2)
    assert policy_env_kwargs(path) == {"obs": "paper"}
    with pytest.raises(InputError, match=r"3 observations to 2 actions.*has 7 and 2.*obs=paper"):
        load_policy(path, SpacesOnly(7, 2))


# Command line -------------------------------------------------------------------------------


def test_flags_are_a_superset_of_maniskills():
    """Every upstream flag parses, with underscores and with hyphens, booleans with --no-."""
    assert set(UPSTREAM_FLAGS.split()) <= set(PPOConfig.__dataclass_fields__)
    one = config_of("--env_id PickCube-v1 --num_envs 3 --no-norm_adv --anneal_lr")
    other = config_of("--env-id PickCube-v1 --num-envs 3 --no-norm-adv --anneal-lr")
    assert one == other
    assert (one.num_envs, one.norm_adv, one.anneal_lr) == (3, False, True)


def test_flags_beside_a_preset_win():
    """--preset is where the settings start from."""
    config = config_of("--preset paper --gamma 0.8 --topology a b")
    assert (config.gamma, config.learning_rate, config.topology) == (0.8, 2.5e-4, ("a", "b"))


def test_a_users_mistake_is_one_line_and_exit_2(monkeypatch, capsys):
    """No traceback."""
    monkeypatch.setattr(sys, "argv", ["ppo.py", "--resume", "nosuch"])
    with pytest.raises(SystemExit) as caught:
        main()
    assert caught.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1
