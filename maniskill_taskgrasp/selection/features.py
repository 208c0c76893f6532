"""What the network sees of an object and an action: measurements, classes and name vectors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from maniskill_taskgrasp.errors import unknown_name
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

PARAMETER_VALUES: dict[str, tuple[str, ...]] = {
    "force": ("weight", "interaction"),
    "constraint": (*("uuu", "ttr", "rxx", "uur", "utt", "txx", "uxx", "trx", "xxx", "urx", "ttx"),),
    "task_class": ("use", "hold", "feel"),
}
"""Task parameter (`knowledge.PARAMETERS`) -> the data set's values; 16 indicators."""

NAME_WIDTH = 384
"""Length of a sentence vector (all-MiniLM-L6-v2)."""

EncodeName = Callable[[str], np.ndarray]
"""A name -> its sentence vector (384,), of length 1."""


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


def parameter_indicators(parameters: Mapping[str, str] | None) -> np.ndarray:
    """(16,) 0/1; all zeros where the parameters are not known.

    Raises:
        InputError: a parameter or a value that the data set does not have.
    """
    parameters = parameters or {}
    for name, value in parameters.items():
        if name not in PARAMETER_VALUES:
            raise unknown_name("task parameter", name, PARAMETER_VALUES, "force, constraint, class")
        if value not in PARAMETER_VALUES[name]:
            known = PARAMETER_VALUES[name]
            raise unknown_name(f"value of {name}", value, known, ", ".join(known))
    return np.array(
        [
            float(parameters.get(name) == value)
            for name, values in PARAMETER_VALUES.items()
            for value in values
        ]
    )


@dataclass(frozen=True, eq=False)
class NameProjection:
    """Sentence vectors reduced to their main directions over the names known in training."""

    mean: np.ndarray
    """(384,)"""
    basis: np.ndarray
    """(384, k), columns of principal directions, scaled to unit variance of the first."""
    known: dict[str, np.ndarray]
    """Name -> its projected vector (k,)."""

    @classmethod
    def fit(cls, vectors: Mapping[str, np.ndarray], width: int) -> NameProjection:
        """Principal components of all vectors; no label enters, so no split is broken."""
        stacked = np.stack(list(vectors.values())).astype(float)
        mean = stacked.mean(0)
        _, singular, directions = np.linalg.svd(stacked - mean, full_matrices=False)
        scale = np.sqrt(len(stacked)) / singular[0]
        basis = directions[:width].T * scale
        known = {name: (vector - mean) @ basis for name, vector in vectors.items()}
        return cls(mean, basis, known)

    def __call__(self, name: str, encode: EncodeName | None = None) -> np.ndarray:
        """(k,) the name's vector; zeros (the average name) where it is unknown and not encoded."""
        if name in self.known:
            return self.known[name]
        if encode is None:
            return np.zeros(self.basis.shape[1])
        return (np.asarray(encode(name), float) - self.mean) @ self.basis


@dataclass(frozen=True, eq=False)
class FeatureEncoder:
    """(object, action) -> the network's input vector."""

    objects: NameProjection
    actions: NameProjection

    @property
    def blocks(self) -> dict[str, slice]:
        """Where each part of the vector lies; a part that is unknown is all zeros."""
        widths = {
            "measurements": 4,
            "indicators": sum(len(values) for values in CATEGORIES.values()),
            "object_name": self.objects.basis.shape[1],
            "action_name": self.actions.basis.shape[1],
            "parameters": sum(len(values) for values in PARAMETER_VALUES.values()),
        }
        ends = np.cumsum(list(widths.values())).tolist()
        return {
            name: slice(end - width, end)
            for (name, width), end in zip(widths.items(), ends, strict=True)
        }

    def __call__(
        self,
        affordance: Affordance,
        action: str,
        parameters: Mapping[str, str] | None = None,
        encode: EncodeName | None = None,
    ) -> np.ndarray:
        """(width,) float64, not standardised, laid out as `blocks` says.

        Args:
            affordance: the object.
            action: one of the 74 names, or any phrase when `encode` is given.
            parameters: task parameters; missing ones are left blank.
            encode: sentence vectors of names that were not in training.
        """
        return np.concatenate(
            [
                measurements(affordance),
                indicators(affordance),
                self.objects(affordance.name, encode),
                self.actions(action, encode),
                parameter_indicators(parameters),
            ]
        )
