"""Laws of the geometry below the objects, against closed forms."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from maniskill_taskgrasp.assets.objects.geometry import (
    depth_inside,
    few_corners,
    matrix_to_quat,
    part_corners,
    parts_bounds,
    quat_to_matrix,
    rotation_between,
    spread_points,
)
from maniskill_taskgrasp.assets.objects.lathe import lathe_mesh, lathe_sections
from maniskill_taskgrasp.assets.objects.model import Part
from maniskill_taskgrasp.assets.objects.pieces import bent, box, rod, turned
from maniskill_taskgrasp.assets.objects.solid import assemble, mass_properties
from maniskill_taskgrasp.assets.objects.store import part_from_json, part_to_json


def random_rotation(rng):
    q = rng.normal(size=4)
    return quat_to_matrix(q / np.linalg.norm(q))


def test_quaternion_and_matrix_are_inverse():
    """Round trip over random rotations and the half turns, where naive formulas break."""
    rng = np.random.default_rng(0)
    rotations = [random_rotation(rng) for _ in range(50)]
    rotations += [np.diag(d) for d in ([1, -1, -1], [-1, 1, -1], [-1, -1, 1])]
    for rotation in rotations:
        np.testing.assert_allclose(quat_to_matrix(matrix_to_quat(rotation)), rotation, atol=1e-9)
        assert matrix_to_quat(rotation)[0] >= 0


@pytest.mark.parametrize("end", [(0, 0, 1), (1, 0, 0), (-1, 0, 0), (0.6, -0.8, 0)])
def test_rotation_between_takes_one_direction_to_the_other(end):
    """Opposite directions too."""
    rotation = rotation_between((1, 0, 0), end)
    np.testing.assert_allclose(rotation @ (1, 0, 0), end, atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1)


PARTS = [
    Part(
        "box",
        (0.01, 0, 0),
        matrix_to_quat(random_rotation(np.random.default_rng(1))),
        (0.03, 0.02, 0.01),
    ),
    Part(
        "cylinder",
        (0, 0.01, 0),
        matrix_to_quat(random_rotation(np.random.default_rng(2))),
        (0.02, 0.05),
    ),
    Part("sphere", (0, 0, 0.01), size=(0.02,)),
    Part(
        "capsule",
        (0, 0, 0),
        matrix_to_quat(random_rotation(np.random.default_rng(3))),
        (0.01, 0.03),
    ),
    Part("convex", vertices=np.random.default_rng(4).normal(size=(20, 3)) * 0.02),
]


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.kind)
def test_corners_lie_on_the_part_and_within_its_box(part):
    """Corners have depth 0; the exact box holds them and is at most 3 % larger."""
    corners = part_corners(part, 64)
    depth = depth_inside(part, corners)
    assert depth.min() > -1e-9
    assert depth.max() < 1e-9 or part.kind == "convex"
    low, high = parts_bounds([part])
    assert (corners >= low - 1e-9).all() and (corners <= high + 1e-9).all()
    np.testing.assert_allclose(np.ptp(corners, axis=0), high - low, rtol=0.03)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.kind)
def test_part_survives_json(part):
    """Rounded to a micrometre and no more."""
    back = part_from_json(part_to_json(part))
    np.testing.assert_allclose(part_corners(back), part_corners(part), atol=3e-6)


def test_spread_points_avoid_the_inside_of_a_union():
    """Of two overlapping spheres no point is inside the other."""
    parts = [Part("sphere", (x, 0.0, 0.0), size=(0.02,)) for x in (0.0, 0.015)]
    points = spread_points(parts, 64, seed=0).astype(float)
    for part in parts:
        assert depth_inside(part, points).max() < 5e-4  # Facets of the spheres' triangulation.


def test_few_corners_keep_the_volume():
    """A fine ellipsoid of 1,000 corners keeps its volume within 3 % with 64."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(1000, 3))
    points *= np.array([0.06, 0.03, 0.01]) / np.linalg.norm(points, axis=1, keepdims=True)
    chosen = few_corners(points)
    assert len(chosen) <= 64
    assert ConvexHull(chosen).volume == pytest.approx(ConvexHull(points).volume, rel=0.03)


def test_turned_solid_has_the_volume_of_the_profile():
    """Mesh and parts of a cone frustum on a cylinder: pi h (R^2 + R r + r^2) / 3 + pi R^2 h."""
    big, small, low, high = 0.03, 0.01, 0.05, 0.04
    exact = np.pi * (big**2 * low + high * (big**2 + big * small + small**2) / 3)
    piece = turned([(0, big), (low, big), (low + high, small)], "#ffffff")
    volume, _, _ = mass_properties(assemble([piece]))
    assert volume == pytest.approx(exact, rel=0.01)
    assert sum(ConvexHull(part_corners(p, 64)).volume for p in piece.parts) == pytest.approx(
        exact, rel=0.02
    )


def test_hollow_profiles_are_cut_where_they_are_hollow():
    """A dumbbell becomes three parts, end to end; a shallow groove of 0.5 mm is bridged."""
    dumbbell = np.array(
        [(0, 0.03), (0.02, 0.03), (0.02, 0.01), (0.08, 0.01), (0.08, 0.03), (0.1, 0.03)]
    )
    assert [part.kind for part in lathe_sections(dumbbell, 1.0)] == ["cylinder"] * 3
    groove = np.array([(0, 0.03), (0.05, 0.0295), (0.1, 0.03)])
    assert len(lathe_sections(groove, 1.0)) == 1


def test_lathe_mesh_is_closed_and_outward():
    """Every edge has two faces that run along it in opposite directions; the volume is positive."""
    vertices, faces = lathe_mesh(np.array([(0, 0.0), (0.03, 0.02), (0.05, 0.02), (0.06, 0.0)]), 12)
    edges = [tuple(face[[i, (i + 1) % 3]]) for face in faces for i in range(3)]
    assert len(set(edges)) == len(edges)
    assert all((b, a) in set(edges) for a, b in edges)
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0


def test_assembly_sorts_axes_and_keeps_handedness():
    """A tall box is laid along x; what was marked as grasped keeps its extents."""
    solid = assemble([box(0.02, 0.03, 0.1, "#ffffff").held(), rod(0.005, 0.02, "#ffffff")])
    np.testing.assert_allclose(solid.extents, [0.1, 0.03, 0.02])
    np.testing.assert_allclose(solid.grasped_box[1], [0.1, 0.03, 0.02])
    assert np.linalg.det(solid.design_to_object) == pytest.approx(1)


def test_bent_bar_follows_its_path():
    """The capsules of a bent bar hold every point of its path, and its mesh is closed."""
    path = [(0.0, 0.0, 0.0), (0.03, 0.0, 0.0), (0.03, 0.03, 0.0), (0.0, 0.03, 0.01)]
    piece = bent(path, 0.004, "#ffffff")
    depth = np.max([depth_inside(part, np.array(path)) for part in piece.parts], axis=0)
    np.testing.assert_allclose(depth, 0.004, atol=1e-9)
    assert mass_properties(assemble([piece]))[0] > 0
