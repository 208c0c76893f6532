"""TaskGrasp-v0: close the hand in the topology that was asked for until the object is lifted."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from gymnasium.utils.seeding import np_random
from mani_skill.envs.sapien_env import BaseEnv
from mani_skill.utils import common
from mani_skill.utils.registration import REGISTERED_ENVS, register
from mani_skill.utils.structs.pose import Pose
from mani_skill.utils.structs.types import SceneConfig, SimConfig
from torch import Tensor

from maniskill_taskgrasp import ENV_ID
from maniskill_taskgrasp.agents.controllers.palm_motion import PalmResidualController
from maniskill_taskgrasp.agents.fidelity import ContactSurfaces, asked_of, in_topology
from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.sawyer_ar10.agent import SawyerAR10
from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.episode import CLOSE_START, CONTROL_FREQ, LIFT_START, MAX_EPISODE_STEPS
from maniskill_taskgrasp.tasks import rewards, scene
from maniskill_taskgrasp.tasks.arguments import (
    DISTANCES,
    OBSERVATIONS,
    one_of,
    resolve_objects,
    resolve_topologies,
)
from maniskill_taskgrasp.tasks.arm_ik import ArmIK
from maniskill_taskgrasp.tasks.cpu_batch import CpuBatchMixin
from maniskill_taskgrasp.tasks.episode_state import from_rows, to_rows, unflattened
from maniskill_taskgrasp.tasks.memory import EpisodeMemory
from maniskill_taskgrasp.tasks.noise import draw_offsets, resolve_noise
from maniskill_taskgrasp.tasks.observation import KnownFacts
from maniskill_taskgrasp.tasks.offset import displaced, following
from maniskill_taskgrasp.tasks.outcome import LIFT_HEIGHT, Outcome
from maniskill_taskgrasp.tasks.placement import Placement, place
from maniskill_taskgrasp.tasks.planner import PregraspPlanner
from maniskill_taskgrasp.tasks.plans import PlanBook, Plans
from maniskill_taskgrasp.tasks.pregrasp import PREGRASP_FIELDS, palm_path
from maniskill_taskgrasp.tasks.senses import HandSenses, Reading
from maniskill_taskgrasp.tasks.sensing import HandBoxes, ObjectSurfaces
from maniskill_taskgrasp.tasks.surface import surface_of
from maniskill_taskgrasp.topology import Topology

SIM_FREQ = 100  # [Hz]


class TaskGraspEnv(CpuBatchMixin, BaseEnv):
    """
    **Task Description:**
    A Sawyer arm with an AR10 hand is told which grasp topology to use. The arm follows a planned
    path (hover, descend, close, lift, hold); the policy closes the hand along the topology's joint
    synergies.

    **Randomizations:**
    - the object's place, yaw, friction and mass differ from what the planner knows (`noise`)
    - objects and topologies differ between environments (`objects`, `topology`)

    **Success Conditions:**
    - the object is at least 0.20 m above its start and has been held by the hand alone for 0.5 s

    `reset` takes, beside ManiSkill's options, "topology" (a name for all environments that reset),
    "pregrasp" ((n, 6), `PREGRASP_FIELDS`, in place of the planner's) and "postures" (preshapes and
    closings, each (n, num_actuators) [rad], in place of the hand's own).
    """

    SUPPORTED_ROBOTS = ("sawyer_ar10",)
    SUPPORTED_REWARD_MODES = ("normalized_dense", "dense", "sparse", "none", "paper")
    agent: SawyerAR10
    _reading: Reading | None = None

    def __init__(
        self,
        *args: Any,
        topology: str | list[str] = "precision pad abd 2-3",
        objects: str | list[str] = "train",
        presentation: str = "auto",
        noise: str = "paper",
        distance: str = "exact",
        obs: str = "full",
        robot_uids: str = "sawyer_ar10",
        control_mode: str | None = "pd_synergy",
        **kwargs: Any,
    ) -> None:
        self.topologies = resolve_topologies(topology, control_mode)
        self.object_names = resolve_objects(objects)
        self._presentation = presentation
        self._noise = resolve_noise(noise)
        self._distance = one_of("distance", distance, DISTANCES)
        self._obs = one_of("obs", obs, OBSERVATIONS)
        self._weights = rewards.RewardWeights()
        if kwargs.get("reconfiguration_freq") is None and kwargs.get("num_envs", 1) == 1:
            drawn = len(self.object_names) > 1 or self._noise.draws_scene
            kwargs["reconfiguration_freq"] = int(drawn)
        super().__init__(*args, robot_uids=robot_uids, control_mode=control_mode, **kwargs)

    @property
    def _default_sim_config(self) -> SimConfig:
        # Small contact offset: half the cost and no trial flipped (facts: simulation, 3a).
        return SimConfig(
            sim_freq=SIM_FREQ,
            control_freq=CONTROL_FREQ,
            scene_config=SceneConfig(
                contact_offset=0.005,
                solver_position_iterations=scene.SOLVER_ITERATIONS,
                enable_enhanced_determinism=True,
            ),
        )

    @property
    def _default_sensor_configs(self) -> list[Any]:
        return [scene.sensor_camera()]

    @property
    def _default_human_render_camera_configs(self) -> list[Any]:
        return [scene.render_camera()]

    # Scene

    def _load_agent(self, options: dict) -> None:  # type: ignore[override]
        super()._load_agent(options, scene.ROBOT_POSE, build_separate=False)

    def _load_lighting(self, options: dict) -> None:
        scene.add_lights(self.scene, self.enable_shadow)

    def _load_scene(self, options: dict) -> None:
        scene.build_table(self.scene)
        self.placements = [self._placement(env) for env in range(self.num_envs)]
        self.obj, self.fixture = scene.build_objects(self.scene, self.placements)
        rngs = [self._batched_episode_rng[env] for env in range(self.num_envs)]
        scene.randomize(self.obj, self.agent.robot, self.placements, self._noise, rngs)
        self._prepare_hand()
        self._prepare_planning()
        self._prepare_memory()

    def _placement(self, env: int) -> Placement:
        draw = self._batched_episode_rng[env].randint(2**31)
        # One environment draws an object; many share the list out between them.
        index = draw % len(self.object_names) if self.num_envs == 1 else env
        name = self.object_names[index % len(self.object_names)]
        topology = self.topologies[env % len(self.topologies)]
        return place(library.load(name), self._presentation, topology=topology)

    def _after_reconfigure(self, options: dict) -> None:
        """Contact queries exist once the simulation runs."""
        names = [link.name for link in self._hand_links]
        self._senses = HandSenses(
            self.scene,
            self._hand_links,
            self._surfaces.part_of_link,
            self.obj,
            HandBoxes.of(self.agent.sensed_primitives, names, self.device),
            ObjectSurfaces.of([surface_of(p.model) for p in self.placements], self.device),
        )

    def _prepare_hand(self) -> None:
        part_links = self.agent.part_links.values()
        self._hand_links = [link for links in part_links for link in links]
        names = [link.name for link in self._hand_links]
        self._surfaces = ContactSurfaces(self.agent.hand, names, self.device)

    def _prepare_planning(self) -> None:
        agent, device = self.agent, self.device
        kinematics = ArticulationKinematics.of(agent.robot)
        self.planner = PregraspPlanner(agent.hand, agent.part_primitives, kinematics)
        limits = agent.robot.get_qlimits()[0, agent.arm_indices]
        root = Pose.create(scene.ROBOT_POSE, device=device).raw_pose[0]
        ik = ArmIK(kinematics, agent.arm_indices, agent.hand.palm_frame, limits, root)
        self._plan_book = PlanBook(self.planner, ik, device)
        poses = [np.concatenate([p.position, p.quat_wxyz]) for p in self.placements]
        self.nominal_pose = self._rows(poses)
        self._fixture_pose = self._rows([p.fixture_pose for p in self.placements])

    def _prepare_memory(self) -> None:
        num_actions = self.agent.single_action_space.shape[0]
        self._memory = EpisodeMemory(
            self.num_envs, len(self._hand_links), num_actions, self._distance, self.device
        )
        self._facts = KnownFacts(self._rows([p.extents for p in self.placements]))
        self._all_roles = rewards.PartRoles.of_topologies(self.device)
        weights = list(vars(self._weights).values())
        self._weight_column = torch.tensor(weights, device=self.device)[:, None]

    def _rows(self, rows: list[Any]) -> Tensor:
        """One row for each environment."""
        return torch.tensor(np.stack(rows), dtype=torch.float32, device=self.device)

    # Episode

    def _initialize_episode(self, env_idx: Tensor, options: dict) -> None:
        memory, topologies = self._memory, self._draw_topologies(env_idx, options)
        indices = [t.index for t in topologies]
        memory.topology_index[env_idx] = torch.tensor(indices, device=self.device)
        self._look_topologies_up()
        plans = self._plan(env_idx, topologies, options)
        memory.pregrasp[env_idx] = plans.pregrasp
        self._place_robot(env_idx, plans)
        self._place_objects(env_idx, plans)
        memory.last_action[env_idx] = 0.0
        memory.touch = memory.touch.clone()  # Readings that were handed out keep theirs.
        memory.touch[env_idx] = 0.0
        memory.outcome.reset(env_idx, plans.reachable)
        self._reading = None

    def _look_topologies_up(self) -> None:
        """What stays the same as long as the topologies do."""
        index = self._memory.topology_index
        self._asked, self._roles = asked_of(index), self._all_roles.of(index)

    def _draw_topologies(self, env_idx: Tensor, options: dict) -> list[Topology]:
        if "topology" in options:
            return resolve_topologies(options["topology"], self.control_mode) * len(env_idx)
        return [self.topologies[int(env) % len(self.topologies)] for env in env_idx]

    def _plan(self, env_idx: Tensor, topologies: list[Topology], options: dict) -> Plans:
        if "pregrasp" not in options:
            return self._plan_book.plans(env_idx, topologies, self.placements)
        own = [self.agent.hand.postures[t.slug] for t in topologies]
        shapes = options.get("postures") or (
            torch.tensor([posture.preshape for posture in own]),
            torch.tensor([posture.closing for posture in own]),
        )
        placements = [self.placements[int(env)] for env in env_idx]
        pregrasp = torch.as_tensor(options["pregrasp"])
        wanted = (len(env_idx), len(PREGRASP_FIELDS))
        if pregrasp.shape != wanted:
            came = tuple(pregrasp.shape)
            raise ValueError(f"options['pregrasp'] must have shape {wanted}, got {came}")
        return self._plan_book.custom(placements, pregrasp, *shapes)

    def _place_robot(self, env_idx: Tensor, plans: Plans) -> None:
        arm, hand = plans.path[:, 0].cpu().numpy(), plans.preshape.cpu().numpy()
        self.agent.reset(torch.from_numpy(self.agent.full_qpos(arm, hand)).to(self.device))
        shapes = plans.preshape, plans.closing
        self.agent.set_plan(env_idx, plans.path, *shapes, LIFT_START, CLOSE_START)

    def _place_objects(self, env_idx: Tensor, plans: Plans) -> None:
        rng = self._batched_episode_rng[env_idx]
        draws = draw_offsets(self._noise, rng.uniform(-1, 1, size=3))
        offsets = torch.tensor(draws, dtype=torch.float32, device=self.device)
        centre = torch.zeros_like(offsets)  # Objects stand on the world's vertical axis.
        pose = displaced(self.nominal_pose[env_idx], centre, offsets)
        self.obj.set_pose(Pose.create(pose))
        self.fixture.set_pose(Pose.create(displaced(self._fixture_pose[env_idx], centre, offsets)))
        palm = palm_path(plans.pregrasp, centre).grasp
        self._memory.true_shift[env_idx] = following(offsets, palm)
        self._memory.start_pos[env_idx] = pose[:, :3]
        errors = rng.uniform(-1, 1, size=2 * len(PARTS)).reshape(-1, 2, len(PARTS))
        self._memory.estimate.reset(env_idx, palm, errors)

    # State

    def reset(self, seed: Any = None, options: dict | None = None) -> Any:
        """As ManiSkill's; gymnasium's own generator is seeded as well, as its checker demands."""
        result = super().reset(seed=seed, options=options)
        if seed is not None:
            self._np_random, self._np_random_seed = np_random(int(np.ravel(seed)[0]))
        return result

    def _episode(self) -> dict[str, Tensor]:
        """Everything that the task remembers of the running episodes, each (num_envs, ...)."""
        return {"elapsed_steps": self._elapsed_steps, **self._memory.fields()}

    def get_state_dict(self) -> dict[str, Any]:
        """ManiSkill's state, with what controllers and task remember of the episode."""
        return {**super().get_state_dict(), "task": to_rows(self._episode())}

    def set_state_dict(self, state: dict, env_idx: Tensor | None = None) -> None:
        """Take back what `get_state_dict` gave; a state without "task" moves bodies only."""
        super().set_state_dict(state, env_idx)
        envs = torch.arange(self.num_envs, device=self.device) if env_idx is None else env_idx
        if "controller" in state:
            memory = common.to_tensor(state["controller"], device=self.device)
            rows = {
                uid: {k: torch.atleast_2d(v) for k, v in own.items()} for uid, own in memory.items()
            }
            self.agent.set_controller_state(rows, envs)
        if "task" in state:
            from_rows(self._episode(), state["task"], envs)
            self._look_topologies_up()
        self._reading = None

    def set_state(self, state: Any, env_idx: Tensor | None = None) -> None:
        """The same for what `get_state` gave."""
        self.set_state_dict(unflattened(state, self.get_state_dict()), env_idx)

    # Sensing

    def _step_action(self, action: Any) -> Any:
        action, memory = super()._step_action(action), self._memory
        if action is not None:
            memory.last_action = action.reshape(self.num_envs, -1).clone()
        self._reading = reading = self._senses.read()
        memory.touch = reading.local_forces
        speed = torch.linalg.vector_norm(self.obj.linear_velocity, dim=1)
        memory.outcome.record(self._lift(), reading.local_forces, reading.touch, speed)
        if self._obs == "full":
            step, imagining = self._elapsed_steps, self._senses.imagining
            memory.estimate.update(step, reading, self.nominal_pose, imagining)
        return action

    @property
    def outcome(self) -> Outcome:
        """What has become of the running episodes."""
        return self._memory.outcome

    @property
    def shift(self) -> Tensor:
        """(num_envs, 3) [m, m, rad] palm displacement that sensing says would restore the plan."""
        return self._memory.estimate.shift

    @property
    def hover_shift(self) -> Tensor:
        """(num_envs, 3) [m, m, rad] the same, as it was known when the hover ended."""
        return self._memory.estimate.hover_shift

    def needed_shift(self) -> Tensor:
        """(num_envs, 3) [m, m, rad] palm displacement that would restore the planned grasp.

        Privileged: for rewards and teachers, never observed. The object's turn counts as at the
        start, its place as it is now.
        """
        pushed = self.reading.obj_pose[:, :2] - self._memory.start_pos[:, :2]
        return self._memory.true_shift + torch.nn.functional.pad(pushed, (0, 1))

    def _palm_shift(self) -> Tensor:
        """(num_envs, 3) [m, m, rad] x, y and yaw by which the palm was moved off its path."""
        arm = self.agent.controller.controllers["arm"]
        if isinstance(arm, PalmResidualController):
            return arm.residual[:, [0, 1, 3]]
        return torch.zeros_like(self.shift)

    @property
    def reading(self) -> Reading:
        """What the hand feels now."""
        if self._reading is None:
            self._reading = self._senses.read(self._memory.touch)
        return self._reading

    def _lift(self) -> Tensor:
        return self.reading.obj_pose[:, 2] - self._memory.start_pos[:, 2]

    def evaluate(self) -> dict[str, Tensor]:
        reading, lift = self.reading, self._lift()
        failure = self.outcome.failure(self._elapsed_steps.long(), lift)
        return {
            "success": self.outcome.success,
            "fail": failure > 0,
            "lift": lift,
            "part_forces": reading.forces,
            "contact_links": reading.touch >= rewards.CONTACT_FORCE,
            "failure": failure,
            "fidelity": self._fidelity(),
        }

    def _fidelity(self) -> Tensor:
        """(num_envs,) bool: contacts of the last half second are those of the topology's name."""
        touched = self.outcome.touched
        if self.device.type == "cpu" and not touched.any():  # A third of each episode.
            return torch.zeros_like(touched)
        qpos = self.agent.robot.get_qpos()[:, self.agent.actuator_indices]
        shares = self._surfaces.shares(self.outcome.mean_forces)
        pip = qpos[:, self.agent.finger_pip]
        # The thumb's rotation counts as commanded: its contact bends it back (facts: grasping, 6).
        command = self.agent.controller.controllers["hand"].command
        thumb = command[:, self.agent.thumb_rotation]
        return in_topology(shares, self._asked, thumb, pip, self.agent.hand)

    # Observation

    def _get_obs_agent(self) -> dict[str, Tensor]:
        if self._obs == "paper":
            return {}
        qpos = self.agent.robot.get_qpos()[:, self.agent.actuator_indices]
        return {
            "qpos": qpos,
            "last_action": self._memory.last_action,
            **self.agent.controller.get_state(),
        }

    def _get_obs_extra(self, info: dict) -> dict[str, Tensor]:
        reading, memory = self.reading, self._memory
        distances = memory.estimate.sensed(reading.distances)
        sensed = {"forces": reading.forces, "distances": distances}
        if self._obs == "paper":
            return sensed
        plan = memory.topology_index, memory.pregrasp, memory.estimate.shift
        return {**sensed, **self._facts(self._elapsed_steps, *plan)}

    # Reward

    def get_reward(self, obs: Any, action: Tensor, info: dict) -> Tensor:
        if self.reward_mode == "paper":
            count = info["contact_links"].sum(1)
            return rewards.paper_reward(count, self.reading.touch.sum(1), info["success"])
        return super().get_reward(obs=obs, action=action, info=info)

    def reward_terms(self, info: dict[str, Tensor]) -> dict[str, Tensor]:
        """Unweighted terms, each (num_envs,) in [0, 1]."""
        named, opposing, fingers = self._roles
        forces, distances = info["part_forces"], self.reading.distances
        lift = rewards.lift_term(info["lift"], LIFT_HEIGHT)
        return {
            "centre": rewards.centre_term(self.needed_shift() - self._palm_shift()),
            "reach": rewards.reach_term(distances, named),
            "contact": rewards.contact_term(forces, named),
            "balance": rewards.balance_term(forces, opposing, fingers),
            "form": info["fidelity"] * lift,
            "lift": lift,
            "success": info["success"].float(),
        }

    def compute_dense_reward(self, obs: Any, action: Tensor, info: dict) -> Tensor:
        terms = self.reward_terms(info)
        info.update({f"reward/{name}": value for name, value in terms.items()})
        unweighted = torch.stack([terms[name] for name in vars(self._weights)])
        return (self._weight_column * unweighted).sum(0)

    def compute_normalized_dense_reward(self, obs: Any, action: Tensor, info: dict) -> Tensor:
        return self.compute_dense_reward(obs, action, info) / self._weights.total


if ENV_ID in REGISTERED_ENVS:
    raise RuntimeError(f"an environment named {ENV_ID!r} is registered already; names are unique")
# gymnasium knows the name since `import maniskill_taskgrasp`; this is ManiSkill's own registry.
register(ENV_ID, TaskGraspEnv, max_episode_steps=MAX_EPISODE_STEPS)
