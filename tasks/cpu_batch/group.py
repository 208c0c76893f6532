"""Environments that one process steps: the only place where SAPIEN's objects are touched."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np
import sapien
from sapien import physx

from maniskill_taskgrasp.tasks.cpu_batch.arrays import Arrays
from maniskill_taskgrasp.tasks.cpu_batch.contacts import ContactTable

BODY = 13  # Floats of a body's state.
NO_PUSH = np.zeros(3, dtype=np.float32)
# SAPIEN packs a body as quaternion, position, velocities; the GPU buffers put position first.
PACKED_TO_BUFFER = np.array([4, 5, 6, 0, 1, 2, 3, 7, 8, 9, 10, 11, 12])


class EnvGroup:
    """Consecutive environments, each a scene with a PhysX system of its own.

    Rows of the arrays go environment by environment: first its rigid dynamic bodies, then its
    links, in the order in which its system lists them. All row and environment numbers here count
    from the start of the group.

    A system per environment costs PhysX about a sixth (docs/cpu_batch.md) over systems that hold
    several environments at offsets. It buys trajectories that depend on nothing else: in shared
    systems, resetting one environment changed others in the last bits even with PhysX's enhanced
    determinism, and offsets round positions.
    """

    def __init__(self, all_scenes: list[sapien.Scene], envs: range):
        """
        Args:
            all_scenes: one for each environment there is; `forget` replaces them in this list.
            envs: those of this group.
        """
        self._all_scenes = all_scenes
        self._first_env = envs.start
        self.scenes = scenes = all_scenes[envs.start : envs.stop]
        self.systems: list[physx.PhysxCpuSystem] = [s.physx_system for s in scenes]
        self.bodies: list[Any] = []
        self.articulations: list[physx.PhysxArticulation] = []
        self.statics: list[Any] = []
        self._result: Any = None
        self._number()
        self._stale = np.ones(len(self.scenes), dtype=bool)
        self._moving_stale = True
        env_of = dict(zip(self.bodies, self.body_env.tolist(), strict=True))
        self._contacts = ContactTable(self.systems, env_of)

    # Numbering -----------------------------------------------------------------------------------

    def _number(self) -> None:
        """Number the bodies and find where each is in the packed state of the systems."""
        body_env: list[int] = []
        articulation_env, dynamic, links = [], [], []
        dynamic_start, root_start, link_place = [], [], []
        state, entities = 0, 0
        self._state_slices, self._entity_slices = [], []
        for env, (scene, system) in enumerate(zip(self.scenes, self.systems, strict=True)):
            first_state, first_entity = state, entities
            place = {e.global_id: entities + i for i, e in enumerate(scene.entities)}
            for body in system.rigid_dynamic_components:
                dynamic.append(len(self.bodies))
                self.bodies.append(body)
                dynamic_start.append(state)
                state += BODY
            for link in system.articulation_link_components:
                links.append(len(self.bodies))
                self.bodies.append(link)
                link_place.append(place[link.entity.global_id])
                if link.is_root:
                    self.articulations.append(link.articulation)
                    articulation_env.append(env)
                    root_start.append(state)
                    # Root state, qpos, qvel, then target and target velocity joint by joint.
                    state += BODY + 4 * link.articulation.dof
            self.statics += system.rigid_static_components
            body_env += [env] * (len(self.bodies) - len(body_env))
            entities += len(place)
            self._state_slices.append(slice(first_state, state))
            self._entity_slices.append(slice(first_entity, entities))
        self.body_env = np.array(body_env, dtype=int)
        self.articulation_env = np.array(articulation_env, dtype=int)
        self.dynamic = np.array(dynamic, dtype=int)
        self.links = np.array(links, dtype=int)
        rows = {body.entity.global_id: row for row, body in enumerate(self.bodies)}
        self.root_row = np.array(
            [rows[a.root.entity.global_id] for a in self.articulations], dtype=int
        )
        self.dofs = np.array([a.dof for a in self.articulations], dtype=int)
        self._state = np.zeros(state + 1, dtype=np.float32)  # The last slot stays 0, for padding.
        self._poses = np.zeros((entities, 7), dtype=np.float32)
        self._dynamic_source = _column(dynamic_start) + PACKED_TO_BUFFER
        self._root_source = _column(root_start) + PACKED_TO_BUFFER
        self._link_source = 7 * _column(link_place) + PACKED_TO_BUFFER[:7]

    def bind(self, arrays: Arrays) -> None:
        """Take these rows of the buffers and fill them from the simulation."""
        self.arrays = arrays
        width = arrays.qpos.shape[1]
        joint, dofs = np.arange(width), self.dofs[:, None]
        self._exists = joint < dofs  # The rest is padding.
        start = self._root_source.min(axis=1, initial=self._state.size)[:, None] + BODY

        def padded(source: np.ndarray) -> np.ndarray:
            return np.where(self._exists, source, self._state.size - 1)

        self._qpos_source = padded(start + joint)
        self._qvel_source = padded(start + dofs + joint)
        target_source = padded(start + 2 * dofs + 2 * joint)
        joints = [a.active_joints for a in self.articulations]
        # Looking a method up costs as much as calling it: keep those of every step bound.
        self._set_target = _flat([[j.set_drive_target for j in js] for js in joints], width)
        self._set_target_velocity = _flat(
            [[j.set_drive_velocity_target for j in js] for js in joints], width
        )
        # First drive of each environment, and the end.
        envs = np.arange(len(self.scenes) + 1)
        self._drive_bounds = width * np.searchsorted(self.articulation_env, envs)
        # PhysX gives back another pose than it was told by some 1e-7 m. Roots that are bolted down
        # stay where they were told to be, lest a robot drift from reset to reset.
        self._told_root = np.zeros((len(self.articulations), 7), dtype=np.float32)
        self._bolted = np.zeros(len(self.articulations), dtype=bool)
        self.read()
        self._told_root[:] = self.arrays.sim_body[self.root_row, :7]
        self._bolted[:] = [a.root.joint.type == "fixed" for a in self.articulations]
        self._check_packing()
        self._told_target = self._state[target_source]
        self._told_target_velocity = self._state[
            np.minimum(target_source + 1, len(self._state) - 1)
        ]
        arrays.sent_target[:] = self._told_target
        arrays.sent_target_velocity[:] = self._told_target_velocity

    def _check_packing(self) -> None:
        """The packed state has no specification, so compare it with what bodies say themselves."""
        sim = self.arrays
        agrees = all(
            np.array_equal(sim.sim_body[row], _state_of(self.bodies[row]))
            for row in self.dynamic.tolist()
        ) and all(
            np.array_equal(sim.sim_qpos[row, : a.dof], a.qpos)
            for row, a in enumerate(self.articulations)
        )
        if not agrees:
            raise RuntimeError(
                f"SAPIEN {version('sapien')} packs its state in an unknown order: "
                "num_envs > 1 on the CPU works with SAPIEN 3.0.3"
            )

    # Stepping and reading ------------------------------------------------------------------------

    def advance(self, steps: int, drive: bool) -> None:
        """Step every environment that often, then read its state.

        An environment's drive targets, steps and state come in a row: its memory stays in the
        cache, which is worth a third of the time at 64.

        Args:
            steps: physics steps.
            drive: whether drive targets were set since the last step.
        """
        tellers = self._tellers() if drive else []
        packed, poses = [], []
        for env, system in enumerate(self.systems):
            for teller in tellers:
                teller.tell(env)
            self.run_physics(system, steps)
            packed.append(system.pack())
            poses.append(self.scenes[env].pack_poses())
        self._take(packed, slice(0, -1), poses, slice(None))
        self._stale[:] = False
        self._sort()
        self._contacts.stepped()

    @staticmethod
    def run_physics(system: physx.PhysxCpuSystem, steps: int) -> None:
        """All that PhysX does in a control step of one environment."""
        step = system.step
        for _ in range(steps):
            step()

    def read(self) -> None:
        """Bring the state of environments that were written to up."""
        stale = np.nonzero(self._stale)[0].tolist()
        for env in stale:
            packed, poses = [self.systems[env].pack()], [self.scenes[env].pack_poses()]
            self._take(packed, self._state_slices[env], poses, self._entity_slices[env])
        self._stale[:] = False
        if stale:
            self._sort()

    def _take(self, packed: list[bytes], state: slice, poses: list[bytes], entities: slice) -> None:
        """Keep the packed state of consecutive environments in these places."""
        try:
            self._state[state] = np.frombuffer(b"".join(packed), dtype=np.float32)
            self._poses[entities] = np.frombuffer(b"".join(poses), dtype=np.float32).reshape(-1, 7)
        except ValueError:
            raise RuntimeError("bodies were added or removed after the scene was set up") from None

    def _sort(self) -> None:
        """Bring `sim_body` (except the velocities of moving links), `sim_qpos`, `sim_qvel` up."""
        self._moving_stale = True
        sim = self.arrays
        sim.sim_body[self.dynamic] = self._state[self._dynamic_source]
        sim.sim_body[self.links, :7] = self._poses.take(self._link_source)
        sim.sim_body[self.root_row, 7:] = self._state[self._root_source[:, 7:]]
        sim.sim_body[self.root_row[self._bolted], :7] = self._told_root[self._bolted]
        sim.sim_qpos[:] = self._state.take(self._qpos_source)
        sim.sim_qvel[:] = self._state.take(self._qvel_source)

    def read_moving(self) -> None:
        """Bring the velocities of moving links and the joint accelerations up, one by one."""
        if not self._moving_stale:
            return
        for row in self.links.tolist():
            link = self.bodies[row]
            self.arrays.sim_body[row, 7:10] = link.linear_velocity
            self.arrays.sim_body[row, 10:13] = link.angular_velocity
        for row, articulation in enumerate(self.articulations):
            self.arrays.qacc[row, : articulation.dof] = articulation.qacc
        self._moving_stale = False

    def link_incoming_joint_forces(self) -> list[np.ndarray]:
        """(links, 6) spatial force on each link by its joint, for each articulation."""
        return [a.get_link_incoming_joint_forces() for a in self.articulations]

    # Writing: each takes rows of the buffers into the simulation ---------------------------------

    def forget(self, envs: Sequence[int]) -> None:
        """Rid environments of what PhysX remembers beside their state, by moving house.

        Contact caches and internal orders survive new poses, so that an episode would depend on
        the ones before it; even taking the bodies out and putting them back leaves traces.
        """
        before = physx.get_scene_config()
        for env in envs:
            old_scene, old_system = self.scenes[env], self.systems[env]
            physx.set_scene_config(old_system.config)
            system = physx.PhysxCpuSystem()
            system.timestep = old_system.timestep
            scene = sapien.Scene([system])
            entities = old_scene.entities
            for entity in entities:
                entity.remove_from_scene()
            for entity in entities:
                scene.add_entity(entity)
            self.systems[env] = system
            self.scenes[env] = self._all_scenes[self._first_env + env] = scene
        physx.set_scene_config(before)
        self._contacts.clear(envs)

    def write_dynamic(self, rows: Sequence[int]) -> None:
        """Poses and velocities of rigid dynamic bodies."""
        for row in rows:
            body, state = self.bodies[row], self.arrays.body[row]
            body.entity.set_pose(sapien.Pose(state[:3], state[3:7]))
            if not body.kinematic:
                body.set_linear_velocity(state[7:10])
                body.set_angular_velocity(state[10:13])
            self.arrays.sim_body[row] = state
        self._stale[self.body_env[rows]] = True

    def write_root_pose(self, rows: Sequence[int]) -> None:
        """Poses of the root links of articulations."""
        for row in rows:
            state = self.arrays.body[self.root_row[row]]
            self.articulations[row].set_root_pose(sapien.Pose(state[:3], state[3:7]))
            self.arrays.sim_body[self.root_row[row], :7] = state[:7]
            self._told_root[row] = state[:7]
        self._stale[self.articulation_env[rows]] = True

    def write_root_velocity(self, rows: Sequence[int]) -> None:
        """Velocities of the root links that can move."""
        for row in rows:
            articulation, state = self.articulations[row], self.arrays.body[self.root_row[row]]
            if not self._bolted[row]:
                articulation.set_root_linear_velocity(state[7:10])
                articulation.set_root_angular_velocity(state[10:13])
            self.arrays.sim_body[self.root_row[row], 7:] = state[7:]
        self._stale[self.articulation_env[rows]] = True

    def write_qpos(self, rows: Sequence[int]) -> None:
        """Joint positions."""
        for row in rows:
            self.articulations[row].set_qpos(self.arrays.qpos[row, : self.dofs[row]])
        self.arrays.sim_qpos[rows] = self.arrays.qpos[rows]
        self._stale[self.articulation_env[rows]] = True

    def write_qvel(self, rows: Sequence[int]) -> None:
        """Joint velocities."""
        for row in rows:
            self.articulations[row].set_qvel(self.arrays.qvel[row, : self.dofs[row]])
        self.arrays.sim_qvel[rows] = self.arrays.qvel[rows]
        self._stale[self.articulation_env[rows]] = True

    def write_qf(self, rows: Sequence[int]) -> None:
        """Joint forces."""
        for row in rows:
            self.articulations[row].set_qf(self.arrays.qf[row, : self.dofs[row]])

    def write_force(self, rows: Sequence[int]) -> None:
        """Forces at the centres of mass, for one step."""
        for row in rows:
            self.bodies[row].add_force_torque(self.arrays.force[row, :3], NO_PUSH)

    def write_torque(self, rows: Sequence[int]) -> None:
        """Torques, for one step."""
        for row in rows:
            self.bodies[row].add_force_torque(NO_PUSH, self.arrays.torque[row, :3])

    def _tellers(self) -> list[_Teller]:
        """What sends each environment its drive targets.

        Setting a target wakes an articulation. ManiSkill's own CPU path sets all of them each
        step, so a robot that is told to stay must not fall asleep here either.
        """
        here, bounds = self.arrays, self._drive_bounds
        wake = self._exists[:, :1]
        position = _Teller(here.sent_target, self._told_target, self._set_target, bounds, wake)
        if np.array_equal(here.sent_target_velocity, self._told_target_velocity):
            return [position]
        velocity = (here.sent_target_velocity, self._told_target_velocity)
        return [position, _Teller(*velocity, self._set_target_velocity, bounds)]

    def revive(self) -> None:
        """Take the state over that another process has come to, as far as the arrays know it."""
        here = self.arrays
        here.body[:], here.qpos[:], here.qvel[:] = here.sim_body, here.sim_qpos, here.sim_qvel
        self.forget(range(len(self.scenes)))
        articulations = range(len(self.articulations))
        self.write_dynamic(self.dynamic.tolist())
        self.write_root_pose(articulations)
        self.write_root_velocity(articulations)
        self.write_qpos(articulations)
        self.write_qvel(articulations)
        for told in (self._told_target, self._told_target_velocity):
            told[self._exists] = np.nan  # The next step tells them all.

    # Contacts ------------------------------------------------------------------------------------

    def add_pairs(self, pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
        """(row, sign) in the contact table of the impulse on the first of each pair of bodies.

        Static bodies count on after the others.
        """
        bodies = self.bodies + self.statics
        return [self._contacts.add_pair(bodies[a], bodies[b]) for a, b in pairs]

    def add_bodies(self, rows: Sequence[int]) -> list[tuple[int, int]]:
        """(row, sign) in the contact table of the net impulse on each body."""
        return [self._contacts.add_body(self.bodies[row]) for row in rows]

    def contact_table(self) -> np.ndarray:
        """(rows, 3) [Ns] impulses of the last physics step."""
        return self._contacts.table()

    # The same calls, as a group in another process takes them ------------------------------------

    def post(self, name: str, *args: Any) -> None:
        """Call a method by name; in another process it may still be running afterwards."""
        self._result = getattr(self, name)(*args)

    def wait(self) -> Any:
        """Result of the last post."""
        return self._result


def _column(starts: list[int]) -> np.ndarray:
    return np.array(starts, dtype=int).reshape(-1, 1)


def _flat(setters: list[list[Callable]], width: int) -> list[Callable | None]:
    """One list, `width` entries for each articulation."""
    return [s for row in setters for s in [*row, *[None] * (width - len(row))]]


def _state_of(body: Any) -> np.ndarray:
    pose = body.entity.pose
    return np.concatenate([pose.p, pose.q, body.linear_velocity, body.angular_velocity])


class _Teller:
    """Sends drive targets that changed, environment by environment."""

    def __init__(
        self,
        wanted: np.ndarray,
        told: np.ndarray,
        setters: list[Callable | None],
        bounds: np.ndarray,
        wake: np.ndarray | None = None,
    ) -> None:
        """
        Args:
            wanted: (articulations, width) targets.
            told: (articulations, width) what was sent before; brought up to date.
            setters: of every entry, in a row.
            bounds: (envs + 1,) first entry of each environment, and the end.
            wake: (articulations, 1) bool: whether the first entry is sent where none changed.
        """
        changed = wanted != told
        if wake is not None:
            changed[:, :1] |= wake & ~changed.any(axis=1, keepdims=True)
        which = np.flatnonzero(changed)
        self._cuts = np.searchsorted(which, bounds).tolist()
        self._setters = [setters[entry] for entry in which.tolist()]
        self._values = wanted.ravel()[which].tolist()
        told[:] = wanted

    def tell(self, env: int) -> None:
        """Send an environment its own."""
        own = slice(self._cuts[env], self._cuts[env + 1])
        for setter, value in zip(self._setters[own], self._values[own]):  # noqa: B905
            setter(value)
