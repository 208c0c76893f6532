"""Does an object stay where it is put? Two seconds of physics, measured, for many at once."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.actor import add_fixture, add_object
from maniskill_taskgrasp.assets.objects.geometry import quat_to_matrix
from maniskill_taskgrasp.assets.objects.model import ObjectModel, RestingPose
from maniskill_taskgrasp.assets.objects.presentation import STANDS, Presentation, place, present
from maniskill_taskgrasp.assets.objects.stable import SAME_TURN, symmetry_axes
from maniskill_taskgrasp.errors import InputError

if TYPE_CHECKING:
    import sapien

SECONDS = 2.0
TIMESTEP = 0.01  # [s] that of the task.
SPACING = 0.75  # [m] between neighbours, too far to touch.
GROUP = 25  # Objects in one scene.
MAX_SHIFT = 0.003  # [m]
MAX_TURN = np.radians(3.0)


@dataclass(frozen=True)
class Rest:
    """What became of an object that was put down."""

    shift_m: float
    """Travel of the origin."""
    turn_rad: float
    tilt_rad: float
    """Turn of the object's x axis alone: all there is to see of a round thing that turns."""
    speed: float
    """[m/s] at the end."""
    quat_wxyz: tuple[float, float, float, float]
    """World orientation at the end."""
    height: float
    """[m] of the origin at the end."""

    @property
    def stayed(self) -> bool:
        return self.shift_m <= MAX_SHIFT and self.turn_rad <= MAX_TURN


def settle(
    cases: Sequence[tuple[ObjectModel, Presentation]], seconds: float = SECONDS
) -> list[Rest]:
    """Put every object down where its presentation says, `GROUP` in a scene, and measure the rest.

    Scenes stay small and about the origin: far from it, single precision alone upsets a screw.
    """
    rests: list[Rest] = []
    for first in range(0, len(cases), GROUP):
        rests += _settle_group(cases[first : first + GROUP], seconds)
    return rests


def _settle_group(cases: Sequence[tuple[ObjectModel, Presentation]], seconds: float) -> list[Rest]:
    import sapien

    system = _system()
    scene = sapien.Scene([system])
    material = sapien.physx.PhysxMaterial(0.6, 0.6, 0.0)
    ground = scene.create_actor_builder()
    ground.add_plane_collision(sapien.Pose(q=[0.7071068, 0, -0.7071068, 0]), material)
    ground.build_static("table")
    columns = int(np.ceil(np.sqrt(len(cases))))
    bodies = []
    for index, (model, presentation) in enumerate(cases):
        cell = np.array([index % columns, index // columns, 0])
        place = (cell - [columns // 2, columns // 2, 0]) * SPACING
        if presentation.parts:
            fixture = scene.create_actor_builder()
            add_fixture(fixture, presentation, visual=False)
            fixture.set_initial_pose(sapien.Pose(place))
            fixture.build_static(f"fixture {index}")
        builder = scene.create_actor_builder()
        add_object(builder, model, visual=False)
        start = sapien.Pose(place + presentation.position, presentation.quat_wxyz)
        builder.set_initial_pose(start)
        bodies.append((builder.build(f"object {index}"), start))
    for _ in range(round(seconds / TIMESTEP)):
        system.step()
    return [_measure(entity, start) for entity, start in bodies]


def _system() -> sapien.physx.PhysxCpuSystem:
    """CPU physics with the task's settings (facts: 100 Hz, TGS, 15 iterations, 5 mm offset)."""
    import sapien

    sapien.physx.set_scene_config(enable_tgs=True, enable_pcm=True)
    sapien.physx.set_body_config(solver_position_iterations=15, solver_velocity_iterations=1)
    sapien.physx.set_shape_config(contact_offset=0.005, rest_offset=0.0)
    system = sapien.physx.PhysxCpuSystem()
    system.timestep = TIMESTEP
    return system


def _measure(entity: sapien.Entity, start: sapien.Pose) -> Rest:
    import sapien

    body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
    before, after = quat_to_matrix(start.q), quat_to_matrix(entity.pose.q)
    cosine = (np.trace(before.T @ after) - 1) / 2
    quat: NDArray[np.float64] = np.asarray(entity.pose.q, dtype=float)
    return Rest(
        shift_m=float(np.linalg.norm(entity.pose.p - start.p)),
        turn_rad=float(np.arccos(np.clip(cosine, -1, 1))),
        tilt_rad=float(np.arccos(np.clip(before[:, 0] @ after[:, 0], -1, 1))),
        speed=float(np.linalg.norm(body.linear_velocity)),
        quat_wxyz=(float(quat[0]), float(quat[1]), float(quat[2]), float(quat[3])),
        height=float(entity.pose.p[2]),
    )


def settled_poses(
    models: Sequence[ObjectModel], seconds: float = 3.0
) -> list[tuple[RestingPose, ...]]:
    """Resting poses of each model as physics leaves them, without those it does not keep.

    Every pose is let go, taken as it ends, and let go again from there; it is kept if it moves
    less than half of what the settle test allows. Poses that end alike are joined.
    """
    cases = [(m, i) for m in models for i in range(len(m.resting_poses))]
    first = settle([(m, present(m, "table", i)) for m, i in cases], seconds)
    ended = [
        replace(m.resting_poses[i], quat_wxyz=rest.quat_wxyz, height=rest.height)
        for (m, i), rest in zip(cases, first, strict=True)
    ]
    again = settle(
        [
            (m, Presentation("table", (), (0.0, 0.0, pose.height), pose.quat_wxyz, ""))
            for (m, _), pose in zip(cases, ended, strict=True)
        ]
    )
    kept: dict[str, list[RestingPose]] = {m.name: [] for m in models}
    for (model, _), rest, pose in zip(cases, again, ended, strict=True):
        steady = rest.shift_m < MAX_SHIFT / 2 and rest.turn_rad < MAX_TURN / 2
        if steady:
            _join(kept[model.name], pose)
    return [_shares_to_one(kept[m.name]) for m in models]


def _join(poses: list[RestingPose], pose: RestingPose) -> None:
    """Add a pose, or its probability to one with the same side down."""
    up = quat_to_matrix(pose.quat_wxyz)[2]
    for index, other in enumerate(poses):
        if quat_to_matrix(other.quat_wxyz)[2] @ up > np.cos(SAME_TURN):
            poses[index] = replace(other, probability=other.probability + pose.probability)
            return
    poses.append(pose)


def _shares_to_one(poses: list[RestingPose]) -> tuple[RestingPose, ...]:
    total = sum(pose.probability for pose in poses)
    return tuple(replace(pose, probability=pose.probability / total) for pose in poses)


def steady_stands(models: Sequence[ObjectModel]) -> list[tuple[str, ...]]:
    """Kinds of fixture that hold each model still; a round one may turn about its own axis."""
    cases: list[tuple[ObjectModel, Presentation]] = []
    for model in models:
        for kind in STANDS:
            with suppress(InputError):
                cases.append((model, place(model, kind)))
    held: dict[str, list[str]] = {m.name: [] for m in models}
    for (model, presentation), rest in zip(cases, settle(cases), strict=True):
        round_about_x = 0 in symmetry_axes(np.array(model.extents_m), model.com, model.inertia)
        turn = rest.tilt_rad if round_about_x else rest.turn_rad
        if rest.shift_m <= MAX_SHIFT and turn <= MAX_TURN:
            held[model.name].append(presentation.kind)
    return [tuple(held[m.name]) for m in models]
