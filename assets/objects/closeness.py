"""How closely convex parts follow their mesh: what they add in volume, how far they stick out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, cKDTree

from maniskill_taskgrasp.assets.objects.geometry import part_corners
from maniskill_taskgrasp.assets.objects.model import Part
from maniskill_taskgrasp.assets.objects.solid import thinned, union_mesh

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

MAX_VOLUME_ERROR = 0.10  # Share by which the parts' volume may differ from a closed mesh's,
MAX_PROTRUSION = 0.002  # [m] and how far a part may stick out of the mesh.
NEGLIGIBLE = 0.0005  # [m] A protrusion below this counts as none.
CIRCLE = 64  # Corners that stand for a circle when round parts are measured.
SURFACE_SAMPLES = 6000  # Points that stand for a mesh's surface, besides its corners.
PART_SAMPLES = 3000  # Points on all parts, besides their corners and the centres of their faces.
WOUND_FACES = 4000  # Most of the mesh by which distance, inside and outside are told.
CHUNK = 64  # Points whose winding is taken at once.


def part_hulls(parts: Sequence[Part]) -> list[trimesh.Trimesh]:
    """Closed surface of each part."""
    import trimesh

    return [trimesh.Trimesh(part_corners(part, CIRCLE)).convex_hull for part in parts]


def remarks(mesh: trimesh.Trimesh, parts: Sequence[Part]) -> list[str]:
    """What there is to tell a user of parts that do not follow their mesh within the limits."""
    hulls, notes = part_hulls(parts), []
    beyond = protrusion(mesh, hulls)
    if beyond > MAX_PROTRUSION:
        notes.append(
            f"convex parts stick out of the mesh by up to {1000 * beyond:.1f} mm (aim: "
            f"{1000 * MAX_PROTRUSION:.0f} mm): narrow hollows are filled"
        )
    error = volume_error(mesh, hulls) if mesh.is_volume else 0.0
    if error > MAX_VOLUME_ERROR:
        notes.append(
            f"convex parts differ from the mesh by {error:.0%} in volume (aim: "
            f"{MAX_VOLUME_ERROR:.0%}): thin walls and hollows are coarse"
        )
    return notes


def volume_error(mesh: trimesh.Trimesh, hulls: Sequence[trimesh.Trimesh]) -> float:
    """Share by which the union of the parts differs in volume from a closed mesh."""
    union = union_mesh([(hull.vertices, hull.faces) for hull in hulls])
    return float(abs(union.volume / mesh.volume - 1))


def protrusion(
    mesh: trimesh.Trimesh, hulls: Sequence[trimesh.Trimesh], enough: float = np.inf
) -> float:
    """[m] how far the union of the parts sticks out of the mesh, at sampled points of its surface.

    The mesh need not be closed: a point is outside where the mesh winds about it less than half.

    Args:
        enough: [m] stop at the first point found farther out; the answer is then its distance.
    """
    coarse = thinned(mesh, WOUND_FACES)
    points = _union_points(hulls)
    bound = _distance_bound(coarse, points)
    order, worst = np.argsort(-bound), NEGLIGIBLE
    for first in range(0, len(order), CHUNK):
        chunk = order[first : first + CHUNK]
        chunk = chunk[bound[chunk] > worst]
        if not len(chunk):
            break
        outside = winding(points[chunk], coarse.triangles) < 0.5
        for point in points[chunk[outside]]:
            worst = max(worst, _distance(coarse, point))
            if worst > enough:
                return worst
    return worst if worst > NEGLIGIBLE else 0.0


def winding(points: Array, triangles: Array) -> Array:
    """(n,) how often the triangles (m, 3, 3) wind around each point: 1 inside, 0 outside."""
    a, b, c = np.moveaxis(triangles[None] - points[:, None, None], 2, 0)
    na, nb, nc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    above = np.einsum("nmk,nmk->nm", a, np.cross(b, c))
    below = na * nb * nc + (a * b).sum(2) * nc + (b * c).sum(2) * na + (c * a).sum(2) * nb
    turns: Array = np.arctan2(above, below).sum(axis=1) / (2 * np.pi)
    return turns


def _union_points(hulls: Sequence[trimesh.Trimesh]) -> Array:
    """(n, 3) points on the hulls that lie in no other hull."""
    area = sum(hull.area for hull in hulls)
    clouds = []
    for index, hull in enumerate(hulls):
        count = int(np.ceil(PART_SAMPLES * hull.area / area))
        samples, *_ = hull.sample(count, return_index=True, seed=index)
        clouds.append(np.concatenate([hull.vertices, hull.triangles_center, samples]))
    for index, hull in enumerate(hulls):
        planes = ConvexHull(hull.vertices).equations
        for other, cloud in enumerate(clouds):
            if other != index and len(cloud):
                beyond = (cloud @ planes[:, :3].T + planes[:, 3]).max(axis=1)
                clouds[other] = cloud[beyond > 1e-6]
    return np.concatenate(clouds)


def _distance_bound(mesh: trimesh.Trimesh, points: Array) -> Array:
    """(n,) [m] at least the distance from each point to the mesh's surface, seldom much more."""
    samples, *_ = mesh.sample(SURFACE_SAMPLES, return_index=True, seed=0)
    bound: Array = cKDTree(np.concatenate([samples, mesh.vertices])).query(points)[0]
    return bound


def _distance(mesh: trimesh.Trimesh, point: Array) -> float:
    """[m] from a point (3,) to the mesh's surface."""
    import trimesh

    closest = trimesh.triangles.closest_point(mesh.triangles, np.tile(point, (len(mesh.faces), 1)))
    return float(np.linalg.norm(closest - point, axis=1).min())
