"""TaskGrasp-v0: close the hand in the topology that was asked for until the object is lifted."""

from __future__ import annotations

from collections.abc import Sequence
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
from maniskill_taskgrasp.agents.fidelity import ContactSurfaces, in_topology
from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.agents.kinematics import ArticulationKinematics
from maniskill_taskgrasp.agents.sawyer_ar10.agent import SawyerAR10
from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.episode import (
    CONTROL_FREQ,
    HOVER,
    LIFT_START,
    MAX_EPISODE_STEPS,
    PHASE_ENDS,
    PHASES,
)
from maniskill_taskgrasp.errors import InputError, echo
from maniskill_taskgrasp.tasks import rewards, scene
from maniskill_taskgrasp.tasks.arm_ik import ArmIK
from maniskill_taskgrasp.tasks.cpu_batch import CpuBatchMixin
from maniskill_taskgrasp.tasks.episode_state import from_rows, to_rows, unflattened
from maniskill_taskgrasp.tasks.noise import draw_friction, draw_offsets, resolve_noise
from maniskill_taskgrasp.tasks.offset import (
    FEELS,
    LOOKS,
    OffsetFilter,
    displaced,
    following,
)
from maniskill_taskgrasp.tasks.outcome import LIFT_HEIGHT, Outcome
from maniskill_taskgrasp.tasks.phases import phase_at
from maniskill_taskgrasp.tasks.placement import Placement, place
from maniskill_taskgrasp.tasks.planner import PregraspPlanner
from maniskill_taskgrasp.tasks.plans import PlanBook, Plans
from maniskill_taskgrasp.tasks.pregrasp import palm_path
from maniskill_taskgrasp.tasks.senses import HandSenses, Reading
from maniskill_taskgrasp.tasks.sensing import HandBoxes, ObjectSurfaces
from maniskill_taskgrasp.tasks.surface import surface_of
from maniskill_taskgrasp.topology import TOPOLOGIES, Topology, resolve_topology

SIM_FREQ = 100  # [Hz]
DISTANCES = ("exact", "noisy", "none")
DISTANCE_ERROR = (0.003, 0.005)  # [m] size of the error that "noisy" draws once an episode.
OBSERVATIONS = ("full", "paper")
EPISODE_FIELDS = (
    "_elapsed_steps",
    "topology_index",
    "pregrasp",
    "shift",
    "_true_shift",
    "_start_pos",
    "hover_shift",
    "_palm",
    "_distance_error",
    "_last_action",
    "_touch",
)
"""What the task remembers of an episode beside `Outcome` and `OffsetModel`."""


def _one_of(name: str, value: str, allowed: Sequence[str]) -> str:
    if value not in allowed:
        raise InputError(f"{name} must be one of {', '.join(allowed)}, got {echo(value)}")
    return value


def _resolve_topologies(topology: str | Sequence[str], control_mode: str | None) -> list[Topology]:
    """Topologies of the environments, which a `pd_synergy_<slug>` must not contradict."""
    if isinstance(topology, str):
        topology = [t.name for t in TOPOLOGIES] if topology == "all" else [topology]
    topologies = [resolve_topology(name) for name in topology]
    own = [t for t in TOPOLOGIES if control_mode == f"pd_synergy_{t.slug}"]
    if own and topologies != own:
        names = ", ".join(t.name for t in topologies)
        raise InputError(f"control mode {control_mode!r} closes {own[0].name!r}, not {names!r}")
    return topologies


def _resolve_objects(objects: str | Sequence[str]) -> list[str]:
    if isinstance(objects, str):
        if objects in ("train", "test"):
            return list(library.names(objects))
        return list(library.names()) if objects == "all" else [objects]
    if not objects:
        raise InputError("objects must name at least one object, got an empty list")
    return list(objects)


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
        self.topologies = _resolve_topologies(topology, control_mode)
        self.object_names = _resolve_objects(objects)
        self._presentation = presentation
        self._noise = resolve_noise(noise)
        self._distance = _one_of("distance", distance, DISTANCES)
        self._obs = _one_of("obs", obs, OBSERVATIONS)
        self._weights = rewards.RewardWeights()
        super().__init__(*args, robot_uids=robot_uids, control_mode=control_mode, **kwargs)

    @property
    def _default_sim_config(self) -> SimConfig:
        # Small contact offset: half the cost and no trial flipped (facts: simulation, 3a).
        return SimConfig(
            sim_freq=SIM_FREQ,
            control_freq=CONTROL_FREQ,
            scene_config=SceneConfig(
                contact_offset=0.005,
                solver_position_iterations=12,
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
        self._randomize_physics()
        self._prepare_planning()

    def _placement(self, env: int) -> Placement:
        draw = self._batched_episode_rng[env].randint(2**31)
        # One environment draws an object; many share the list out between them.
        index = draw % len(self.object_names) if self.num_envs == 1 else env
        name = self.object_names[index % len(self.object_names)]
        topology = self.topologies[env % len(self.topologies)]
        return place(library.load(name), self._presentation, topology=topology)

    def _randomize_physics(self) -> None:
        """Friction and mass of each environment's object, set before the first physics step."""
        for env, placement in enumerate(self.placements):
            rng = self._batched_episode_rng[env]
            friction = draw_friction(self._noise, placement.model.friction, rng)
            body = self.obj._bodies[env]
            factor = rng.uniform(*self._noise.mass)
            body.set_mass(body.mass * factor)
            body.set_inertia(body.inertia * factor)
            scene.set_friction(body, friction)
            for link in self.agent.robot.links:
                scene.set_friction(link._bodies[env], friction)

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

    # Planning

    def _prepare_planning(self) -> None:
        agent, device = self.agent, self.device
        kinematics = ArticulationKinematics.of(agent.robot)
        self._hand_links = [link for links in agent.part_links.values() for link in links]
        link_names = [link.name for link in self._hand_links]
        self._surfaces = ContactSurfaces(agent.hand, link_names, device)
        self.planner = PregraspPlanner(agent.hand, agent.part_primitives, kinematics)
        limits = agent.robot.get_qlimits()[0, agent.arm_indices]
        root = Pose.create(scene.ROBOT_POSE, device=device).raw_pose[0]
        ik = ArmIK(kinematics, agent.arm_indices, agent.hand.palm_frame, limits, root)
        self._plan_book = PlanBook(self.planner, ik, device)
        n = self.num_envs
        tensor = lambda rows: torch.tensor(np.stack(rows), dtype=torch.float32, device=device)  # noqa: E731
        self.nominal_pose = tensor(
            [np.concatenate([p.position, p.quat_wxyz]) for p in self.placements]
        )
        self._fixture_pose = tensor([p.fixture_pose for p in self.placements])
        self._extents = tensor([p.extents for p in self.placements])
        self.topology_index = torch.zeros(n, dtype=torch.long, device=device)
        self.pregrasp = torch.zeros(n, 6, device=device)
        error = sum(DISTANCE_ERROR) / 2 if self._distance == "noisy" else 0.0
        self._filter = OffsetFilter(n, len(PARTS), error, device)
        self._palm = torch.zeros(n, 3, device=device)
        self.shift = torch.zeros(n, 3, device=device)
        self.hover_shift = torch.zeros(n, 3, device=device)
        self._true_shift = torch.zeros(n, 3, device=device)
        self._start_pos = torch.zeros(n, 3, device=device)
        self._distance_error = torch.zeros(n, len(PARTS), device=device)
        self._last_action = torch.zeros(n, self.agent.single_action_space.shape[0], device=device)
        self.outcome = Outcome(n, len(link_names), device)
        self._named_parts = torch.tensor(
            [[part in t.parts for part in PARTS] for t in TOPOLOGIES], device=device
        )
        self._topology_code = torch.eye(len(TOPOLOGIES), device=device)
        phases = phase_at(torch.arange(MAX_EPISODE_STEPS + 1, device=device))
        self._phase_of_step = torch.eye(len(PHASES), device=device)[
            phases.clamp(max=len(PHASES) - 1)
        ]
        fingers = [part not in ("palm", "thumb") for part in PARTS]
        self._finger_parts = torch.tensor(fingers, device=device)
        self._touch = torch.zeros(n, len(link_names), 3, device=device)

    def _initialize_episode(self, env_idx: Tensor, options: dict) -> None:
        topologies = self._draw_topologies(env_idx, options)
        self.topology_index[env_idx] = torch.tensor(
            [t.index for t in topologies], device=self.device
        )
        plans = self._plan(env_idx, topologies, options)
        self.pregrasp[env_idx] = plans.pregrasp
        self._palm[env_idx] = palm_path(plans.pregrasp, torch.zeros_like(self._palm[env_idx])).grasp
        self._filter.reset(env_idx)
        self.shift[env_idx] = 0.0
        self.hover_shift[env_idx] = 0.0
        self._place_robot(env_idx, plans)
        self._place_objects(env_idx)
        self._last_action[env_idx] = 0.0
        self._touch = self._touch.clone()  # Readings that were handed out keep theirs.
        self._touch[env_idx] = 0.0
        self.outcome.reset(env_idx, plans.reachable)
        self._reading = None

    def _draw_topologies(self, env_idx: Tensor, options: dict) -> list[Topology]:
        if "topology" in options:
            return [resolve_topology(options["topology"])] * len(env_idx)
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
        return self._plan_book.custom(placements, torch.as_tensor(options["pregrasp"]), *shapes)

    def _place_robot(self, env_idx: Tensor, plans: Plans) -> None:
        arm, hand = plans.path[:, 0].cpu().numpy(), plans.preshape.cpu().numpy()
        self.agent.reset(torch.from_numpy(self.agent.full_qpos(arm, hand)).to(self.device))
        self.agent.set_plan(env_idx, plans.path, plans.preshape, plans.closing, LIFT_START)

    def _place_objects(self, env_idx: Tensor) -> None:
        rng = self._batched_episode_rng[env_idx]
        draws = draw_offsets(self._noise, rng.uniform(-1, 1, size=3))
        offsets = torch.tensor(draws, dtype=torch.float32, device=self.device)
        centre = torch.zeros_like(offsets)  # Objects stand on the world's vertical axis.
        pose = displaced(self.nominal_pose[env_idx], centre, offsets)
        self.obj.set_pose(Pose.create(pose))
        self.fixture.set_pose(Pose.create(displaced(self._fixture_pose[env_idx], centre, offsets)))
        self._true_shift[env_idx] = following(offsets, self._palm[env_idx])
        self._start_pos[env_idx] = pose[:, :3]
        errors = rng.uniform(-1, 1, size=2 * len(PARTS)).reshape(-1, 2, len(PARTS))
        low, high = DISTANCE_ERROR
        size = low + (high - low) * np.abs(errors[:, 0])
        self._distance_error[env_idx] = torch.tensor(
            np.sign(errors[:, 1]) * size, dtype=torch.float32, device=self.device
        )

    # State

    def reset(self, seed: Any = None, options: dict | None = None) -> Any:
        """As ManiSkill's; gymnasium's own generator is seeded as well, as its checker demands."""
        result = super().reset(seed=seed, options=options)
        if seed is not None:
            self._np_random, self._np_random_seed = np_random(int(np.ravel(seed)[0]))
        return result

    def _episode(self) -> dict[str, Tensor]:
        """Everything that the task remembers of the running episodes, each (num_envs, ...)."""
        own = {name.removeprefix("_"): getattr(self, name) for name in EPISODE_FIELDS}
        return {
            **own,
            "offset_mean": self._filter.mean,
            "offset_covariance": self._filter.covariance,
            **vars(self.outcome),
        }

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
        self._reading = None

    def set_state(self, state: Any, env_idx: Tensor | None = None) -> None:
        """The same for what `get_state` gave."""
        self.set_state_dict(unflattened(state, self.get_state_dict()), env_idx)

    # Sensing

    def _step_action(self, action: Any) -> Any:
        action = super()._step_action(action)
        if action is not None:
            self._last_action = action.reshape(self.num_envs, -1).clone()
        self._reading = reading = self._senses.read()
        self._touch = reading.local_forces
        speed = self.obj.linear_velocity.norm(dim=1)
        self.outcome.record(self._lift(), reading.local_forces, speed)
        self._estimate_shift()
        return action

    def _estimate_shift(self) -> None:
        """Sensing tells how far the palm must move to stand to the object as planned."""
        if self._obs != "full":
            return
        step, reading = self._elapsed_steps, self.reading
        times = FEELS if self._distance == "none" else LOOKS
        rows = torch.isin(step, self._tensor_of(times)).nonzero()[:, 0]
        if len(rows):
            link_poses, nominal = reading.link_poses[rows], self.nominal_pose[rows]

            def expected(offset: Tensor) -> Tensor:
                pose = displaced(nominal, torch.zeros_like(offset), offset)
                return self._senses.imagined(rows, link_poses, pose)

            if self._distance == "none":
                self._filter.feel(rows, reading.forces[rows], expected)
            else:
                self._filter.look(rows, self._sensed_distances()[rows], expected)
            self.shift[rows] = following(self._filter.mean[rows, :3], self._palm[rows])
        hovering = (step < PHASE_ENDS[HOVER])[:, None]
        self.hover_shift = torch.where(hovering, self.shift, self.hover_shift)

    def _tensor_of(self, steps: tuple[int, ...]) -> Tensor:
        return torch.tensor(steps, device=self.device)

    def needed_shift(self) -> Tensor:
        """(num_envs, 3) [m, m, rad] palm displacement that would restore the planned grasp.

        Privileged: for rewards and teachers, never observed. The object's turn counts as at the
        start, its place as it is now.
        """
        pushed = self.obj.pose.p[:, :2] - self._start_pos[:, :2]
        return self._true_shift + torch.nn.functional.pad(pushed, (0, 1))

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
            self._reading = self._senses.read(self._touch)
        return self._reading

    def _lift(self) -> Tensor:
        return self.reading.height - self._start_pos[:, 2]

    def evaluate(self) -> dict[str, Tensor]:
        reading, lift = self.reading, self._lift()
        failure = self.outcome.failure(self._elapsed_steps.long(), lift)
        return {
            "success": self.outcome.success,
            "fail": failure > 0,
            "lift": lift,
            "part_forces": reading.forces,
            "contact_links": reading.local_forces.norm(dim=-1) >= rewards.CONTACT_FORCE,
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
        return in_topology(shares, self.topology_index, thumb, pip)

    # Observation

    def _get_obs_agent(self) -> dict[str, Tensor]:
        if self._obs == "paper":
            return {}
        qpos = self.agent.robot.get_qpos()[:, self.agent.actuator_indices]
        return {"qpos": qpos, "last_action": self._last_action, **self.agent.controller.get_state()}

    def _get_obs_extra(self, info: dict) -> dict[str, Tensor]:
        forces = self.reading.forces
        sensed = {"forces": forces, "distances": self._sensed_distances()}
        if self._obs == "paper":
            return sensed
        step = self._elapsed_steps
        return {
            **sensed,
            "phase": self._phase_of_step[step.clamp(max=MAX_EPISODE_STEPS).long()],
            "progress": (step / MAX_EPISODE_STEPS)[:, None],
            "topology": self._topology_code[self.topology_index],
            "extents": self._extents,
            "pregrasp": self.pregrasp,
            "shift": self.shift,
        }

    def _sensed_distances(self) -> Tensor:
        """(num_envs, num_parts) [m] as the chosen track knows them."""
        distances = self.reading.distances
        if self._distance == "none":
            return torch.zeros_like(distances)
        if self._distance == "noisy":
            return (distances + self._distance_error).clamp(min=0)
        return distances

    # Reward

    def get_reward(self, obs: Any, action: Tensor, info: dict) -> Tensor:
        if self.reward_mode == "paper":
            forces = self.reading.local_forces.norm(dim=-1)
            count = info["contact_links"].sum(1)
            return rewards.paper_reward(count, forces.sum(1), info["success"])
        return super().get_reward(obs=obs, action=action, info=info)

    def reward_terms(self, info: dict[str, Tensor]) -> dict[str, Tensor]:
        """Unweighted terms, each (num_envs,) in [0, 1]."""
        named = self._named_parts[self.topology_index]
        opposing = named & ~self._finger_parts
        forces, distances = info["part_forces"], self.reading.distances
        lift = rewards.lift_term(info["lift"], LIFT_HEIGHT)
        return {
            "centre": rewards.centre_term(self.needed_shift() - self._palm_shift()),
            "reach": rewards.reach_term(distances, named),
            "contact": rewards.contact_term(forces, named),
            "balance": rewards.balance_term(forces, opposing, named & self._finger_parts),
            "form": info["fidelity"] * lift,
            "lift": lift,
            "success": info["success"].float(),
        }

    def compute_dense_reward(self, obs: Any, action: Tensor, info: dict) -> Tensor:
        terms = self.reward_terms(info)
        info.update({f"reward/{name}": value for name, value in terms.items()})
        weights = vars(self._weights)
        return torch.stack([weights[name] * value for name, value in terms.items()]).sum(0)

    def compute_normalized_dense_reward(self, obs: Any, action: Tensor, info: dict) -> Tensor:
        return self.compute_dense_reward(obs, action, info) / self._weights.total


if ENV_ID in REGISTERED_ENVS:
    raise RuntimeError(f"an environment named {ENV_ID!r} is registered already; names are unique")
# gymnasium knows the name since `import maniskill_taskgrasp`; this is ManiSkill's own registry.
register(ENV_ID, TaskGraspEnv, max_episode_steps=MAX_EPISODE_STEPS)
