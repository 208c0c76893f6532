"""Sensing: closed forms of forces and distances; both against SAPIEN's shapes and contacts."""

import gymnasium as gym
import numpy as np
import pytest
import sapien
import torch
from scipy.optimize import nnls

import maniskill_taskgrasp  # noqa: F401  (Registers the task.)
from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.agents.robot_model import Box
from maniskill_taskgrasp.agents.rotations import pose_to_frame, quat_multiply, quat_to_matrix
from maniskill_taskgrasp.agents.sawyer_ar10.description import PART_PRIMITIVES, SENSED_PRIMITIVES
from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.assets.objects.geometry import depth_inside
from maniskill_taskgrasp.assets.objects.model import Part
from maniskill_taskgrasp.tasks.closing import ConstantClosing
from maniskill_taskgrasp.tasks.offset import STEP, displaced
from maniskill_taskgrasp.tasks.sensing import (
    HandBoxes,
    ObjectSurfaces,
    part_distances,
    part_forces,
    patch_distance,
)
from maniskill_taskgrasp.tasks.surface import make_surface, surface_of

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


def test_part_forces_add_vectors_before_their_length_is_taken():
    links = torch.tensor([[[3.0, 0, 0], [0, 4, 0], [0, 0, 2], [0, 0, -2]]])
    forces = part_forces(links, torch.tensor([0, 0, 1, 1]), 3)
    torch.testing.assert_close(forces, torch.tensor([[5.0, 0.0, 0.0]]))


@pytest.mark.parametrize(
    ("middle", "axes", "expected"),
    [
        ([0, 0, 3], [[1, 0, 0], [0, 1, 0]], 2.0),  # Parallel to the face it looks at.
        ([3, 0, 0], [[0, 0, 1], [0, 1, 0]], 2.0),
        ([3, 0, 0], [[1, 0, 0], [0, 1, 0]], 1.0),  # Its rim comes nearer than its middle.
        ([2, 2, 0], [[0, 0, 0], [0, 0, 0]], np.sqrt(2.0)),  # A point, past an edge.
        ([2, 2, 5], [[0, 0, 9], [0, 0, 0]], np.sqrt(2.0)),  # A sharp edge along the box's own.
        ([0, 0, 0.5], [[1, 0, 0], [0, 1, 0]], 0.0),  # Inside.
        ([0, 5, 1], [[0, 4, 0], [1, 0, 0]], 0.0),  # Reaches just to the box.
    ],
)
def test_patch_distance_known_answers(middle, axes, expected):
    patch = torch.tensor([middle, *axes], dtype=torch.float32).T[None]
    distance = patch_distance(patch, torch.ones(1, 3, 1))
    torch.testing.assert_close(distance, torch.tensor([expected], dtype=torch.float32))


def boxes_of(sizes):
    """A hand with one link and one box of these sizes [m] for each part."""
    primitives = {
        part: (("link-" + part, Box(name=part, size=tuple(size))),)
        for part, size in zip(PARTS, sizes, strict=True)
    }
    return HandBoxes.of(primitives, ["link-" + part for part in PARTS], torch.device("cpu"))


def felt(links, boxes, surfaces, obj):
    """Distances (num_envs, num_parts) for poses of links (num_envs, num_links, 7) and objects."""
    frames = pose_to_frame(obj)[:, None]
    return part_distances(pose_to_frame(links), boxes, surfaces, frames)[:, 0]


def random_poses(generator, *shape, spread=0.2):
    """(*shape, 7) [m, wxyz]"""
    quat = torch.randn(*shape, 4, generator=generator)
    place = spread * torch.randn(*shape, 3, generator=generator)
    return torch.cat([place, quat / quat.norm(dim=-1, keepdim=True)], -1)


def test_distance_to_a_ball_is_that_to_its_centre_less_its_radius():
    """And never below zero: 0 is contact."""
    generator = torch.Generator().manual_seed(0)
    sizes = torch.rand(len(PARTS), 3, generator=generator) * 0.08 + 0.01
    boxes, num_envs, radius = boxes_of(sizes.tolist()), 32, 0.04
    ball = make_surface([Part("sphere", size=(radius,))])
    surfaces = ObjectSurfaces.of([ball] * num_envs, torch.device("cpu"))
    links = random_poses(generator, num_envs, 6, spread=0.05)
    obj = random_poses(generator, num_envs, spread=0.05)
    to_ball = (obj[:, None, :3] - links[..., :3])[..., None]
    local = (quat_to_matrix(links[..., 3:]).transpose(-1, -2) @ to_ball)[..., 0]
    expected = ((local.abs() - sizes / 2).clamp(min=0).norm(dim=-1) - radius).clamp(min=0)
    assert (expected == 0).any() and (expected > 0.05).any()
    outside = (local.abs() + sizes / 2).norm(dim=-1) > radius  # Not swallowed by the ball.
    distances = felt(links, boxes, surfaces, obj)
    torch.testing.assert_close(distances[outside], expected[outside], atol=1e-3, rtol=0)


def test_distances_do_not_depend_on_where_the_world_is():
    """Hand and object moved together feel the same; the order of environments is kept."""
    generator = torch.Generator().manual_seed(1)
    boxes = boxes_of([(0.02, 0.03, 0.05)] * len(PARTS))
    models = [library.load(name) for name in ("hammer", "mug", "book")]
    surfaces = ObjectSurfaces.of([surface_of(m) for m in models], torch.device("cpu"))
    links, obj = random_poses(generator, 3, 6), random_poses(generator, 3)
    here = felt(links, boxes, surfaces, obj)
    move = random_poses(generator, 1)[0]

    def moved(poses):
        turned = (quat_to_matrix(move[3:]) @ poses[..., :3, None])[..., 0] + move[:3]
        return torch.cat(
            [turned, quat_multiply(move[3:].expand_as(poses[..., 3:]), poses[..., 3:])], -1
        )

    torch.testing.assert_close(
        felt(moved(links), boxes, surfaces, moved(obj)), here, atol=2e-5, rtol=0
    )
    order = torch.tensor([2, 0, 1])
    mixed = ObjectSurfaces.of([surface_of(models[i]) for i in order], torch.device("cpu"))
    torch.testing.assert_close(
        felt(links[order], boxes, mixed, obj[order]), here[order], atol=1e-6, rtol=0
    )


def test_poses_near_the_first_feel_what_each_would_by_itself():
    """The cells of the first pose serve all: for steps as the estimate of the object's place takes
    them that is the same nearly always, and seldom more than a millimetre off."""
    generator = torch.Generator().manual_seed(2)
    names, num_envs = ("hammer", "mug", "book", "screwdriver"), 32
    boxes = boxes_of([(0.02, 0.03, 0.05)] * len(PARTS))
    models = [library.load(name) for name in names] * (num_envs // len(names))
    surfaces = ObjectSurfaces.of([surface_of(m) for m in models], torch.device("cpu"))
    links = random_poses(generator, num_envs, 6, spread=0.1)
    obj = random_poses(generator, num_envs, spread=0.05)
    steps = torch.cat([torch.zeros(1, 3), torch.diag(torch.tensor(STEP))])
    several = displaced(obj[:, None], torch.zeros(1, 3), steps.expand(num_envs, -1, -1))
    alone = [felt(links, boxes, surfaces, pose) for pose in several.unbind(1)]
    together = part_distances(pose_to_frame(links), boxes, surfaces, pose_to_frame(several))
    off = (together - torch.stack(alone, 1)).abs()
    assert (off > 1e-5).float().mean() < 0.05
    assert (off > 1e-3).float().mean() < 0.005
    torch.testing.assert_close(together[:, 0], alone[0], atol=1e-6, rtol=0)
    assert (together[:, 1:] - together[:, :1]).abs().amax((0, 2)).min() > 1e-3  # They do differ.


@pytest.mark.parametrize("name", ["mug", "screwdriver", "book"])
def test_patches_lie_on_the_outside(name):
    """No patch is inside a part or off all of them."""
    model = library.load(name)
    middles = surface_of(model).patches[:, :, 0].reshape(-1, 3).astype(float)
    depth = np.max([depth_inside(part, middles) for part in model.parts], axis=0)
    assert np.abs(depth).max() < 5e-4  # Facets stand for round parts.
    assert surface_of(model) is surface_of(model)


# Independent computation: SAPIEN's shapes, poses and contact lists, and a quadratic programme.


def gap(first, second):
    """Distance [m] of the convex hulls of two point sets (n, 3): a least-squares problem over the
    weights of their corners."""
    middle, n = first.mean(0), len(first)
    sums = np.zeros((2, n + len(second)))
    sums[0, :n], sums[1, n:] = 1e3, 1e3
    spread = 100 * np.concatenate([first - middle, middle - second]).T
    weights, _ = nnls(np.concatenate([spread, sums]), np.r_[0, 0, 0, 1e3, 1e3])
    a, b = weights[:n] / weights[:n].sum(), weights[n:] / weights[n:].sum()
    return np.linalg.norm(a @ first - b @ second)


def core(shape):
    """Corners (n, 3) [m] and radius [m] whose sum is a SAPIEN shape, body frame."""
    radius = 0.0
    if isinstance(shape, sapien.physx.PhysxCollisionShapeBox):
        points = CUBE * shape.half_size
    elif isinstance(shape, sapien.physx.PhysxCollisionShapeSphere):
        points, radius = np.zeros((1, 3)), shape.radius
    elif isinstance(shape, sapien.physx.PhysxCollisionShapeCapsule):
        points, radius = np.array([[-1.0, 0, 0], [1, 0, 0]]) * shape.half_length, shape.radius
    elif isinstance(shape, sapien.physx.PhysxCollisionShapeCylinder):
        turn = np.arange(64) * 2 * np.pi / 64
        ring = shape.radius * np.stack([0 * turn, np.cos(turn), np.sin(turn)], 1)
        along = np.array([shape.half_length, 0, 0])
        points = np.concatenate([ring - along, ring + along])
    else:
        points = np.asarray(shape.vertices) * shape.scale
    pose = shape.local_pose.to_transformation_matrix()
    return points @ pose[:3, :3].T + pose[:3, 3], radius


def placed(points, body):
    pose = body.entity.pose.to_transformation_matrix()
    return points @ pose[:3, :3].T + pose[:3, 3]


def hand_shapes(env, env_idx):
    """Part -> corner sets (8, 3) [m] of SAPIEN's boxes that count as that part."""
    sensed = {part: [b for _, b in SENSED_PRIMITIVES[part]] for part in PARTS}
    found = {part: [] for part in PARTS}
    for part in PARTS:
        for link in env.agent.part_links[part]:
            body = link._bodies[env_idx]
            own = [b for name, b in PART_PRIMITIVES[part] if name == link.name]
            # The palm's link carries the arm's last one as well: its shapes come after its own.
            for primitive, shape in zip(own, body.collision_shapes, strict=False):
                if any(primitive is one for one in sensed[part]):
                    found[part].append(placed(core(shape)[0], body))
    return found


def true_distances(env, env_idx):
    obj = env.obj._bodies[env_idx]
    cores = [core(shape) for shape in obj.collision_shapes]
    targets = [(placed(points, obj), radius) for points, radius in cores]
    hand = hand_shapes(env, env_idx)
    return [
        min(max(gap(box, points) - radius, 0) for box in hand[part] for points, radius in targets)
        for part in PARTS
    ]


def true_forces(env, env_idx):
    part_of = {
        link._bodies[env_idx].entity.global_id: i
        for i, part in enumerate(PARTS)
        for link in env.agent.part_links[part]
    }
    obj = env.obj._bodies[env_idx].entity.global_id
    total = np.zeros((len(PARTS), 3))
    for contact in env.scene.sub_scenes[env_idx].physx_system.get_contacts():
        ids = [body.entity.global_id for body in contact.bodies]
        impulse = sum((np.asarray(p.impulse) for p in contact.points), np.zeros(3))
        for here, there, sign in ((0, 1, 1), (1, 0, -1)):
            if ids[there] == obj and ids[here] in part_of:
                total[part_of[ids[here]]] += sign * impulse
    return np.linalg.norm(total, axis=1) / env.scene.px.timestep


@pytest.mark.parametrize("num_envs", [1, 14])
def test_twelve_observations_agree_with_sapien(num_envs):
    """Distances within 2 mm and forces within 5 % from hover through lift, on both CPU paths."""
    many = {"sim_config": {"scene_config": {"cpu_workers": 1}}} if num_envs > 1 else {}
    env = gym.make(
        "TaskGrasp-v0",
        num_envs=num_envs,
        topology="all" if num_envs > 1 else "power palm abd 2-5",
        obs="paper",
        obs_mode="state_dict",
        render_backend="none",
        **many,
    )
    policy = ConstantClosing(env)
    env.reset(seed=0)
    base, touched = env.unwrapped, 0
    for step in range(1, 71):
        obs, *_ = env.step(policy(None))
        if step not in (6, 20, 36, 48, 70):
            continue
        seen = obs["extra"]
        for i in range(num_envs):
            forces = true_forces(base, i)
            touched += int((forces > 0.05).sum())
            np.testing.assert_allclose(seen["forces"][i], forces, rtol=0.05, atol=1e-3)
            np.testing.assert_allclose(seen["distances"][i], true_distances(base, i), atol=2e-3)
    assert touched > 2 * num_envs
    env.close()
