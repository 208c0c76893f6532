"""The stand-in for PhysxGpuSystem: ManiSkill's fetch and apply calls over groups on the CPU."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sapien
import torch
from sapien import physx

from maniskill_taskgrasp.tasks.cpu_batch.arrays import Arrays
from maniskill_taskgrasp.tasks.cpu_batch.group import EnvGroup
from maniskill_taskgrasp.tasks.cpu_batch.workers import RemoteGroup


class Buffer:
    """An array that code written for `sapien.CudaArray` can read: `.torch()` shares its memory."""

    def __init__(self, array: np.ndarray, refresh: Callable[[], None] | None = None):
        self._tensor = torch.from_numpy(array)
        self._refresh = refresh

    def torch(self) -> torch.Tensor:
        """The array as a CPU tensor; writes reach the simulation through a gpu_apply call."""
        if self._refresh is not None:
            self._refresh()
        return self._tensor


class ImpulseQuery:
    """Impulses that were asked for; `cuda_impulses.torch()` is (asked, 3) [Ns]."""

    def __init__(self, groups: np.ndarray, rows: np.ndarray, signs: np.ndarray):
        """
        Args:
            groups: (asked,) group that knows each impulse.
            rows: (asked,) row in that group's contact table.
            signs: (asked,) 1 or -1.
        """
        self._impulses = np.zeros((len(rows), 3), dtype=np.float32)
        self.cuda_impulses = Buffer(self._impulses)
        self._parts = []
        for group in np.unique(groups).tolist():
            mine = np.nonzero(groups == group)[0]
            self._parts.append((group, mine, rows[mine], signs[mine, None].astype(np.float32)))

    def fill(self, tables: Sequence[np.ndarray]) -> None:
        """Take what this query asks for out of the groups' contact tables."""
        for group, mine, rows, signs in self._parts:
            self._impulses[mine] = tables[group].take(rows, axis=0) * signs


@dataclass
class Share:
    """The rows of the buffers that belong to a group."""

    group: EnvGroup | RemoteGroup
    local: EnvGroup  # The same group in this process, dead once `group` is remote.
    envs: range
    bodies: range
    articulations: range


class BatchedCpuSystem:
    """Steps all environments; reads and writes them at once.

    As on the GPU, a fetch copies the simulation into the buffers and an apply copies the buffers
    back. Here an apply touches only rows that differ from the last fetch and the environments
    that are being rewritten, so that others are not disturbed.
    """

    # ManiSkill asks `isinstance(scene.px, PhysxGpuSystem)`, and Python also asks this attribute.
    __class__ = property(lambda _: physx.PhysxGpuSystem)  # type: ignore[assignment]

    def __init__(self, scenes: list[sapien.Scene], processes: int = 1):
        """
        Args:
            scenes: one for each environment, with its own PhysX system; replaced as they are reset.
            processes: how many share the physics, this one included.
        """
        self.scenes = scenes
        self.ready = False
        self._processes = processes
        self._pending = 0  # Steps asked for and not yet taken.
        self._rewriting = np.zeros(len(self.scenes), dtype=bool)

    # Settings of any PhysX system ----------------------------------------------------------------

    @property
    def timestep(self) -> float:
        """[s] of one physics step."""
        return self.scenes[0].physx_system.timestep

    @timestep.setter
    def timestep(self, seconds: float) -> None:
        for system in self.systems:
            system.timestep = seconds

    @property
    def systems(self) -> list[physx.PhysxCpuSystem]:
        """One for each environment."""
        return [scene.physx_system for scene in self.scenes]

    @property
    def config(self) -> physx.PhysxSceneConfig:
        """Settings that all the systems share."""
        return self.scenes[0].physx_system.config

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

    def get_scene_offset(self, scene: sapien.Scene) -> np.ndarray:
        """(3,) [m] zero: every environment has a world of its own."""
        return np.zeros(3, dtype=np.float32)

    def get_contacts(self) -> list[physx.PhysxContact]:
        """Contacts of all environments.

        Raises:
            RuntimeError: other processes hold some; contact queries work there too.
        """
        if any(isinstance(share.group, RemoteGroup) for share in self._shares):
            raise RuntimeError(
                "contact lists stay in the process that runs the physics: "
                "use a contact query or sim_config scene_config cpu_workers=1"
            )
        self._refresh()
        return [contact for system in self.systems for contact in system.get_contacts()]

    # Life ----------------------------------------------------------------------------------------

    def gpu_init(self) -> None:
        """Number all bodies and make the buffers. Nothing may be built afterwards."""
        if self.ready:
            return
        self._shares = self._split()
        width = int(max((d for s in self._shares for d in s.local.dofs), default=0))
        last = self._shares[-1]
        arrays = self._arrays = Arrays.zeros(last.bodies.stop, last.articulations.stop, width)
        for share in self._shares:
            share.local.bind(arrays.rows(_slice(share.bodies), _slice(share.articulations)))
        self._number()
        self.cuda_rigid_body_data = Buffer(arrays.body)
        self.moving_link_data = Buffer(arrays.body, self._fetch_moving)
        self.cuda_articulation_qpos = Buffer(arrays.qpos)
        self.cuda_articulation_qvel = Buffer(arrays.qvel)
        self.cuda_articulation_qacc = Buffer(arrays.qacc, self._fetch_moving)
        self.cuda_articulation_qf = Buffer(arrays.qf)
        self.cuda_articulation_target_qpos = Buffer(arrays.target)
        self.cuda_articulation_target_qvel = Buffer(arrays.target_velocity)
        self.cuda_rigid_body_force = Buffer(arrays.force)
        self.cuda_rigid_body_torque = Buffer(arrays.torque)
        arrays.body[:], arrays.qpos[:], arrays.qvel[:] = (
            arrays.sim_body,
            arrays.sim_qpos,
            arrays.sim_qvel,
        )
        arrays.target[:] = arrays.sent_target
        arrays.target_velocity[:] = arrays.sent_target_velocity
        self._pushed = np.zeros(len(arrays.qf), dtype=bool)
        self._tables: list[np.ndarray] | None = None
        self._outdated = self._moving_known = False
        self._drive = False  # Drive targets were set since the last step.
        self.ready = True

    def _split(self) -> list[Share]:
        """Groups of about equal size, one for each process."""
        bounds = np.linspace(0, len(self.scenes), self._processes + 1).round().astype(int)
        shares, bodies, articulations = [], 0, 0
        for first, stop in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
            group = EnvGroup(self.scenes, range(first, stop))
            rows = range(bodies, bodies + len(group.bodies))
            joints = range(articulations, articulations + len(group.articulations))
            shares.append(Share(group, group, range(first, stop), rows, joints))
            bodies, articulations = rows.stop, joints.stop
        return shares

    def _number(self) -> None:
        """Global row numbers, from those of the groups."""
        shares = self._shares

        def joined(name: str, starts: Sequence[int]) -> np.ndarray:
            parts = [getattr(s.local, name) + at for s, at in zip(shares, starts, strict=True)]
            return np.concatenate(parts)

        first_env = [s.envs.start for s in shares]
        first_body = [s.bodies.start for s in shares]
        self._body_env = joined("body_env", first_env)
        self._articulation_env = joined("articulation_env", first_env)
        self._dynamic = joined("dynamic", first_body)
        self._links = joined("links", first_body)
        self._root_row = joined("root_row", first_body)
        self.row_of: dict[int, int] = {}
        self.articulation_row_of: dict[int, int] = {}
        # Group and number in the group of every body, statics counting on after the others.
        self._place: dict[int, tuple[int, int]] = {}
        for number, share in enumerate(shares):
            local = share.local
            for row, body in enumerate(local.bodies + local.statics):
                self._place[body.entity.global_id] = (number, row)
                if row < len(local.bodies):
                    self.row_of[body.entity.global_id] = share.bodies.start + row
            for row, articulation in enumerate(local.articulations):
                root = articulation.root.entity.global_id
                self.articulation_row_of[root] = share.articulations.start + row

    def _spread(self) -> None:
        """Fork the processes, as late as possible: what is set up until the first step counts."""
        for share in self._shares[1:]:
            if share.group is share.local:
                share.group = RemoteGroup(share.local)

    def join(self) -> None:
        """Bring all environments back into this process, until the next step spreads them again.

        Needed before SAPIEN's objects are changed directly once stepping has begun.
        """
        if self.ready:
            self._refresh()
            for share in self._shares:
                if isinstance(share.group, RemoteGroup):
                    share.group.close()
                    share.group = share.local
                    share.local.revive()
                    self._outdated = self._drive = True

    def close(self) -> None:
        """End the other processes."""
        for share in self._shares if self.ready else []:
            if isinstance(share.group, RemoteGroup):
                share.group.close()

    # Stepping ------------------------------------------------------------------------------------

    def step(self) -> None:
        """One physics step of every environment, taken when somebody looks or intervenes.

        Together with the other steps of the same control step it costs a third less, see
        `EnvGroup.advance`.
        """
        self._pending += 1

    def _refresh(self) -> None:
        """Take the pending steps and read the state."""
        if not (self._pending or self._outdated):
            return
        if self._pending:
            self._spread()
            self._call("advance", self._pending, self._drive)
            self._pending, self._drive = 0, False
        else:
            self._call("read")
        self._outdated = self._moving_known = False
        self._tables = None

    def _call(self, name: str, *args: Any) -> list[Any]:
        """Call a method of every group and collect the results."""
        return self._call_each(name, [args] * len(self._shares))

    def _call_each(self, name: str, args: Sequence[tuple | None]) -> list[Any]:
        """The same with arguments of its own for every group; None spares it."""
        called = [(s.group, a) for s, a in zip(self._shares, args, strict=True) if a is not None]
        # Other processes first: they work while this one does its own share, the first.
        for group, arguments in reversed(called):
            group.post(name, *arguments)
        return [group.wait() for group, _ in called]

    def _settle(self) -> None:
        """Take the pending steps before something is changed."""
        if self._pending:
            self._refresh()

    def begin_rewrite(self, envs: Any) -> None:
        """Until `end_rewrite`, apply calls write these environments whole; their past is void."""
        self._refresh()
        self._rewriting[envs] = True
        rows = [np.nonzero(self._rewriting[_slice(s.envs)])[0].tolist() for s in self._shares]
        self._call_each("forget", [(inside,) if inside else None for inside in rows])
        self._tables = None

    def end_rewrite(self) -> None:
        """Apply calls write only what differs from the last fetch again."""
        self._rewriting[:] = False

    # Fetch: simulation to buffers ----------------------------------------------------------------

    def gpu_fetch_rigid_dynamic_data(self) -> None:
        """Poses and velocities of the rigid dynamic bodies."""
        self._refresh()
        self._arrays.body[self._dynamic] = self._arrays.sim_body[self._dynamic]

    def gpu_fetch_articulation_link_pose(self) -> None:
        """Poses of all links, and the velocities of the roots."""
        self._refresh()
        self._arrays.body[self._links, :7] = self._arrays.sim_body[self._links, :7]
        self._arrays.body[self._root_row, 7:] = self._arrays.sim_body[self._root_row, 7:]

    def gpu_fetch_articulation_link_velocity(self) -> None:
        """Nothing: `moving_link_data` asks the links one by one when somebody reads it."""

    def gpu_fetch_articulation_qpos(self) -> None:
        """Joint positions."""
        self._refresh()
        self._arrays.qpos[:] = self._arrays.sim_qpos

    def gpu_fetch_articulation_qvel(self) -> None:
        """Joint velocities."""
        self._refresh()
        self._arrays.qvel[:] = self._arrays.sim_qvel

    def gpu_fetch_articulation_qacc(self) -> None:
        """Nothing: accelerations are asked for one by one when somebody reads them."""

    def _fetch_moving(self) -> None:
        if self._moving_known:
            return
        self._refresh()
        self._call("read_moving")
        self._arrays.body[self._links, 7:] = self._arrays.sim_body[self._links, 7:]
        self._moving_known = True

    def gpu_fetch_articulation_target_qpos(self) -> None:
        """Drive targets as the simulation has them; those not applied are forgotten."""
        self._arrays.target[:] = self._arrays.sent_target

    def gpu_fetch_articulation_target_qvel(self) -> None:
        """Drive velocity targets as the simulation has them."""
        self._arrays.target_velocity[:] = self._arrays.sent_target_velocity

    def gpu_fetch_articulation_link_incoming_joint_forces(self) -> None:
        """Spatial force on each link by its joint, into (articulations, max links, 6)."""
        self._refresh()
        forces = [force for part in self._call("link_incoming_joint_forces") for force in part]
        padded = np.zeros((len(forces), max(map(len, forces)), 6), dtype=np.float32)
        for row, force in zip(padded, forces, strict=True):
            row[: len(force)] = force
        self.cuda_articulation_link_incoming_joint_forces = Buffer(padded)

    # Apply: buffers to simulation ----------------------------------------------------------------

    def _write(self, name: str, changed: np.ndarray, env: np.ndarray, of_bodies: bool) -> None:
        """Have rows written that changed or whose environment is being rewritten."""
        self._settle()
        rows = np.nonzero(changed | self._rewriting[env])[0]
        if of_bodies:
            rows = self._dynamic[rows]
        args: list[tuple | None] = []
        for share in self._shares:
            own = share.bodies if of_bodies else share.articulations
            inside = rows[(rows >= own.start) & (rows < own.stop)] - own.start
            args.append((inside.tolist(),) if len(inside) else None)
        self._call_each(name, args)
        self._outdated = self._outdated or len(rows) > 0

    def gpu_apply_rigid_dynamic_data(self) -> None:
        """Poses and velocities of rigid dynamic bodies."""
        rows = self._dynamic
        changed = (self._arrays.body[rows] != self._arrays.sim_body[rows]).any(axis=1)
        self._write("write_dynamic", changed, self._body_env[rows], of_bodies=True)

    def gpu_apply_articulation_root_pose(self) -> None:
        """Poses of root links."""
        rows = self._root_row
        changed = (self._arrays.body[rows, :7] != self._arrays.sim_body[rows, :7]).any(axis=1)
        self._write("write_root_pose", changed, self._articulation_env, of_bodies=False)

    def gpu_apply_articulation_root_velocity(self) -> None:
        """Velocities of root links that can move."""
        rows = self._root_row
        changed = (self._arrays.body[rows, 7:] != self._arrays.sim_body[rows, 7:]).any(axis=1)
        self._write("write_root_velocity", changed, self._articulation_env, of_bodies=False)

    def gpu_apply_articulation_qpos(self) -> None:
        """Joint positions."""
        changed = (self._arrays.qpos != self._arrays.sim_qpos).any(axis=1)
        self._write("write_qpos", changed, self._articulation_env, of_bodies=False)

    def gpu_apply_articulation_qvel(self) -> None:
        """Joint velocities."""
        changed = (self._arrays.qvel != self._arrays.sim_qvel).any(axis=1)
        self._write("write_qvel", changed, self._articulation_env, of_bodies=False)

    def gpu_apply_articulation_qf(self) -> None:
        """Joint forces, where there is any or was at the last call."""
        asked = np.asarray(self._arrays.qf.any(axis=1))
        self._write("write_qf", asked | self._pushed, self._articulation_env, of_bodies=False)
        self._pushed = asked

    def gpu_apply_articulation_target_position(self) -> None:
        """Drive targets; the joints are told them just before the next step."""
        self._send_targets(self._arrays.target, self._arrays.sent_target)

    def gpu_apply_articulation_target_velocity(self) -> None:
        """Drive velocity targets."""
        self._send_targets(self._arrays.target_velocity, self._arrays.sent_target_velocity)

    def _send_targets(self, wanted: np.ndarray, sent: np.ndarray) -> None:
        self._settle()  # The steps asked for so far go with the old targets.
        sent[:] = wanted
        self._drive = True

    def gpu_apply_rigid_dynamic_force(self) -> None:
        """Forces [N] at the centres of mass for one step."""
        self._push("write_force", self._arrays.force)

    def gpu_apply_rigid_dynamic_torque(self) -> None:
        """Torques [Nm] for one step."""
        self._push("write_torque", self._arrays.torque)

    def _push(self, name: str, wanted: np.ndarray) -> None:
        self._settle()
        pushed = [np.nonzero(wanted[_slice(s.bodies)].any(axis=1))[0] for s in self._shares]
        self._call_each(name, [(rows.tolist(),) for rows in pushed])
        wanted[:] = 0

    def gpu_update_articulation_kinematics(self) -> None:
        """Nothing: SAPIEN moves the links when it is given joint positions or a root pose."""

    def sync_poses_gpu_to_cpu(self) -> None:
        """Nothing: the poses are on the CPU."""

    # Contacts ------------------------------------------------------------------------------------

    def gpu_create_contact_pair_impulse_query(self, pairs: Sequence[tuple]) -> ImpulseQuery:
        """Query for the impulse on the first body of each pair by the second."""
        places = [(self._place_of(a), self._place_of(b)) for a, b in pairs]
        groups = [first[0] for first, _ in places]
        return self._query("add_pairs", groups, [(a[1], b[1]) for a, b in places])

    def gpu_create_contact_body_impulse_query(self, bodies: Sequence[Any]) -> ImpulseQuery:
        """Query for the net impulse on each body."""
        places = [self._place_of(body) for body in bodies]
        return self._query("add_bodies", [p[0] for p in places], [p[1] for p in places])

    def _place_of(self, body: Any) -> tuple[int, int]:
        return self._place[body.entity.global_id]

    def _query(self, name: str, groups: list[int], what: list) -> ImpulseQuery:
        of_group, rows_signs = np.array(groups), np.zeros((len(what), 2), dtype=int)
        mine = [np.nonzero(of_group == number)[0] for number in range(len(self._shares))]
        args = [([what[i] for i in places],) if len(places) else None for places in mine]
        for places, answer in zip(filter(len, mine), self._call_each(name, args), strict=True):
            rows_signs[places] = answer
        self._tables = None
        return ImpulseQuery(of_group, rows_signs[:, 0], rows_signs[:, 1])

    def _fill(self, query: ImpulseQuery) -> None:
        self._refresh()
        if self._tables is None:
            self._tables = self._call("contact_table")
        query.fill(self._tables)

    def gpu_query_contact_pair_impulses(self, query: ImpulseQuery) -> None:
        """Bring a pair query up to date with the last step."""
        self._fill(query)

    def gpu_query_contact_body_impulses(self, query: ImpulseQuery) -> None:
        """Bring a body query up to date with the last step."""
        self._fill(query)


def _slice(rows: range) -> slice:
    return slice(rows.start, rows.stop)
