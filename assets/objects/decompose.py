"""A mesh mended, thinned out and cut into a few convex parts."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.closeness import MAX_PROTRUSION, part_hulls, protrusion
from maniskill_taskgrasp.assets.objects.geometry import few_corners
from maniskill_taskgrasp.assets.objects.model import Part
from maniskill_taskgrasp.assets.objects.solid import thinned, union_mesh

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

MAX_PARTS = 24
MAX_DRAWN_FACES = 60_000
MAX_CUT_FACES = 4_000  # CoACD's time grows with them; its own closing makes as many.
CRUMPLED = 2.0  # Area, in those of the hull, above which half of the faces must do: a cup has 1.8,
# a bath sponge 2.8, which took ten minutes.
CONVEX_SHARE = 0.94  # A closed mesh that fills its hull so far is one part.
CONCAVITY = 0.001  # [m] that CoACD leaves in a part, as it measures it,
MAX_CONCAVITY = 0.1  # at most and at least in halves of the longest extent: finer takes long,
MIN_CONCAVITY, MIN_OPEN_CONCAVITY = 0.025, 0.05  # and CoACD's closing of open meshes is coarse.
OUTGROW = 0.0005  # [m] by which a part of few corners may outgrow its shape.
CRUMB = 0.003  # A part of a smaller share of the volume is left out,
CRUMB_REACH = 0.001  # [m] unless it reaches farther than the others by so much.
SNAP_SAMPLES = 20_000
SEED = 0


def mend(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The mesh without doubled or degenerate faces, wound outward, small holes closed, thinned."""
    import trimesh

    mesh = trimesh.Trimesh(mesh.vertices, mesh.faces, process=True)
    mesh.update_faces(mesh.nondegenerate_faces() & mesh.unique_faces())
    mesh.remove_unreferenced_vertices()
    mesh.merge_vertices()
    mesh = thinned(mesh, MAX_DRAWN_FACES)
    if not mesh.is_watertight:
        mesh.fill_holes()
    with np.errstate(divide="ignore", invalid="ignore"):  # An open mesh may enclose no volume yet.
        mesh.fix_normals()
    return _outer_surface(mesh) if mesh.is_volume else mesh


def _outer_surface(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """A closed mesh without what lies inside: bodies that overlap and cavities count once."""
    bodies = mesh.split(only_watertight=False)
    return mesh if len(bodies) < 2 else union_mesh([(b.vertices, b.faces) for b in bodies])


def convex_parts(mesh: trimesh.Trimesh) -> tuple[Part, ...]:
    """At most `MAX_PARTS` convex parts that cover the mesh; one if that does as well.

    The mesh need not be closed: CoACD closes it first.
    """
    whole = _parts([mesh.convex_hull.vertices])
    hull_volume = float(mesh.convex_hull.volume)
    if mesh.is_volume and mesh.volume >= CONVEX_SHARE * hull_volume and _follows(mesh, whole):
        return whole
    crumpled = mesh.area > CRUMPLED * mesh.convex_hull.area
    outline = thinned(mesh, MAX_CUT_FACES // 2 if crumpled else MAX_CUT_FACES)
    pieces = _cut(outline)
    if not outline.is_volume:
        pieces = _snapped(pieces, mesh)
    volumes = [_volume(piece) for piece in pieces]
    parts = _parts(_without_crumbs(pieces, volumes))
    # Many parts that miss the limit as well are worth no more than the hull.
    full = len(parts) > 1 and sum(volumes) >= CONVEX_SHARE * hull_volume
    if full and (_follows(mesh, whole) or not _follows(mesh, parts)):
        return whole
    return parts


def _without_crumbs(pieces: list[Array], volumes: list[float]) -> list[Array]:
    """The pieces but for small ones without which the whole is as long, wide and high."""
    least = CRUMB * sum(volumes)
    large = np.concatenate([p for p, v in zip(pieces, volumes, strict=True) if v > least])
    low, high = large.min(axis=0) - CRUMB_REACH, large.max(axis=0) + CRUMB_REACH
    return [
        p
        for p, v in zip(pieces, volumes, strict=True)
        if v > least or (v > 0 and ((p < low) | (p > high)).any())
    ]


def _parts(pieces: list[Array]) -> tuple[Part, ...]:
    return tuple(Part("convex", vertices=few_corners(p, outgrow=OUTGROW)) for p in pieces)


def _follows(mesh: trimesh.Trimesh, parts: Sequence[Part]) -> bool:
    return protrusion(mesh, part_hulls(parts), MAX_PROTRUSION) <= MAX_PROTRUSION


def _cut(mesh: trimesh.Trimesh) -> list[Array]:
    """Corners (n, 3) of each of CoACD's convex pieces, unscaled."""
    import coacd

    coacd.set_log_level("error")
    middle, size = mesh.bounds.mean(axis=0), float(mesh.extents.max())
    least = MIN_CONCAVITY if mesh.is_volume else MIN_OPEN_CONCAVITY
    body = coacd.Mesh((mesh.vertices - middle) / size, mesh.faces)
    with quiet():
        pieces = coacd.run_coacd(
            body,
            threshold=float(np.clip(2 * CONCAVITY / size, least, MAX_CONCAVITY)),
            max_convex_hull=MAX_PARTS,
            preprocess_resolution=_closing_resolution(mesh),
            resolution=500,
            mcts_iterations=15,
            mcts_nodes=10,
            mcts_max_depth=2,
            seed=SEED,
        )
    corners = [np.asarray(vertices, dtype=float) * size + middle for vertices, _ in pieces]
    return [c for c in corners if len(c) >= 4 and np.ptp(c, axis=0).min() > 1e-5]


def _snapped(pieces: list[Array], mesh: trimesh.Trimesh) -> list[Array]:
    """Each piece shrunk to the mesh's surface within it: CoACD's closing swells a mesh."""
    from scipy.spatial import ConvexHull

    samples, _ = mesh.sample(SNAP_SAMPLES, return_index=True, seed=SEED)
    points = np.concatenate([mesh.vertices, samples])
    out = []
    for piece in pieces:
        planes = ConvexHull(piece).equations
        inside = (points @ planes[:, :3].T + planes[:, 3]).max(axis=1) < 1e-6
        snapped = points[inside]
        solid = len(snapped) > 8 and np.ptp(snapped, axis=0).min() > 1e-4
        out.append(snapped if solid else piece)
    return out


def _closing_resolution(mesh: trimesh.Trimesh) -> int:
    """Voxels along the mesh for CoACD's closing of an open one, for about `MAX_CUT_FACES` faces.

    Measured: a cube-like mesh, of area 5.2 length^2, gets 37,400 faces at 30 voxels.
    """
    area = min(float(mesh.area), 1.5 * float(mesh.convex_hull.area)) / mesh.extents.max() ** 2
    voxels = 30 * np.sqrt(2 * MAX_CUT_FACES / 37_400 * 5.2 / area)
    return int(np.clip(voxels, 12, 40))


def _volume(corners: Array) -> float:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(corners).volume)
    except QhullError:
        return 0.0


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Drop native libraries' own prints: stdout may be a JSON answer."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = [os.dup(1), os.dup(2)]
    sink = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(sink, 1)
        os.dup2(sink, 2)
        yield
    finally:
        for number, copy in zip((1, 2), saved, strict=True):
            os.dup2(copy, number)
            os.close(copy)
        os.close(sink)
