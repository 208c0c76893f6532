"""Shared CPU physics behind the buffers and calls that ManiSkill knows from PhysxGpuSystem."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np
import sapien
import torch
from sapien import physx

from maniskill_taskgrasp.tasks.cpu_batch.contacts import ContactTable, ImpulseQuery
from maniskill_taskgrasp.tasks.cpu_batch.layout import Layout, entity_rows

if TYPE_CHECKING:
    from maniskill_taskgrasp.tasks.cpu_batch.scene import OffsetScene


class Buffer:
    """An array that code written for `sapien.CudaArray` can read: `.torch()` shares its memory."""

    def __init__(self, array: np.ndarray, refresh: Callable[[], None] | None = None):
        self.array = array
        self._tensor = torch.from_numpy(array)
        self._refresh = refresh

    def torch(self) -> torch.Tensor:
        """The array as a CPU tensor; writes reach the simulation through a gpu_apply call."""
        if self._refresh is not None:
            self._refresh()
        return self._tensor


class BatchedCpuSystem:
    """Steps a few shared PhysxCpuSystems; reads and writes all their environments at once.

    Positions are in each environment's own frame: offsets never leave this class. As on the GPU,
    a fetch copies the simulation into the buffers and an apply copies the buffers back. An apply
    touches only rows that differ from the last fetch and the environments named by `rewrite`, so
    that a partial reset leaves the others' trajectories bit-identical.
    """

    # ManiSkill asks `isinstance(scene.px, PhysxGpuSystem)`, and Python also asks this attribute.
    __class__ = property(lambda _: physx.PhysxGpuSystem)  # type: ignore[assignment]

    def __init__(self, systems: Sequence[physx.PhysxCpuSystem], scenes: Sequence[OffsetScene]):
        self.systems = list(systems)
        self.scenes = list(scenes)
        self.ready = False
        self.rewrite = np.zeros(len(scenes), dtype=bool)

    # Lists and settings of any PhysX system ------------------------------------------------------

    @property
    def timestep(self) -> float:
        """[s] of one physics step."""
        return self.systems[0].timestep

    @timestep.setter
    def timestep(self, seconds: float) -> None:
        for system in self.systems:
            system.timestep = seconds

    @property
    def config(self) -> physx.PhysxSceneConfig:
        """Settings that all the systems share."""
        return self.systems[0].config

    @property
    def rigid_dynamic_components(self) -> list[Any]:
        """Rigid dynamic bodies of all environments."""
        return [body for system in self.systems for body in system.rigid_dynamic_components]

    @property
    def rigid_static_components(self) -> list[Any]:
        """Static bodies of all environments."""
        return [body for system in self.systems for body in system.rigid_static_components]

    @property
    def articulation_link_components(self) -> list[Any]:
        """Links of all environments."""
        return [link for system in self.systems for link in system.articulation_link_components]

    def get_scene_offset(self, scene: OffsetScene) -> np.ndarray:
        """(3,) [m] where a sub-scene lies in its system."""
        return scene.offset

    def get_contacts(self) -> list[physx.PhysxContact]:
        """Contacts of all environments, with positions in their systems' frames."""
        return [contact for system in self.systems for contact in system.get_contacts()]

    # Life ----------------------------------------------------------------------------------------

    def gpu_init(self) -> None:
        """Number all bodies and make the buffers. Nothing may be built afterwards."""
        if self.ready:
            return
        layout = self.layout = Layout(self.systems, self.scenes)
        self._flat = np.zeros(layout.packed_size + 1, dtype=np.float32)
        self._link_place = entity_rows(layout, self.scenes)
        bodies, joints = (len(layout.bodies), 13), (len(layout.articulations), layout.max_dof)
        self._body = np.zeros(bodies, dtype=np.float32)
        self._qpos, self._qvel, self._qacc, self._qf = np.zeros((4, *joints), dtype=np.float32)
        self._target, self._target_velocity = np.zeros((2, *joints), dtype=np.float32)
        self._force, self._torque = np.zeros((2, len(layout.bodies), 4), dtype=np.float32)
        env_of = dict(zip(layout.bodies, layout.body_env.tolist(), strict=True))
        self._contacts = ContactTable(self.systems, env_of, len(self.scenes))
        self.cuda_rigid_body_data = Buffer(self._body)
        self.cuda_rigid_dynamic_data = Buffer(self._body[: layout.num_dynamic])
        self.moving_link_data = Buffer(self._body, self._fetch_link_velocities)
        self.cuda_articulation_qpos = Buffer(self._qpos)
        self.cuda_articulation_qvel = Buffer(self._qvel)
        self.cuda_articulation_qacc = Buffer(self._qacc, self._fetch_qacc)
        self.cuda_articulation_qf = Buffer(self._qf)
        self.cuda_articulation_target_qpos = Buffer(self._target)
        self.cuda_articulation_target_qvel = Buffer(self._target_velocity)
        self.cuda_rigid_body_force = Buffer(self._force)
        self.cuda_rigid_body_torque = Buffer(self._torque)
        self._bind_setters()
        self._outdated()
        self._check_packing()
        self._target[:] = self._packed()[layout.target_source]
        self._target_velocity[:] = self._packed()[layout.target_velocity_source]
        self._target_applied = self._target.copy()
        self._target_velocity_applied = self._target_velocity.copy()
        self._fetch()
        self.ready = True

    def _bind_setters(self) -> None:
        """Looking a method up costs as much as calling it: keep those of every step bound."""
        joints = [a.active_joints for a in self.layout.articulations]
        width = self.layout.max_dof
        self._set_target = _padded([[j.set_drive_target for j in js] for js in joints], width)
        self._set_target_velocity = _padded(
            [[j.set_drive_velocity_target for j in js] for js in joints], width
        )

    def _check_packing(self) -> None:
        """The packed state has no specification, so compare it with what bodies say themselves."""
        packed, layout = self._packed(), self.layout
        expected = [_state(body, body.entity.pose) for body in layout.bodies[: layout.num_dynamic]]
        agrees = np.array_equal(packed[layout.dynamic_source].ravel(), np.ravel(expected))
        for row, articulation in enumerate(layout.articulations):
            qpos = packed[layout.qpos_source[row, : articulation.dof]]
            agrees = agrees and np.array_equal(qpos, articulation.qpos)
        if not agrees:
            raise RuntimeError(
                f"SAPIEN {version('sapien')} packs its state in an unknown order: "
                "num_envs > 1 on the CPU works with SAPIEN 3.0.3"
            )

    def step(self) -> None:
        """One physics step of every environment."""
        for system in self.systems:
            system.step()
        self._outdated()
        self._contacts.stepped()

    def begin_rewrite(self, envs: np.ndarray | slice) -> None:
        """Apply calls now write these environments whole, and their contacts are void."""
        self.rewrite[envs] = True
        self._contacts.clear(envs)

    def end_rewrite(self) -> None:
        """Apply calls write only what differs from the last fetch again."""
        self.rewrite[:] = False

    def _outdated(self) -> None:
        self._packed_known = self._velocities_known = self._qacc_known = False

    # Fetch: simulation to buffers ----------------------------------------------------------------

    def _packed(self) -> np.ndarray:
        """State of all systems as one row of floats, the last of which is 0."""
        if not self._packed_known:
            packed = b"".join([system.pack() for system in self.systems])
            if len(packed) != 4 * self.layout.packed_size:
                raise RuntimeError("bodies were added or removed after the scene was set up")
            self._flat[:-1] = np.frombuffer(packed, dtype=np.float32)
            self._packed_known = True
        return self._flat

    def _fetch(self) -> None:
        self.gpu_fetch_rigid_dynamic_data()
        self.gpu_fetch_articulation_link_pose()
        self.gpu_fetch_articulation_qpos()
        self.gpu_fetch_articulation_qvel()

    def gpu_fetch_rigid_dynamic_data(self) -> None:
        """Poses and velocities of the rigid dynamic bodies."""
        layout = self.layout
        rows = self._body[: layout.num_dynamic]
        np.take(self._packed(), layout.dynamic_source, out=rows, mode="clip")
        rows[:, :3] -= layout.offset[: layout.num_dynamic]
        self._dynamic_fetched = rows.copy()

    def gpu_fetch_articulation_link_pose(self) -> None:
        """Poses of all links, and the velocities of the roots."""
        layout = self.layout
        packed = b"".join([scene.pack_poses() for scene in self.scenes])
        poses = np.frombuffer(packed, dtype=np.float32).reshape(-1, 7)[self._link_place]
        links = self._body[layout.num_dynamic :]
        np.subtract(poses[:, 4:7], layout.offset[layout.num_dynamic :], out=links[:, :3])
        links[:, 3:7] = poses[:, :4]
        self._body[layout.root_row, 7:] = self._packed()[layout.root_source[:, 7:]]
        self._root_fetched = self._body[layout.root_row]

    def gpu_fetch_articulation_link_velocity(self) -> None:
        """Nothing: `moving_link_data` asks the links one by one when somebody reads it."""

    def _fetch_link_velocities(self) -> None:
        if not self._velocities_known:
            for row in range(self.layout.num_dynamic, len(self._body)):
                link = self.layout.bodies[row]
                self._body[row, 7:10] = link.linear_velocity
                self._body[row, 10:13] = link.angular_velocity
            self._velocities_known = True

    def gpu_fetch_articulation_qpos(self) -> None:
        """Joint positions."""
        np.take(self._packed(), self.layout.qpos_source, out=self._qpos, mode="clip")
        self._qpos_fetched = self._qpos.copy()

    def gpu_fetch_articulation_qvel(self) -> None:
        """Joint velocities."""
        np.take(self._packed(), self.layout.qvel_source, out=self._qvel, mode="clip")
        self._qvel_fetched = self._qvel.copy()

    def gpu_fetch_articulation_qacc(self) -> None:
        """Nothing: joint accelerations are asked for one by one when somebody reads them."""

    def _fetch_qacc(self) -> None:
        if not self._qacc_known:
            for row, articulation in enumerate(self.layout.articulations):
                self._qacc[row, : articulation.dof] = articulation.qacc
            self._qacc_known = True

    def gpu_fetch_articulation_target_qpos(self) -> None:
        """Drive targets as the simulation has them; those not applied are forgotten."""
        self._target[:] = self._target_applied

    def gpu_fetch_articulation_target_qvel(self) -> None:
        """Drive velocity targets as the simulation has them."""
        self._target_velocity[:] = self._target_velocity_applied

    def gpu_fetch_articulation_link_incoming_joint_forces(self) -> None:
        """Spatial force on each link by its joint, into a (articulations, max links, 6) buffer."""
        forces = [a.get_link_incoming_joint_forces() for a in self.layout.articulations]
        padded = np.zeros((len(forces), max(map(len, forces)), 6), dtype=np.float32)
        for row, force in zip(padded, forces, strict=True):
            row[: len(force)] = force
        self.cuda_articulation_link_incoming_joint_forces = Buffer(padded)

    # Apply: buffers to simulation ----------------------------------------------------------------

    def _changed(self, wanted: np.ndarray, known: np.ndarray, env: np.ndarray) -> list[int]:
        """Rows that were written to, or whose environment is being rewritten."""
        return np.nonzero((wanted != known).any(axis=1) | self.rewrite[env])[0].tolist()

    def gpu_apply_rigid_dynamic_data(self) -> None:
        """Poses and velocities of rigid dynamic bodies."""
        layout = self.layout
        dynamic = self._body[: layout.num_dynamic]
        env = layout.body_env[: layout.num_dynamic]
        for row in self._changed(dynamic, self._dynamic_fetched, env):
            body, state = layout.bodies[row], dynamic[row]
            body.entity.set_pose(sapien.Pose(state[:3] + layout.offset[row], state[3:7]))
            if not body.kinematic:
                body.set_linear_velocity(state[7:10])
                body.set_angular_velocity(state[10:13])
        self._dynamic_fetched = dynamic.copy()
        self._outdated()

    def gpu_apply_articulation_root_pose(self) -> None:
        """Poses of root links."""
        layout = self.layout
        wanted = self._body[layout.root_row]
        known = self._root_fetched
        for row in self._changed(wanted[:, :7], known[:, :7], layout.articulation_env):
            position = wanted[row, :3] + layout.offset[layout.root_row[row]]
            layout.articulations[row].set_root_pose(sapien.Pose(position, wanted[row, 3:7]))
        known[:, :7] = wanted[:, :7]
        self._outdated()

    def gpu_apply_articulation_root_velocity(self) -> None:
        """Velocities of root links that can move."""
        layout = self.layout
        wanted = self._body[layout.root_row]
        known = self._root_fetched
        for row in self._changed(wanted[:, 7:], known[:, 7:], layout.articulation_env):
            articulation = layout.articulations[row]
            if articulation.root.joint.type != "fixed":
                articulation.set_root_linear_velocity(wanted[row, 7:10])
                articulation.set_root_angular_velocity(wanted[row, 10:13])
        known[:, 7:] = wanted[:, 7:]
        self._outdated()

    def gpu_apply_articulation_qpos(self) -> None:
        """Joint positions."""
        layout = self.layout
        for row in self._changed(self._qpos, self._qpos_fetched, layout.articulation_env):
            layout.articulations[row].set_qpos(self._qpos[row, : layout.dof[row]])
        self._qpos_fetched = self._qpos.copy()
        self._outdated()

    def gpu_apply_articulation_qvel(self) -> None:
        """Joint velocities."""
        layout = self.layout
        for row in self._changed(self._qvel, self._qvel_fetched, layout.articulation_env):
            layout.articulations[row].set_qvel(self._qvel[row, : layout.dof[row]])
        self._qvel_fetched = self._qvel.copy()
        self._outdated()

    def gpu_apply_articulation_qf(self) -> None:
        """Joint forces, where any was asked for since they were last 0."""
        layout = self.layout
        pushed = getattr(self, "_pushed", np.zeros(len(self._qf), dtype=bool))
        asked = self._qf.any(axis=1)
        for row in np.nonzero(asked | pushed)[0]:
            layout.articulations[row].set_qf(self._qf[row, : layout.dof[row]])
        self._pushed = asked

    def gpu_apply_articulation_target_position(self) -> None:
        """Drive targets."""
        _send(self._target, self._target_applied, self._set_target)

    def gpu_apply_articulation_target_velocity(self) -> None:
        """Drive velocity targets."""
        _send(self._target_velocity, self._target_velocity_applied, self._set_target_velocity)

    def gpu_apply_rigid_dynamic_force(self) -> None:
        """Forces [N] at the centres of mass for one step, then none."""
        self._push(self._force, torque=False)

    def gpu_apply_rigid_dynamic_torque(self) -> None:
        """Torques [Nm] for one step, then none."""
        self._push(self._torque, torque=True)

    def _push(self, wanted: np.ndarray, torque: bool) -> None:
        none = np.zeros(3, dtype=np.float32)
        for row in np.nonzero(wanted.any(axis=1))[0]:
            push = wanted[row, :3]
            force, moment = (none, push) if torque else (push, none)
            self.layout.bodies[row].add_force_torque(force, moment)
        wanted[:] = 0

    def gpu_update_articulation_kinematics(self) -> None:
        """Nothing: SAPIEN moves the links when it is given joint positions or a root pose."""

    def sync_poses_gpu_to_cpu(self) -> None:
        """Nothing: the poses are on the CPU."""

    # Contacts ------------------------------------------------------------------------------------

    def gpu_create_contact_pair_impulse_query(self, pairs: Sequence[tuple]) -> ImpulseQuery:
        """Query for the impulse on the first body of each pair by the second."""
        return self._contacts.pair_query(pairs)

    def gpu_create_contact_body_impulse_query(self, bodies: Sequence[Any]) -> ImpulseQuery:
        """Query for the net impulse on each body."""
        return self._contacts.body_query(bodies)

    def gpu_query_contact_pair_impulses(self, query: ImpulseQuery) -> None:
        """Bring a pair query up to date."""
        self._contacts.query(query)

    def gpu_query_contact_body_impulses(self, query: ImpulseQuery) -> None:
        """Bring a body query up to date."""
        self._contacts.query(query)


def _state(body: Any, pose: sapien.Pose) -> np.ndarray:
    return np.concatenate([pose.p, pose.q, body.linear_velocity, body.angular_velocity])


def _padded(setters: list[list[Callable]], width: int) -> list[Callable | None]:
    """One flat list, `width` entries for each articulation."""
    return [s for row in setters for s in [*row, *[None] * (width - len(row))]]


def _send(wanted: np.ndarray, applied: np.ndarray, setters: list) -> None:
    """Call the setter of every entry that changed, and of one entry in rows where none did.

    Setting a target wakes an articulation. ManiSkill's own CPU path sets all of them each step,
    so a robot that is told to stay must not fall asleep here either.
    """
    changed = wanted != applied
    changed[~changed.any(axis=1), :1] = True
    which = np.flatnonzero(changed)
    for entry, value in zip(which.tolist(), wanted.ravel()[which].tolist(), strict=True):
        setters[entry](value)
    applied[:] = wanted
