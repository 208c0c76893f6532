"""What the networks see of an object and an action: measurements, classes and name vectors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from maniskill_taskgrasp.knowledge import Affordance

CATEGORIES: dict[str, tuple[str, ...]] = {
    "grasped_dimension": ("a/b", "a/b/c", "b", "b/c", "c", "floppy"),
    "rigidity": ("rigid", "squeezable", "fragile", "floppy"),
    "roundness": ("a", "abc", "c", "non-round", "floppy"),
    "shape": ("prolate", "oblate", "bladed", "equant", "floppy"),
    "type": (
        *("cubic", "cubic cylinder", "cylinder", "disk", "ellipse A", "ellipse C"),
        *("irregular", "long prism", "short ellipse", "short prism", "sphere", "floppy"),
    ),
}
"""Object attribute -> the data set's values; 32 indicators. An unknown value sets none."""

NAME_WIDTH = 384
"""Length of a sentence vector (all-MiniLM-L6-v2)."""
OBJECT_DIRECTIONS = 48
ACTION_DIRECTIONS = 32
"""Main directions kept of the name vectors for the perceptrons; the kernel uses all of them."""

EncodeName = Callable[[str], np.ndarray]
"""A name -> its sentence vector (384,)."""
Pair = tuple[Affordance, str]
"""An object and the name of an action."""


def measurements(affordance: Affordance) -> np.ndarray:
    """(4,): log(1 + A), log(1 + B), log(1 + C) in cm and log(1 + mass) in g."""
    sizes = [*(100 * d for d in affordance.dimensions_m), 1000 * affordance.mass_kg]
    return np.log1p(np.array(sizes))


def indicators(affordance: Affordance) -> np.ndarray:
    """(32,) 0/1, one per value of `CATEGORIES`; "floppy" is the is-floppy indicator."""
    return np.array(
        [
            float(getattr(affordance, attribute) == value)
            for attribute, values in CATEGORIES.items()
            for value in values
        ]
    )


@dataclass(frozen=True, eq=False)
class NameVectors:
    """Unit sentence vectors of the known names."""

    known: Mapping[str, np.ndarray]
    """Name -> (384,)."""

    def __call__(self, names: Sequence[str], encode: EncodeName | None = None) -> np.ndarray:
        """(n, 384); a name that is neither known nor encoded is a zero, akin to no other."""
        return np.stack([self._one(name, encode) for name in names])

    def _one(self, name: str, encode: EncodeName | None) -> np.ndarray:
        if name not in self.known and encode is None:
            return np.zeros(NAME_WIDTH)
        vector = self.known[name] if name in self.known else encode(name)  # type: ignore[misc]
        vector = np.asarray(vector, float)
        return vector / max(float(np.linalg.norm(vector)), 1e-9)


@dataclass(frozen=True, eq=False)
class Directions:
    """Name vectors reduced to the main directions among the training names."""

    mean: np.ndarray
    """(384,)"""
    basis: np.ndarray
    """(384, k)"""

    @classmethod
    def fit(cls, vectors: np.ndarray, width: int) -> Directions:
        """Principal components of (n, 384) vectors; fewer than `width` where n is small."""
        mean = vectors.mean(0)
        directions = np.linalg.svd(vectors - mean, full_matrices=False)[2]
        return cls(mean, directions[:width].T)

    def __call__(self, vectors: np.ndarray) -> np.ndarray:
        """(n, 384) -> (n, k); an unknown name's zero vector is placed at the average name."""
        known = vectors.any(1, keepdims=True)
        return ((vectors - self.mean) @ self.basis) * known


@dataclass(frozen=True, eq=False)
class Described:
    """n pairs as the networks see them."""

    sizes: np.ndarray
    """(n, 4) standardised log sizes and mass; zero extents of floppy objects at the mean."""
    classes: np.ndarray
    """(n, 32) indicators."""
    object_vectors: np.ndarray
    """(n, 384)"""
    action_vectors: np.ndarray
    """(n, 384)"""
    objects: np.ndarray
    """(n,) str"""
    actions: np.ndarray
    """(n,) str"""


@dataclass(frozen=True, eq=False)
class Describer:
    """Pairs -> what the networks see; its scales come from the training pairs."""

    object_names: NameVectors
    action_names: NameVectors
    size_mean: np.ndarray
    """(4,) of the training objects that have a shape."""
    size_scale: np.ndarray
    """(4,)"""

    @classmethod
    def fit(
        cls,
        affordances: Iterable[Affordance],
        object_vectors: Mapping[str, np.ndarray],
        action_vectors: Mapping[str, np.ndarray],
    ) -> Describer:
        """Scales from the training objects, each counted once; vectors of all known names."""
        sizes = np.stack([measurements(a) for a in affordances if not a.is_floppy])
        return cls(
            object_names=NameVectors(object_vectors),
            action_names=NameVectors(action_vectors),
            size_mean=sizes.mean(0),
            size_scale=sizes.std(0),
        )

    def __call__(self, pairs: Sequence[Pair], encode: EncodeName | None = None) -> Described:
        affordances = [affordance for affordance, _ in pairs]
        objects = [affordance.name for affordance in affordances]
        actions = [action for _, action in pairs]
        sizes = np.stack([measurements(a) for a in affordances])
        floppy = np.array([a.is_floppy for a in affordances])
        sizes[floppy, :3] = self.size_mean[:3]
        return Described(
            sizes=(sizes - self.size_mean) / self.size_scale,
            classes=np.stack([indicators(a) for a in affordances]),
            object_vectors=self.object_names(objects, encode),
            action_vectors=self.action_names(actions, encode),
            objects=np.array(objects),
            actions=np.array(actions),
        )
