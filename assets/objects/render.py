"""Pictures of objects: one with its parts, poses and numbers, and the contact sheet of them all."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.actor import add_fixture, add_object, parts_file
from maniskill_taskgrasp.assets.objects.geometry import (
    part_corners,
    quat_to_matrix,
)
from maniskill_taskgrasp.assets.objects.library import load, names
from maniskill_taskgrasp.assets.objects.model import ObjectModel, RestingPose
from maniskill_taskgrasp.assets.objects.presentation import Presentation, present
from maniskill_taskgrasp.assets.objects.recipe import load_recipes
from maniskill_taskgrasp.errors import InputError, echo

if TYPE_CHECKING:
    import sapien

Image = NDArray[np.uint8]
TILE = 160  # [pixel] edge of a contact sheet's picture.
SHARP = 2  # Pictures of the sheet are drawn so many times larger, then reduced.
CARD = 300  # [pixel] edge of an object card's pictures.
FACING = np.array([0.2, -1.0])  # Where the face of a standing thing is turned.
VIEW = np.array([0.5, -0.66, 0.56])  # Direction from the object to the camera.
FIELD = 0.35  # [rad] vertical field of view: long, so that shapes are hardly distorted.
ROUND = {"non-round": "not round", "abc": "a ball"} | {x: f"round about {x}" for x in "ac"}
SHADES = 0xFC  # Bits kept of each colour in the contact sheet: 64 shades, half the file.
LABEL = 16  # [pixel]
PICTURES = (".png", ".jpg", ".jpeg")


class Studio:
    """A lit scene and a camera, to photograph one object after another.

    Raises:
        InputError: SAPIEN finds no Vulkan device.
    """

    def __init__(self, pixels: int) -> None:
        import sapien

        try:
            # Asked before anything is built: half a scene without a device may crash at exit.
            sapien.render.get_device_summary()
        except RuntimeError as error:
            raise InputError(
                f"no pictures here ({str(error).splitlines()[0]}): install a Vulkan driver, "
                "see the README, Rendering"
            ) from None
        self.scene = sapien.Scene()
        self.camera = self.scene.add_camera("camera", pixels, pixels, FIELD, 0.01, 20)
        self.scene.set_ambient_light([0.55, 0.55, 0.55])
        self.scene.add_directional_light([-0.3, 0.6, -1.0], [0.9, 0.9, 0.88], shadow=True)
        self.scene.add_directional_light([-0.8, -0.2, -0.4], [0.35, 0.35, 0.4])
        ground = self.scene.create_actor_builder()
        matt = sapien.render.RenderMaterial(base_color=(0.8, 0.72, 0.56, 1), roughness=1.0)
        ground.add_box_visual(half_size=(3, 3, 0.005), material=matt)
        ground.set_initial_pose(sapien.Pose([0, 0, -0.005]))
        ground.build_static("ground")

    def photograph(self, entities: Sequence[sapien.Entity], corners: NDArray[np.float64]) -> Image:
        """(pixels, pixels, 3) picture that holds all corners (n, 3) [m]; entities are removed."""
        import sapien

        ahead = -VIEW / np.linalg.norm(VIEW)
        left = np.cross([0, 0, 1], ahead)
        left /= np.linalg.norm(left)
        axes = np.stack([ahead, left, np.cross(ahead, left)], axis=1)
        seen = corners @ axes
        middle = (seen.min(0) + seen.max(0)) / 2
        reach = float(np.ptp(seen[:, 1:], axis=0).max()) / 2 * 1.12
        back = reach / np.tan(FIELD / 2) + float(np.ptp(seen[:, 0])) / 2
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = axes, axes @ middle - ahead * back
        self.camera.entity.set_pose(sapien.Pose(pose))
        self.scene.update_render()
        self.camera.take_picture()
        picture = self.camera.get_picture("Color")[..., :3]
        for entity in entities:
            self.scene.remove_entity(entity)
        return (picture.clip(0, 1) * 255).astype(np.uint8)


def pose_shown(model: ObjectModel) -> RestingPose:
    """The resting pose in which the object is easiest to recognise."""
    a, b, c = model.extents_m
    recipe = load_recipes().get(model.name) if model.split != "imported" else None
    if recipe is not None and recipe.shown:
        wanted = recipe.shown
    elif c < 0.5 * b or (a > 2.4 * b and model.category not in ("bottles", "kitchen")):
        wanted = "lying"
    else:
        wanted = "standing"
    by_name = {pose.name: pose for pose in reversed(model.resting_poses)}
    for name in (wanted, "standing", "lying"):
        if name in by_name:
            return by_name[name]
    return model.resting_poses[0]


def object_picture(
    studio: Studio, model: ObjectModel, shown: RestingPose | Presentation, parts: bool = False
) -> Image:
    """The object on a plain ground, on the table or in its fixture, its x axis to the right.

    Args:
        parts: draw the convex parts, each in its own colour, instead of the mesh.
    """
    import sapien

    rotation = quat_to_matrix(shown.quat_wxyz)
    entities, clouds = [], []
    if isinstance(shown, Presentation) and shown.parts:
        stand = studio.scene.create_actor_builder()
        add_fixture(stand, shown, visual=True)
        entities.append(stand.build_static("stand"))
        clouds += [part_corners(p) for p in shown.parts]
    else:
        rotation = _facing(rotation)
    corners = np.concatenate([part_corners(p) for p in model.parts]) @ rotation.T
    frame = np.eye(4)
    frame[:3, :3] = rotation
    frame[2, 3] = shown.position[2] if isinstance(shown, Presentation) else -corners[:, 2].min()
    builder = studio.scene.create_actor_builder()
    if parts:
        builder.add_visual_from_file(str(parts_file(model)))
        entities.append(builder.set_initial_pose(sapien.Pose(frame)).build_static("parts"))
    else:
        add_object(builder, model, visual=True)
        entities.append(builder.set_initial_pose(sapien.Pose(frame)).build("object"))
    clouds.append(corners + frame[:3, 3])
    return studio.photograph(entities, np.concatenate(clouds))


def _facing(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rotation turned about the vertical: x axis to the right, else the face to the camera."""
    ahead, wanted = rotation[:2, 0], np.array([1.0, 0.0])
    if np.linalg.norm(ahead) < 0.5:
        ahead, wanted = rotation[:2, 2], FACING
    a, b = ahead / np.linalg.norm(ahead), wanted / np.linalg.norm(wanted)
    c, s = a @ b, a[0] * b[1] - a[1] * b[0]
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ rotation


def object_card(model: ObjectModel, path: Path) -> None:
    """Picture file of one object: mesh, convex parts, how it is offered, its poses, its numbers.

    Raises:
        InputError: no picture can be written to that path, or none made here.
    """
    from PIL import Image as Pillow
    from PIL import ImageDraw

    if path.suffix.lower() not in PICTURES:
        raise InputError(f"{echo(path.name)} names no picture: {', '.join(PICTURES)} would do")
    studio = Studio(CARD)
    offered = present(model)
    pictures = [
        ("mesh", object_picture(studio, model, pose_shown(model))),
        (f"{len(model.parts)} parts", object_picture(studio, model, pose_shown(model), parts=True)),
        (f"offered: {offered.kind}", object_picture(studio, model, offered)),
        *(
            (f"{p.name} {p.probability:.0%}", object_picture(studio, model, p))
            for p in model.resting_poses[:6]
        ),
    ]
    columns = 3
    rows = -(-len(pictures) // columns)
    numbers = _numbers(model)
    width, text_top = columns * CARD, rows * (CARD + LABEL) + 8
    card = Pillow.new("RGB", (width, text_top + LABEL * len(numbers) + 8), "white")
    draw = ImageDraw.Draw(card)
    for index, (label, picture) in enumerate(pictures):
        corner = (index % columns * CARD, index // columns * (CARD + LABEL))
        card.paste(Pillow.fromarray(picture), corner)
        draw.text((corner[0] + CARD // 2, corner[1] + CARD), label, "black", anchor="ma")
    for index, line in enumerate(numbers):
        draw.text((8, text_top + LABEL * index), line, "black")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        card.save(path)
    except OSError as error:
        raise InputError(f"cannot write {echo(path)}: {error.strerror}") from None


def _numbers(model: ObjectModel) -> list[str]:
    size, held = (
        " x ".join(f"{100 * e:.1f}" for e in extents) + " cm"
        for extents in (model.extents_m, model.grasped_extents_m)
    )
    return [
        f"{model.name} ({model.split}, {model.category}, {model.material}, {model.rigidity})",
        f"{size}, grasped {held}; {1000 * model.mass_kg:.0f} g, friction {model.friction}",
        f"{model.affordance.shape}, {ROUND[model.affordance.roundness]}; "
        f"stands that hold it: {', '.join(model.stands) or 'none'}",
        present(model).reason,
    ]


def contact_sheet(models: Sequence[ObjectModel], path: Path, columns: int = 14) -> None:
    """Picture file of all models in their most telling pose, with names below."""
    from PIL import Image as Pillow
    from PIL import ImageDraw

    studio, rows = Studio(TILE * SHARP), -(-len(models) // columns)
    sheet = Pillow.new("RGB", (columns * TILE, rows * (TILE + LABEL)), "white")
    draw = ImageDraw.Draw(sheet)
    for index, model in enumerate(models):
        corner = (index % columns * TILE, index // columns * (TILE + LABEL))
        picture = object_picture(studio, model, pose_shown(model))
        sheet.paste(Pillow.fromarray(picture).reduce(SHARP), corner)
        draw.text((corner[0] + TILE // 2, corner[1] + TILE), model.name, "black", anchor="ma")
    path.parent.mkdir(parents=True, exist_ok=True)
    sheet.point(lambda level: level & SHADES).save(path, optimize=True)


if __name__ == "__main__":  # `python -m maniskill_taskgrasp.assets.objects.render FILE`
    contact_sheet([load(name) for name in names()], Path(sys.argv[1]))
