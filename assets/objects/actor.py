"""Objects and fixtures put on a SAPIEN actor builder, with exactly the model's mass and inertia."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.folders import cache_folder
from maniskill_taskgrasp.assets.objects.geometry import matrix_to_quat, part_triangles
from maniskill_taskgrasp.assets.objects.model import ObjectModel, Part
from maniskill_taskgrasp.assets.objects.presentation import FIXTURE_FRICTION, Presentation
from maniskill_taskgrasp.assets.objects.store import write_atomically

if TYPE_CHECKING:
    from pathlib import Path

    import sapien
    import trimesh

PALETTE = (
    (214, 83, 73, 255),
    (66, 133, 190, 255),
    (98, 168, 84, 255),
    (233, 170, 60, 255),
    (146, 104, 178, 255),
    (92, 184, 186, 255),
)
CREASE = np.radians(32.0)  # Steeper edges of the drawn mesh are shown as edges.
FIXTURE_COLOUR = (0.55, 0.45, 0.33, 1.0)


def add_object(builder: sapien.ActorBuilder, model: ObjectModel, visual: bool) -> None:
    """Put the object's parts, mass, inertia, friction and, if `visual`, its mesh on a builder."""
    import sapien

    _add_parts(builder, model.parts, model.friction)
    moments, axes = np.linalg.eigh(model.inertia)
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1
    frame = sapien.Pose(p=model.com, q=matrix_to_quat(axes))
    builder.set_mass_and_inertia(model.mass_kg, frame, moments)
    if visual:
        builder.add_visual_from_file(str(_visual_file(model)))


def add_fixture(builder: sapien.ActorBuilder, presentation: Presentation, visual: bool) -> None:
    """Put the fixture of a presentation on a builder that will be built static or kinematic."""
    import sapien

    _add_parts(builder, presentation.parts, FIXTURE_FRICTION)
    if not visual:
        return
    material = sapien.render.RenderMaterial(base_color=FIXTURE_COLOUR, roughness=0.8)
    for part in presentation.parts:
        pose = sapien.Pose(part.position, part.quat_wxyz)
        if part.kind == "box":
            builder.add_box_visual(pose, part.size, material)
        elif part.kind == "cylinder":
            builder.add_cylinder_visual(pose, part.size[0], part.size[1], material)
        else:
            raise ValueError(f"a fixture is made of boxes and cylinders, not of {part.kind!r}")


def _add_parts(builder: sapien.ActorBuilder, parts: Sequence[Part], friction: float) -> None:
    import sapien

    material = sapien.physx.PhysxMaterial(friction, friction, 0.0)
    for part in parts:
        pose = sapien.Pose(part.position, part.quat_wxyz)
        if part.kind == "box":
            builder.add_box_collision(pose, part.size, material)
        elif part.kind == "sphere":
            builder.add_sphere_collision(pose, part.size[0], material)
        elif part.kind == "cylinder":
            builder.add_cylinder_collision(pose, part.size[0], part.size[1], material)
        elif part.kind == "capsule":
            builder.add_capsule_collision(pose, part.size[0], part.size[1], material)
        else:
            builder.add_convex_collision_from_file(
                str(_convex_file(part)), pose=pose, material=material
            )


def _convex_file(part: Part) -> Path:
    """STL of a convex part before it is placed: SAPIEN's builder takes hulls from files only."""
    assert part.vertices is not None
    triangles = part_triangles(Part("convex", vertices=part.vertices)).astype("<f4")
    records = np.zeros(len(triangles), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    records["v"] = triangles
    content = bytes(80) + struct.pack("<I", len(records)) + records.tobytes()
    return _cached(content, ".stl")


def _visual_file(model: ObjectModel) -> Path:
    """GLB of the object's mesh, one material a colour: SAPIEN shows materials, not face colours."""
    return _cached(_coloured_glb(model.visual()), ".glb")


def parts_file(model: ObjectModel) -> Path:
    """GLB of the object's convex parts, each in its own colour."""
    import trimesh

    pieces = []
    for index, part in enumerate(model.parts):
        triangles = part_triangles(part)
        hull = trimesh.Trimesh(triangles.reshape(-1, 3)).convex_hull
        colour = np.array(PALETTE[index % len(PALETTE)], dtype=np.uint8)
        hull.visual = trimesh.visual.ColorVisuals(
            hull, face_colors=np.tile(colour, (len(hull.faces), 1))
        )
        pieces.append(hull)
    joined: Any = trimesh.util.concatenate(pieces)
    return _cached(_coloured_glb(joined), ".glb")


def _coloured_glb(mesh: trimesh.Trimesh) -> bytes:
    import trimesh

    scene = trimesh.Scene()
    colours: Any = mesh.visual.face_colors  # type: ignore[union-attr]
    for colour in np.unique(colours, axis=0):
        triangles = mesh.triangles[(colours == colour).all(axis=1)]
        faces = np.arange(3 * len(triangles)).reshape(-1, 3)
        part = trimesh.Trimesh(triangles.reshape(-1, 3), faces)
        # Corners are shared across shallow angles only: curves shine, edges stay crisp.
        part = trimesh.graph.smooth_shade(part, angle=CREASE)
        material = trimesh.visual.material.PBRMaterial(
            baseColorFactor=_linear(colour), metallicFactor=0.0, roughnessFactor=0.6
        )
        part.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(part)
    content: bytes = scene.export(file_type="glb")  # type: ignore[assignment]
    return content


def _linear(colour: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """RGBA of the screen (sRGB) as a glTF material wants it: light, not code value."""
    light = (colour / 255.0) ** 2.2
    light[3] = colour[3] / 255.0
    return (255 * light).round().astype(np.uint8)


def _cached(content: bytes, suffix: str) -> Path:
    """File in the cache folder named after its content, written if it is not there."""
    path = cache_folder() / (hashlib.sha256(content).hexdigest()[:24] + suffix)
    if not path.exists():
        write_atomically(path, content)
    return path
