"""What stands in the scene: ground, table, objects with their fixtures, lights and cameras."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import sapien
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.sensors.camera import CameraConfig
from mani_skill.utils import sapien_utils
from mani_skill.utils.building.ground import build_ground
from mani_skill.utils.structs import Actor, Articulation
from mani_skill.utils.structs.pose import Pose

from maniskill_taskgrasp.assets.objects.actor import add_fixture, add_object
from maniskill_taskgrasp.tasks.noise import Noise, draw_friction
from maniskill_taskgrasp.tasks.placement import Placement

ROBOT_POSE = sapien.Pose([-0.85, 0.0, 0.152])
"""The arm's base in the world: the object stands 0.85 m ahead, the table top 0.152 m below (fact
sheet, sections 1.5 and 5.1)."""
FLOOR = 0.152 - 0.918  # [m] the pedestal's foot stands on it.
TABLE_SIZE = (1.0, 1.4, 0.04)  # [m]
TABLE_CENTRE_X = 0.10  # [m] leaves room for the pedestal.
TABLE_FRICTION = 0.5  # Fact sheet, section 5.1.
TABLE_COLOUR = (0.72, 0.56, 0.40, 1.0)
LEG_COLOUR = (0.25, 0.25, 0.27, 1.0)
SOLVER_ITERATIONS = 12
LIGHT = 0.036  # [kg] lighter things ask for more iterations, in proportion, up to:
MOST_ITERATIONS = 48


def build_table(scene: ManiSkillScene) -> None:
    """A plain table whose top is z = 0, on legs, above the ground."""
    build_ground(scene, altitude=FLOOR)
    builder = scene.create_actor_builder()
    half = np.asarray(TABLE_SIZE) / 2
    material = sapien.physx.PhysxMaterial(TABLE_FRICTION, TABLE_FRICTION, 0.0)
    top = sapien.Pose([TABLE_CENTRE_X, 0.0, -half[2]])
    builder.add_box_collision(top, half, material)
    if scene.can_render():
        wood = sapien.render.RenderMaterial(base_color=TABLE_COLOUR, roughness=0.7)
        steel = sapien.render.RenderMaterial(base_color=LEG_COLOUR, roughness=0.4, metallic=0.6)
        builder.add_box_visual(top, half, wood)
        height = -FLOOR - TABLE_SIZE[2]
        for x in (-0.45, 0.45):
            for y in (-0.64, 0.64):
                leg = sapien.Pose([TABLE_CENTRE_X + x, y, FLOOR + height / 2])
                builder.add_box_visual(leg, [0.025, 0.025, height / 2], steel)
    builder.initial_pose = sapien.Pose()
    builder.build_static("table")


def build_objects(scene: ManiSkillScene, placements: list[Placement]) -> tuple[Actor, Actor]:
    """One object and one fixture for each environment; the fixture of a bare table is empty.

    Fixtures are kinematic: an episode's noise moves them with the object that they carry.
    """
    objects, fixtures = [], []
    for env, placement in enumerate(placements):
        builder = scene.create_actor_builder()
        builder.set_scene_idxs([env])
        add_object(builder, placement.model, visual=scene.can_render())
        builder.initial_pose = sapien.Pose(placement.position, placement.quat_wxyz)
        objects.append(builder.build(f"object-{env}"))
        iterations = solver_iterations(placement.model.mass_kg)
        objects[-1]._bodies[0].set_solver_position_iterations(iterations)
        builder = scene.create_actor_builder()
        builder.set_scene_idxs([env])
        add_fixture(builder, placement.presentation, visual=scene.can_render())
        builder.initial_pose = Pose.create(placement.fixture_pose)
        fixtures.append(builder.build_kinematic(f"fixture-{env}"))
    return _merged(scene, objects, "object"), _merged(scene, fixtures, "fixture")


def solver_iterations(mass: float) -> int:
    """Position iterations that a squeezed object of a mass [kg] needs.

    The solver passes force from finger to finger through the object, a little each iteration and
    the less the lighter it is. Measured on a pinched cylinder of 8 x 14 mm, 0.6 Nm motors: 8 N in
    the end, of which 12 iterations reach 6.2 N at 30 g and 1.7 N at 12.5 g, 36 reach 7.6 N there.
    """
    return min(MOST_ITERATIONS, math.ceil(SOLVER_ITERATIONS * max(1.0, LIGHT / mass)))


def _merged(scene: ManiSkillScene, actors: list[Actor], name: str) -> Actor:
    """Actors of all environments as one, whose state stands for theirs."""
    for actor in actors:
        scene.remove_from_state_dict_registry(actor)
    merged = Actor.merge(actors, name)
    scene.add_to_state_dict_registry(merged)
    return merged


def render_camera() -> CameraConfig:
    """Looks at the object and the hand from the front left, the arm behind them."""
    pose = sapien_utils.look_at([0.62, 0.46, 0.36], [-0.06, 0.0, 0.15])
    return CameraConfig("render_camera", pose, 640, 480, 0.9, 0.01, 100)


def sensor_camera() -> CameraConfig:
    """The view of visual observations."""
    pose = sapien_utils.look_at([0.6, 0.0, 0.5], [0.0, 0.0, 0.1])
    return CameraConfig("base_camera", pose, 128, 128, np.pi / 3, 0.01, 100)


def add_lights(scene: ManiSkillScene, shadow: bool) -> None:
    """Soft daylight from the front left, a weak fill from behind."""
    scene.set_ambient_light([0.45, 0.45, 0.45])
    scene.add_directional_light(
        [-0.6, -0.5, -1.0], [1.1, 1.1, 1.05], shadow=shadow, shadow_scale=2, shadow_map_size=2048
    )
    scene.add_directional_light([0.7, 0.6, -0.8], [0.5, 0.5, 0.55])


def randomize(
    obj: Actor, robot: Articulation, placements: list[Placement], noise: Noise, rngs: list[Any]
) -> None:
    """Draw friction and mass of each environment's object, before the first physics step."""
    for env, (placement, rng) in enumerate(zip(placements, rngs, strict=True)):
        friction = draw_friction(noise, placement.model.friction, rng)
        body = obj._bodies[env]
        factor = rng.uniform(*noise.mass)
        body.set_mass(body.mass * factor)
        body.set_inertia(body.inertia * factor)
        set_friction(body, friction)
        for link in robot.links:
            set_friction(link._bodies[env], friction)


def set_friction(body: sapien.physx.PhysxRigidBaseComponent, coefficient: float) -> None:
    """Give all shapes of a body one coefficient of friction, static and dynamic.

    The solver averages the coefficients of the two sides, so hand and object both get it.
    """
    material = sapien.physx.PhysxMaterial(coefficient, coefficient, 0.0)
    for shape in body.get_collision_shapes():
        shape.set_physical_material(material)
