"""Laws of num_envs > 1 on the CPU: same bits as alone, no crosstalk, ManiSkill's structs work."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import sapien
import torch
from mani_skill.agents.base_agent import BaseAgent
from mani_skill.agents.controllers import PDJointPosControllerConfig
from mani_skill.envs.sapien_env import BaseEnv
from mani_skill.utils.structs import Actor, Link, Pose
from mani_skill.utils.structs.base import BaseStruct
from mani_skill.utils.structs.types import SimConfig
from mani_skill.vector.wrappers.gymnasium import ManiSkillVectorEnv

from maniskill_taskgrasp.tasks.cpu_batch import CpuBatchMixin, mixin
from maniskill_taskgrasp.tasks.cpu_batch.workers import RemoteGroup, default_processes
from maniskill_taskgrasp.tasks.rendering import rendering_available

STEPS = 20
WEIGHT = 0.3 * 9.81  # [N] of the block.

PUSHER = """<robot name="pusher">
  <link name="base"/>
  <joint name="swing" type="revolute"><parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.3"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="50"/></joint>
  <link name="upper"><inertial><mass value="0.5"/>
      <inertia ixx=".002" iyy=".002" izz=".002" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="reach" type="prismatic"><parent link="upper"/><child link="rod"/>
    <origin xyz="0.1 0 -0.2"/><axis xyz="1 0 0"/><limit lower="0" upper="0.4" effort="50"/></joint>
  <link name="rod"><inertial><mass value="0.2"/>
      <inertia ixx=".001" iyy=".001" izz=".001" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.1 0.05 0.1"/></geometry></collision></link>
</robot>"""


class Pusher(BaseAgent):
    """Two joints and a rod that pushes things about; nothing of it is drawn."""

    uid = "test_pusher"

    @property
    def _controller_configs(self):
        joints = ["swing", "reach"]
        stiff = PDJointPosControllerConfig(joints, -1, 1, 200, 20, 50, use_delta=True)
        soft = PDJointPosControllerConfig(joints, -1, 1, 20, 20, 50, use_delta=True)
        return {"stiff": stiff, "soft": soft}


class PushEnv(CpuBatchMixin, BaseEnv):
    """A pusher among a block and, in turn, a ball or a box merged under one name."""

    agent: Pusher

    def __init__(self, folder, **kwargs):
        (folder / "pusher.urdf").write_text(PUSHER)
        Pusher.urdf_path = str(folder / "pusher.urdf")
        super().__init__(robot_uids=Pusher, **kwargs)

    @property
    def _default_sim_config(self):
        return SimConfig(sim_freq=100, control_freq=20)

    def _load_agent(self, options):
        super()._load_agent(options, sapien.Pose([-0.5, 0, 0]))

    def _load_scene(self, options):
        ground = self.scene.create_actor_builder()
        ground.add_plane_collision(sapien.Pose(q=[0.7071068, 0, -0.7071068, 0]))
        ground.initial_pose = sapien.Pose()
        self.ground = ground.build_static("ground")
        builder = self.scene.create_actor_builder()
        builder.add_box_collision(half_size=[0.05] * 3)
        builder.initial_pose = sapien.Pose([0, 0, 0.05])
        self.block = builder.build("block")
        self.block.mass = 0.3
        toys = []
        for env in range(self.num_envs):
            builder = self.scene.create_actor_builder()
            if env % 2:
                builder.add_sphere_collision(radius=0.04)
            else:
                builder.add_box_collision(half_size=[0.04, 0.03, 0.04])
            builder.initial_pose = sapien.Pose([0, 0.3, 0.04])
            builder.set_scene_idxs([env])
            toys.append(builder.build(f"toy-{env}"))
            self.remove_from_state_dict_registry(toys[-1])
        self.toy = Actor.merge(toys, "toy")
        self.add_to_state_dict_registry(self.toy)

    def _initialize_episode(self, env_idx, options):
        rngs = self._batched_episode_rng[env_idx]
        n = len(env_idx)
        place = torch.tensor(rngs.uniform(-0.04, 0.04, size=(4,)), dtype=torch.float32)
        ones = torch.ones(n)
        block = torch.stack([place.view(n, 4)[:, 0], place.view(n, 4)[:, 1], 0.05 * ones], 1)
        toy = torch.stack([place.view(n, 4)[:, 2], 0.3 + place.view(n, 4)[:, 3], 0.04 * ones], 1)
        self.block.set_pose(Pose.create_from_pq(block))
        self.toy.set_pose(Pose.create_from_pq(toy))
        self.agent.reset(torch.zeros(n, 2))
        self.agent.robot.set_pose(sapien.Pose([-0.5, 0, 0]))

    def evaluate(self):
        rod = self.agent.robot.links_map["rod"]
        return {
            "push": self.scene.get_pairwise_contact_forces(rod, self.block),
            "net": self.block.get_net_contact_forces(),
            "success": self.block.pose.p[:, 0] > 0.25,
        }

    def _get_obs_extra(self, info):
        rod = self.agent.robot.links_map["rod"]
        return {
            "block": self.block.pose.raw_pose,
            "toy": self.toy.pose.raw_pose,
            "rod": rod.pose.raw_pose,
            "spin": self.block.angular_velocity,
            "push": info["push"],
        }

    def compute_normalized_dense_reward(self, obs, action, info):
        return self.block.pose.p[:, 0]


@pytest.fixture
def make(tmp_path):
    """Makes environments and closes them: make(num_envs, processes, **kwargs)."""
    made = []

    def build(num_envs, processes=1, **kwargs):
        config = {"scene_config": {"cpu_workers": processes if num_envs > 1 else 0}}
        kwargs = {"obs_mode": "state", "sim_config": config, "render_backend": "none", **kwargs}
        made.append(PushEnv(tmp_path, num_envs=num_envs, **kwargs))
        return made[-1]

    yield build
    for env in made:
        env.close()


def actions(num_envs, steps=STEPS, seed=0):
    """(steps, num_envs, 2) that swing about and reach out for the block."""
    generator = torch.Generator().manual_seed(seed)
    action = torch.rand(steps, num_envs, 2, generator=generator) * 0.4 - 0.2
    action[..., 1] += 0.25
    return action


def roll(env, moves):
    """(steps, num_envs, observations) of these actions."""
    return torch.stack([env.step(move)[0] for move in moves])


def copied(state):
    return {kind: {name: v.clone() for name, v in of.items()} for kind, of in state.items()}


def test_trajectories_do_not_depend_on_the_number_of_environments(make):
    """Environment i moves by the same bits in a batch of 5, a batch of 3, and ManiSkill's own
    single-environment path, whatever the others do."""
    moves = actions(5)
    five, three, one = make(5), make(3), make(1)
    five.reset(seed=[1, 2, 3, 4, 5])
    three.reset(seed=[1, 2, 3])
    expected = roll(five, moves)
    assert expected[..., -3:].abs().max() > 1.0  # [N] The rod does push the block.
    assert torch.equal(roll(three, moves[:, :3])[:, 2], expected[:, 2])
    one.reset(seed=3)
    # Env 2 has a box for a toy as env 0 has. Obs differ in the last bits of poses that SAPIEN
    # reads out another way; motion that diverged would show as more.
    alone = roll(one, moves[:, 2:3])[:, 0]
    torch.testing.assert_close(alone, expected[:, 2], atol=2e-5, rtol=1e-4)


def test_same_seed_gives_same_bits_whatever_came_before(make):
    """An episode depends on its seed alone, not on the episodes before it."""
    env, moves = make(4), actions(4)
    env.reset(seed=7)
    first = roll(env, moves)
    env.reset(seed=8)
    other = roll(env, actions(4, seed=1)[:11])
    env.reset(options={"env_idx": torch.tensor([1, 2])})
    roll(env, moves[:5])
    env.reset(seed=7)
    assert torch.equal(roll(env, moves), first)
    assert not torch.equal(other, first[:11])


def test_partial_reset_leaves_the_others_alone(make):
    """Resetting some environments changes no bit of the others' trajectories."""
    env, moves = make(6), actions(6)
    env.reset(seed=3)
    whole = roll(env, moves)
    env.reset(seed=3)
    roll(env, moves[:10])
    env.reset(options={"env_idx": torch.tensor([0, 4])})
    assert env.elapsed_steps.tolist() == [0, 10, 10, 10, 0, 10]
    rest = roll(env, moves[10:])
    assert torch.equal(rest[:, [1, 2, 3, 5]], whole[10:, [1, 2, 3, 5]])
    assert not torch.equal(rest[:, [0, 4]], whole[10:, [0, 4]])


def test_processes_do_not_change_a_bit(make):
    """Physics shared among processes gives the trajectories, forces and velocities of one."""
    seen = []
    for processes in (1, 2, 3):
        env, moves = make(5, processes), actions(5)
        env.reset(seed=2)
        before = roll(env, moves[:8])
        env.reset(options={"env_idx": torch.tensor([1, 4])})
        after = roll(env, moves[8:])
        rod = env.agent.robot.links_map["rod"]
        velocity = torch.cat([rod.linear_velocity, rod.angular_velocity, env.agent.robot.qacc], 1)
        state = copied(env.get_state_dict())
        env.set_state_dict(state)
        again = roll(env, moves[:3])
        remote = sum(isinstance(s.group, RemoteGroup) for s in env.scene.px._shares)
        assert remote == processes - 1
        seen.append([before, after, velocity, again, env.evaluate()["net"].clone()])
    for others in seen[1:]:
        assert all(torch.equal(a, b) for a, b in zip(seen[0], others, strict=True))


def test_state_goes_out_and_in(make):
    """A state read, set and read again is the same; two continuations from it are, too."""
    env, moves = make(3), actions(3)
    env.reset(seed=1)
    roll(env, moves[:9])
    state = copied(env.get_state_dict())
    flat = env.get_state().clone()
    roll(env, moves[9:])
    env.set_state_dict(state)
    torch.testing.assert_close(env.get_state(), flat, atol=1e-6, rtol=0)
    first = roll(env, moves)
    env.reset(seed=9)
    roll(env, moves[:4])
    env.set_state(flat)
    assert torch.equal(roll(env, moves), first)


def test_vector_env_resets_by_itself(make):
    """ManiSkillVectorEnv ends and restarts the environments that are done, and only those."""
    env = make(4)
    vector = ManiSkillVectorEnv(env, auto_reset=True, record_metrics=True)
    vector.reset(seed=0)
    state = copied(env.get_state_dict())
    state["actors"]["block"][2, 0] = 0.6  # Past the goal line.
    env.set_state_dict(state)
    obs, _, terminated, _, info = vector.step(torch.zeros(4, 2))
    assert terminated.tolist() == [False, False, True, False]
    assert env.elapsed_steps.tolist() == [1, 1, 0, 1]
    assert info["final_observation"].shape == obs.shape
    assert abs(float(env.block.pose.p[2, 0])) <= 0.04


def test_contact_queries_equal_a_sum_over_the_contacts(make):
    """Pair and net queries agree with SAPIEN's own contact list, and a block at rest weighs m g."""
    env = make(4)
    env.reset(seed=0)
    for move in actions(4, 12):
        env.step(move)
        rod = env.agent.robot.links_map["rod"]
        pair, net = torch.zeros(4, 3), torch.zeros(4, 3)
        for i, scene in enumerate(env.scene.sub_scenes):
            for contact in scene.physx_system.get_contacts():
                first, second = contact.bodies
                impulse = torch.tensor(np.sum([p.impulse for p in contact.points], axis=0))
                for a, b, sign in ((first, second, 1), (second, first, -1)):
                    if a is env.block._bodies[i]:
                        net[i] += sign * impulse
                    if a is rod._bodies[i] and b is env.block._bodies[i]:
                        pair[i] += sign * impulse
        info = env.evaluate()
        torch.testing.assert_close(info["push"], pair * 100, atol=1e-4, rtol=1e-5)
        torch.testing.assert_close(info["net"], net * 100, atol=1e-4, rtol=1e-5)
    env.reset(seed=0)
    assert env.evaluate()["net"].abs().max() == 0  # No contact outlives its episode.
    for _ in range(10):
        env.step(torch.zeros(4, 2))
    expected = torch.tensor([0.0, 0.0, WEIGHT]).expand(4, 3)
    torch.testing.assert_close(env.evaluate()["net"], expected, atol=0.02, rtol=0)
    ground = env.scene.get_pairwise_contact_forces(env.block, env.ground)
    torch.testing.assert_close(ground, expected, atol=0.02, rtol=0)


@pytest.mark.parametrize("num_envs", [1, 3])
@pytest.mark.parametrize(
    "spoil",
    [
        lambda a: a.fill_(float("nan")),
        lambda a: a.index_fill_(1, torch.tensor([1]), float("inf")),
        lambda a: a[:, :1],
        lambda a: torch.cat([a, a]),
        lambda a: a.numpy()[0, :1],
    ],
)
def test_bad_actions_are_refused_before_anything_moves(make, num_envs, spoil):
    """A non-finite or wrongly shaped action raises ValueError; the next good one works."""
    env = make(num_envs)
    env.reset(seed=0)
    before = env.get_state().clone()
    with pytest.raises(ValueError, match="action"):
        env.step(spoil(torch.zeros(num_envs, 2)))
    assert torch.equal(env.get_state(), before) and int(env.elapsed_steps[0]) == 0
    far, edge = torch.full((num_envs, 2), 9.0), torch.ones(num_envs, 2)
    moved = env.step(far)[0].clone()
    env.reset(seed=0)
    torch.testing.assert_close(env.step(edge)[0], moved, atol=1e-5, rtol=0)  # Clipped.


def test_setters_reach_the_environments_they_name(make):
    """Poses, joint states, drive targets and forces arrive where the mask says, only there."""
    env = make(4)
    env.reset(seed=0)
    robot, px = env.agent.robot, env.scene.px
    others, chosen = [0, 2, 3], torch.tensor([1])
    before = env.get_state().clone()
    env.scene._reset_mask[:] = False
    env.scene._reset_mask[chosen] = True
    robot.set_qpos(torch.tensor([[0.3, 0.2]]))
    robot.set_qvel(torch.tensor([[0.5, 0.1]]))
    robot.set_root_pose(Pose.create_from_pq(torch.tensor([[-0.4, 0.1, 0.0]])))
    robot.set_joint_drive_targets(torch.tensor([[0.3, 0.2]]), robot.active_joints)
    env.toy.set_linear_velocity(torch.tensor([[0.0, 0.0, 2.0]]))
    env.scene._reset_mask[:] = True
    env.scene._gpu_apply_all()
    env.scene._gpu_fetch_all()
    assert torch.equal(env.get_state()[others], before[others])
    art = robot._objs[1]
    np.testing.assert_allclose(art.qpos, [0.3, 0.2], atol=1e-6)
    np.testing.assert_allclose(art.qvel, [0.5, 0.1], atol=1e-6)
    np.testing.assert_allclose(art.root_pose.p, [-0.4, 0.1, 0.0], atol=1e-6)
    np.testing.assert_allclose(env.toy._bodies[1].linear_velocity, [0, 0, 2])
    assert torch.allclose(robot.drive_targets[1], torch.tensor([0.3, 0.2]))
    px.step()
    env.scene._gpu_fetch_all()
    np.testing.assert_allclose([float(j.drive_target[0]) for j in art.active_joints], [0.3, 0.2])
    assert env.toy.pose.p[1, 2] > 0.055 and env.toy.pose.p[0, 2] < 0.045
    env.block.apply_force(torch.tensor([[0.0, 0, 0], [0, 0, 0], [0, 0, 300.0], [0, 0, 0]]))
    px.step()
    env.scene._gpu_fetch_all()
    rise = env.block.linear_velocity[:, 2]
    assert abs(float(rise[2]) - (300 - WEIGHT) / 0.3 * 0.01) < 0.05
    assert rise[[0, 1, 3]].abs().max() < 0.05


def test_link_velocities_are_right_when_asked_for(make):
    """A link's velocity is what SAPIEN says of it, for merged links as well."""
    env = make(3)
    env.reset(seed=0)
    roll(env, actions(3)[:4])
    links = [env.agent.robot.links_map[name] for name in ("upper", "rod")]
    for link in [*links, env.agent.robot.root]:
        own = torch.tensor(np.array([b.linear_velocity for b in link._bodies]))
        torch.testing.assert_close(link.linear_velocity, own)
        torch.testing.assert_close(
            link.angular_velocity,
            torch.tensor(np.array([b.angular_velocity for b in link._bodies])),
        )
    assert links[1].linear_velocity.abs().max() > 0.01


def test_properties_are_set_before_the_first_step_only(make):
    """Mass counts per environment; ManiSkill refuses to set it once the buffers exist."""
    env = make(2)
    assert env.block.mass.tolist() == pytest.approx([0.3, 0.3])
    with pytest.raises(AssertionError):
        env.block.mass = 1.0


def test_structs_made_later_know_their_rows_and_the_patch_is_gone(make, monkeypatch):
    """Links merged at reset work; ManiSkill's classes are left as they were, also on failure."""
    original = BaseStruct.__post_init__
    env = make(2)
    assert BaseStruct.__post_init__ is original
    inside = []

    def merge(self, env_idx, options):
        links = self.agent.robot.links
        inside.append(Link.merge([links[1], links[2]], "both"))
        raise ZeroDivisionError

    monkeypatch.setattr(PushEnv, "_initialize_episode", merge)
    with pytest.raises(ZeroDivisionError):
        env.reset(seed=0)
    assert BaseStruct.__post_init__ is original
    assert inside[0].pose.p.shape == (4, 3)
    assert torch.equal(inside[0].pose.p[2:], env.agent.robot.links[2].pose.p)


def test_other_control_mode_takes_effect_in_every_process(make):
    """A controller made after stepping began sets its drives where the physics runs."""
    ends = []
    for processes in (1, 2):
        env = make(4, processes)
        env.reset(seed=0)
        roll(env, actions(4)[:3])
        for move in actions(4, 6, seed=5):
            env.step({"control_mode": "soft", "action": move})
        ends.append(env.agent.robot.qpos.clone())
    torch.testing.assert_close(ends[0], ends[1], atol=2e-3, rtol=0)
    assert env.agent.robot.active_joints[0].stiffness.tolist() == [20] * 4


def test_process_failures_are_told(make):
    """An error in another process is raised here; a dead one is noticed, a closed one gone."""
    env = make(4, processes=2)
    env.reset(seed=0)
    env.step(torch.zeros(4, 2))
    remote = env.scene.px._shares[1].group
    remote.post("write_qpos", [99])
    with pytest.raises(RuntimeError, match="IndexError"):
        remote.wait()
    with pytest.raises(RuntimeError, match="cpu_workers=1"):
        env.scene.px.get_contacts()
    env.close()
    with pytest.raises(ProcessLookupError):
        os.kill(remote._pid, 0)


def test_many_environments_stay_small(make):
    """256 environments step, and cost at most 16 MiB each."""

    def resident():
        with open("/proc/self/statm") as file:  # noqa: PTH123
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

    before = resident()
    env = make(256)
    obs, _ = env.reset(seed=0)
    assert env.step(torch.zeros(256, 2))[0].shape == obs.shape
    assert (resident() - before) / 256 < 16


def test_back_end_is_chosen_by_what_there_is(make, monkeypatch):
    """auto: one environment is plain CPU, more are CUDA where there is one, else the batch."""
    assert make(1).backend.sim_backend == "physx_cpu"
    assert make(1, sim_backend=mixin.BATCHED_BACKEND).gpu_sim_enabled
    assert make(2).backend.sim_backend == mixin.BATCHED_BACKEND and make(2).gpu_sim_enabled
    asked = []
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(BaseEnv, "__init__", lambda self, **kwargs: asked.append(kwargs))
    make(2)
    assert asked[0]["sim_backend"] == "physx_cuda"


def test_cameras_and_unknown_versions_are_refused(make, monkeypatch):
    """What the batched CPU cannot do it says at once."""
    with pytest.raises(ValueError, match="num_envs=1"):
        make(2, obs_mode="rgb")
    with pytest.raises(ValueError, match="num_envs=1"):
        make(2, render_mode="rgb_array").render()
    monkeypatch.setattr(mixin, "version", lambda _: "4.0.0")
    with pytest.raises(RuntimeError, match=r"4\.0\.0"):
        make(2)
    make(1)


def test_processes_are_used_where_they_pay():
    """One process for few environments, never more than cores."""
    assert default_processes(2) == 1
    assert 1 <= default_processes(10**6) <= os.cpu_count()


def test_works_without_a_rendering_device(tmp_path):
    """With no Vulkan driver at all, one and many environments step; cameras are refused."""
    script = f"""
import pathlib, sys, torch
sys.path.insert(0, {str(Path(__file__).parent)!r})
from test_cpu_batch import PushEnv
for n in (1, 3):
    env = PushEnv(pathlib.Path({str(tmp_path)!r}), num_envs=n, obs_mode="state")
    env.reset(seed=0)
    assert env.step(torch.zeros(n, 2))[0].isfinite().all()
try:
    PushEnv(pathlib.Path({str(tmp_path)!r}), num_envs=1, obs_mode="rgb")
except ValueError as error:
    assert "Vulkan" in str(error)
else:
    raise AssertionError
"""
    environment = {**os.environ, "VK_DRIVER_FILES": "/dev/null", "VK_ICD_FILENAMES": "/dev/null"}
    run = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert "Rendering is off" in run.stdout + run.stderr


@pytest.mark.skipif(not rendering_available(), reason="PickCube has materials, which need Vulkan")
def test_stock_task_runs_as_it_is():
    """ManiSkill's PickCube moves in a batch as it does alone: 1e-4 m over 20 steps."""
    from mani_skill.envs.tasks.tabletop.pick_cube import PickCubeEnv

    class BatchedPickCube(CpuBatchMixin, PickCubeEnv):
        pass

    many = BatchedPickCube(num_envs=4, obs_mode="state_dict")
    many.reset(seed=[0, 1, 2, 3])
    one = BatchedPickCube(num_envs=1, obs_mode="state_dict", render_backend="none")
    state = copied(many.get_state_dict())
    moves = torch.rand(STEPS, 4, 8, generator=torch.Generator().manual_seed(0)) * 2 - 1
    cubes = [(many.step(move), many.cube.pose.p.clone())[1] for move in moves]
    hands = many.agent.tcp.pose.p
    for i in range(4):
        one.reset(seed=i)
        one.set_state_dict(
            {kind: {name: v[i : i + 1] for name, v in of.items()} for kind, of in state.items()}
        )
        for move, cube in zip(moves, cubes, strict=True):
            one.step(move[i : i + 1])
            assert (one.cube.pose.p[0] - cube[i]).norm() < 1e-4
        assert (one.agent.tcp.pose.p[0] - hands[i]).norm() < 1e-4
