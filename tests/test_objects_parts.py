"""Laws of convex parts: they have the mesh's volume and do not stick out of it."""

import pytest
import trimesh

from maniskill_taskgrasp.assets.objects.closeness import (
    MAX_PROTRUSION,
    MAX_VOLUME_ERROR,
    part_hulls,
    protrusion,
    volume_error,
)
from maniskill_taskgrasp.assets.objects.compiler import shape
from maniskill_taskgrasp.assets.objects.library import names
from maniskill_taskgrasp.assets.objects.recipe import load_recipes
from maniskill_taskgrasp.assets.objects.solid import union_mesh

FEW = names()[::14]  # Fast tests look at these, the slow one at all.


def check(name):
    solid = shape(load_recipes()[name])
    body = union_mesh([(p.vertices, p.faces) for p in solid.pieces if p.parts])
    hulls = part_hulls([part for piece in solid.pieces for part in piece.parts])
    assert volume_error(body, hulls) <= MAX_VOLUME_ERROR, name
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
