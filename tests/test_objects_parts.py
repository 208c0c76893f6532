"""Laws of convex parts: they have the mesh's volume and do not stick out of it."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from maniskill_taskgrasp.assets.objects.compiler import shape
from maniskill_taskgrasp.assets.objects.geometry import part_corners
from maniskill_taskgrasp.assets.objects.library import names
from maniskill_taskgrasp.assets.objects.recipe import load_recipes
from maniskill_taskgrasp.assets.objects.solid import union_mesh

MAX_VOLUME_ERROR = 0.10
MAX_PROTRUSION = 0.002  # [m]
FEW = names()[::14]  # Fast tests look at these, the slow one at all.


def union_of_parts(name):
    """The object's mesh and the union of its parts, both closed; the parts' hulls."""
    solid = shape(load_recipes()[name])
    body = union_mesh([(p.vertices, p.faces) for p in solid.pieces if p.parts])
    parts = [part for piece in solid.pieces for part in piece.parts]
    hulls = [trimesh.Trimesh(part_corners(part, 64)).convex_hull for part in parts]
    return body, union_mesh([(h.vertices, h.faces) for h in hulls]), hulls


def winding(points, triangles):
    """(n,) how often the triangles (m, 3, 3) wind around each point: 1 inside, 0 outside."""
    a, b, c = np.moveaxis(triangles[None] - points[:, None, None], 2, 0)
    na, nb, nc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    above = np.einsum("nmk,nmk->nm", a, np.cross(b, c))
    below = na * nb * nc + (a * b).sum(2) * nc + (b * c).sum(2) * na + (c * a).sum(2) * nb
    return np.arctan2(above, below).sum(axis=1) / (2 * np.pi)


def protrusion(body, hulls):
    """[m] farthest corner or face centre of a part outside the mesh."""
    points = np.concatenate([np.concatenate([h.vertices, h.triangles_center]) for h in hulls])
    samples, _ = trimesh.sample.sample_surface(body, 6000, seed=0)
    near = cKDTree(np.concatenate([samples, body.vertices])).query(points)[0]
    doubtful = points[near > 0.6 * MAX_PROTRUSION]  # The samples' distance is an upper bound.
    worst = 0.0
    for point in doubtful[winding(doubtful, body.triangles) < 0.5] if len(doubtful) else ():
        closest = trimesh.triangles.closest_point(
            body.triangles, np.tile(point, (len(body.faces), 1))
        )
        worst = max(worst, float(np.linalg.norm(closest - point, axis=1).min()))
    return worst


def check(name):
    body, union, hulls = union_of_parts(name)
    assert abs(union.volume / body.volume - 1) <= MAX_VOLUME_ERROR, name
    assert protrusion(body, hulls) <= MAX_PROTRUSION, name


@pytest.mark.parametrize("name", FEW)
def test_parts_have_the_volume_of_the_mesh_and_stay_in_it(name):
    """Within 10 % in volume and 2 mm in distance."""
    check(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_parts_of_every_object_have_the_volume_of_the_mesh_and_stay_in_it(name):
    """The same for all."""
    check(name)


def test_protrusion_is_measured():
    """A hull that sticks out by 5 mm is seen to: the check can fail."""
    body = trimesh.creation.box((0.1, 0.02, 0.02))
    hull = trimesh.creation.box((0.11, 0.01, 0.01))
    assert protrusion(body, [hull]) == pytest.approx(0.005, abs=2e-4)
