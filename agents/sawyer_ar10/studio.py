"""Pictures of the robot alone, in any posture: `python -m ...sawyer_ar10.studio FOLDER`.

Draws the two pictures of the documentation. Needs a Vulkan device; Mesa's lavapipe will do.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import sapien
import torch
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.envs.utils.system.backend import parse_sim_and_render_backend
from numpy.typing import NDArray

from maniskill_taskgrasp.agents.sawyer_ar10.build import default_folder
from maniskill_taskgrasp.agents.sawyer_ar10.description import (
    ARM_JOINT_NAMES,
    HAND_JOINT_NAMES,
    SAWYER_AR10,
)
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10

FLOOR = -0.915  # [m] under the pedestal's wheels
BACKDROP = (0.86, 0.87, 0.89)  # linear
OVERSAMPLING = 2
LIGHTS = (  # direction, colour, whether it casts shadows: key, fill and rim light
    ((0.6, 0.9, -1.2), (1.9, 1.85, 1.8), True),
    ((-1.0, 0.4, -0.5), (0.9, 0.9, 1.0), False),
    ((0.3, -1.0, -0.2), (0.5, 0.5, 0.55), False),
)
HAND_IN_STUDIO = sapien.Pose([0, 0, 0.5], [0, 0, 0, 1])  # Palm towards -y, fingers up.
HAND_CENTRE = (-0.02, 0.02, 0.12)  # [m] in hand_base
HAND_FOV = 0.36  # [rad]
PALM_DOWN = (-0.233, -0.432, -0.065, 1.483, -0.294, -1.084, 0.376)  # [rad] palm 0.85 m in front


class Studio:
    """The robot on a bright floor, lit from three sides."""

    def __init__(self) -> None:
        backend = parse_sim_and_render_backend("physx_cpu", "gpu")
        systems = [sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem(backend.render_device)]
        self._stage = sapien.Scene(systems)
        scene = ManiSkillScene([self._stage], device=torch.device("cpu"), backend=backend)
        loader = scene.create_urdf_loader()
        loader.name = SAWYER_AR10.name
        parsed = loader.parse(str(default_folder() / f"{SAWYER_AR10.name}.urdf"))
        builder = parsed["articulation_builders"][0]
        builder.initial_pose = sapien.Pose()
        self.robot = builder.build()
        scene.set_ambient_light([0.45, 0.45, 0.45])
        for direction, colour, shadow in LIGHTS:
            scene.add_directional_light(
                direction, colour, shadow=shadow, shadow_scale=3, shadow_map_size=4096
            )
        self._add_backdrop()

    def _add_backdrop(self) -> None:
        """Floor, and two distant walls that shine in its colour."""
        floor = sapien.render.RenderMaterial()
        floor.base_color = [*BACKDROP, 1.0]
        floor.roughness = 1.0
        wall = sapien.render.RenderMaterial()
        wall.base_color = [0.0, 0.0, 0.0, 1.0]
        wall.emission = [*BACKDROP, 1.0]
        builder = self._stage.create_actor_builder()
        for place, half, material in (
            ((0, 0, FLOOR - 0.01), (30, 30, 0.01), floor),
            ((-15, 0, 0), (0.01, 30, 30), wall),
            ((0, 15, 0), (30, 0.01, 30), wall),
        ):
            builder.add_box_visual(sapien.Pose(place), half_size=half, material=material)
        builder.build_static()

    def pose(self, angles: Mapping[str, float]) -> None:
        """Put arm and hand into a posture, joint name -> [rad]; distal joints follow their pip."""
        angles = dict(angles)
        for coupling in AR10.couplings:
            angles[coupling.joint] = coupling.ratio * angles[coupling.source] + coupling.offset
        names = [joint.name for joint in self.robot.active_joints]
        self.robot.set_qpos(np.array([[angles[name] for name in names]], dtype=np.float32))

    def picture(
        self,
        eye: Sequence[float],
        target: Sequence[float],
        fov: float,
        size: tuple[int, int],
        up: Sequence[float] = (0.0, 0.0, 1.0),
    ) -> NDArray[np.uint8]:
        """(height, width, 3) picture from `eye` [m] towards `target` [m].

        Args:
            eye: camera position in the robot's root frame.
            target: point in the middle of the picture.
            fov: [rad] vertical opening of the camera.
            size: (width, height) in pixels.
            up: direction that points upwards in the picture.
        """
        width, height = (OVERSAMPLING * pixels for pixels in size)
        camera = self._stage.add_camera("camera", width, height, fov, 0.01, 100.0)
        forward = np.subtract(target, eye)
        forward = forward / np.linalg.norm(forward)
        left = np.cross(up, forward)
        left = left / np.linalg.norm(left)
        frame = np.eye(4)
        frame[:3, :3] = np.stack([forward, left, np.cross(forward, left)], axis=1)
        frame[:3, 3] = eye
        camera.entity.set_pose(sapien.Pose(frame))
        self._stage.update_render()
        camera.take_picture()
        colours = np.clip(camera.get_picture("Color")[..., :3], 0.0, 1.0)
        self._stage.remove_entity(camera.entity)
        blocks = colours.reshape(size[1], OVERSAMPLING, size[0], OVERSAMPLING, 3)
        return np.round(255 * blocks.mean(axis=(1, 3))).astype(np.uint8)

    def hand_picture(self, eye: Sequence[float], size: tuple[int, int]) -> NDArray[np.uint8]:
        """(height, width, 3) picture of the hand from `eye` [m], a point in hand_base; fingers up.

        The whole robot is carried round until the palm faces the lights.
        """
        root = self.robot.pose
        self.robot.set_pose(HAND_IN_STUDIO * self.robot.links_map["hand_base"].pose.sp.inv())
        points = [HAND_IN_STUDIO.to_transformation_matrix() @ [*p, 1] for p in (eye, HAND_CENTRE)]
        view = self.picture(points[0][:3], points[1][:3], HAND_FOV, size)
        self.robot.set_pose(root)
        return view


def posture(arm: Sequence[float], hand: Sequence[float]) -> dict[str, float]:
    """Joint angles [rad] by name, from the seven of the arm and the ten of the hand."""
    return dict(zip((*ARM_JOINT_NAMES, *HAND_JOINT_NAMES), (*arm, *hand), strict=True))


def _save(path: Path, picture: NDArray[np.uint8]) -> None:
    from PIL import Image

    Image.fromarray(picture).save(path, optimize=True)


def main(folder: Path) -> None:
    """Write robot.png and hand.png into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    studio = Studio()
    lower = [SAWYER_AR10.joint(name).lower for name in HAND_JOINT_NAMES]
    studio.pose(posture(PALM_DOWN, lower))
    view = studio.picture((2.25, -1.95, 0.7), (0.24, 0.0, -0.16), 0.56, (900, 900))
    _save(folder / "robot.png", view)
    # Thumb, then mcp and pip of the four fingers: open, index pad on thumb pad, fist.
    pinch = [1.33, 0.6, 1.42, 0.8, *(0.5, 0.7) * 3]
    fist = [1.57, 1.5, *(1.57, 1.57) * 4]
    panels = []
    for hand, eye in (
        (lower, (-0.3, 0.8, 0.25)),
        (pinch, (-0.7, 0.55, 0.25)),
        (fist, (-0.3, 0.8, 0.25)),
    ):
        studio.pose(posture(PALM_DOWN, hand))
        panels.append(studio.hand_picture(eye, (420, 560)))
    _save(folder / "hand.png", np.concatenate(panels, axis=1))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
