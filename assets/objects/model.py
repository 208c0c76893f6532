"""What an object is to the simulator: parts, mass, resting poses, and where it came from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maniskill_taskgrasp.assets.objects.geometry import local_hull, spread_points
from maniskill_taskgrasp.knowledge import Affordance

if TYPE_CHECKING:
    import trimesh

PART_KINDS = ("box", "cylinder", "sphere", "capsule", "convex")


@dataclass(frozen=True)
class Part:
    """One convex collision shape, placed in the frame of the thing it belongs to."""

    kind: str
    """One of `PART_KINDS`; cylinders and capsules lie along their own +x, as in SAPIEN."""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """[m]"""
    quat_wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    size: tuple[float, ...] = ()
    """[m] box: half extents; cylinder, capsule: radius, half length; sphere: radius; convex: ()."""
    vertices: NDArray[np.float64] | None = None
    """(n, 3) [m] corners of a convex part before position and quat_wxyz, else None."""

    @cached_property
    def hull(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Triangles (m, 3, 3) [m] and outward planes (k, 4) of the surface before it is placed."""
        return local_hull(self)


@dataclass(frozen=True)
class RestingPose:
    """A way in which the object stays where it is put on a level surface."""

    name: str
    quat_wxyz: tuple[float, float, float, float]
    """Rotation from the object frame to the world, z up."""
    height: float
    """[m] object origin above the surface."""
    probability: float
    """Share of random drops that end so; the shares of an object's poses sum to 1."""


@dataclass(frozen=True)
class ObjectModel:
    """A graspable object. Frame: centre of its axis-aligned box; x longest, z shortest extent."""

    name: str
    extents_m: tuple[float, float, float]
    """Whole object, a >= b >= c [m]; `affordance.dimensions_m` is what people grasped of it."""
    mass_kg: float
    com: NDArray[np.float64]
    """(3,) [m] centre of mass."""
    inertia: NDArray[np.float64]
    """(3, 3) [kg m^2] about `com`, object axes."""
    friction: float
    """Static = dynamic coefficient against the hand."""
    rigidity: str
    affordance: Affordance
    split: str
    """train, test or imported."""
    parts: tuple[Part, ...]
    resting_poses: tuple[RestingPose, ...]
    grasped_center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """[m] centre of the portion people grasp (a mug's handle; the whole of a bottle)."""
    grasped_extents_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """[m] size of that portion along the object's x, y and z."""
    stands: tuple[str, ...] = ()
    """Fixtures that hold the object still, as two seconds of physics showed."""
    material: str = ""
    category: str = ""
    source: str = ""
    licence: str = ""
    watertight: bool = True
    volume_m3: float = 0.0
    """Of the mesh; the parts' union is within 10 %."""
    mesh: Callable[[], trimesh.Trimesh] = field(default=lambda: _no_mesh(), repr=False)

    def visual(self) -> trimesh.Trimesh:
        """Coloured mesh in the object frame [m]; made when first asked for."""
        return self.mesh()

    def surface_points(self, n: int = 64, seed: int = 0) -> NDArray[np.float32]:
        """(n, 3) float32 [m] evenly spread points of the collision surface, object frame."""
        return spread_points(self.parts, n, seed)


def _no_mesh() -> trimesh.Trimesh:
    raise LookupError("this object was made without a mesh")
