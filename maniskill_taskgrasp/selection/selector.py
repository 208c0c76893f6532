"""Which grasp: human evidence where there is some, the network where there is none."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

import numpy as np

from maniskill_taskgrasp.errors import InputError, echo, unknown_name
from maniskill_taskgrasp.knowledge import Affordance, load_knowledge
from maniskill_taskgrasp.selection.checkpoint import (
    load_checkpoint,
    unpack_encoder,
    unpack_ensemble,
)
from maniskill_taskgrasp.selection.dataset import NUM_TOPOLOGIES
from maniskill_taskgrasp.selection.ensemble import Ensemble
from maniskill_taskgrasp.selection.features import EncodeName, FeatureEncoder
from maniskill_taskgrasp.selection.strategy import GraspStrategy

PairCounts = Mapping[tuple[str, str], np.ndarray]
"""(object, action) -> rows of each topology (15,)."""


def shrunk(counts: np.ndarray, model: np.ndarray, strength: float) -> np.ndarray:
    """What people did, shrunk towards what the network expects: (n_k + a P_k) / (n + a).

    Args:
        counts: (15,) rows of each topology for this pair; zeros where it was never seen.
        model: (15,) the network's distribution.
        strength: a, the number of rows that the network's opinion is worth.
    """
    return (counts + strength * model) / (counts.sum() + strength)


class Selector:
    """Ranks the 15 topologies for an object and an action."""

    def __init__(
        self,
        encoder: FeatureEncoder,
        ensemble: Ensemble,
        pair_counts: PairCounts,
        shrink: float,
        encode: EncodeName | None = None,
    ) -> None:
        """From its parts; `Selector.load` is what most callers want.

        Args:
            encoder: features of an object and an action.
            ensemble: the network.
            pair_counts: the training rows, counted.
            shrink: strength a of `shrunk`.
            encode: sentence vectors for names that training did not know; None blanks them.
        """
        self._encoder = encoder
        self._ensemble = ensemble
        self._pair_counts = pair_counts
        self._shrink = shrink
        self._encode = encode

    @classmethod
    def load(cls, path: str | Path | None = None, encode: EncodeName | None = None) -> Selector:
        """Read a checkpoint; without a path the shipped one, trained on all rows.

        Raises:
            InputError: the file is missing, damaged or of another kind.
        """
        if path is None:
            shipped = files("maniskill_taskgrasp.assets").joinpath("checkpoints/selector.pt")
            path = Path(str(shipped))
        content = load_checkpoint(Path(path))
        counts = content["counts"].numpy().astype(float)
        pairs = {tuple(pair): row for pair, row in zip(content["pairs"], counts, strict=True)}
        return cls(
            encoder=unpack_encoder(content),
            ensemble=unpack_ensemble(content["ensemble"]),
            pair_counts=pairs,
            shrink=float(content["shrink"]),
            encode=encode,
        )

    def rank(
        self,
        obj: str | Affordance,
        action: str | Mapping[str, float] | None = None,
        parameters: Mapping[str, str] | None = None,
    ) -> GraspStrategy:
        """The distribution over topologies for this object and action.

        Args:
            obj: a name of the data set, or the measurements of any object.
            action: one of the 74 names; or weights of several; or None for a transfer request
                ("hand me ..."), which weighs the actions as people did them with this object.
            parameters: task parameters (`knowledge.PARAMETERS`) as far as they are known.

        Raises:
            InputError: an unknown object, action or parameter, or weights that are no
                distribution.
        """
        affordance = load_knowledge().affordance(obj) if isinstance(obj, str) else obj
        weights = self._action_weights(affordance.name, action)
        names = list(weights)
        share = np.array([weights[name] for name in names])
        counts = np.array([self._counts(affordance.name, name) for name in names])
        features = [self._encoder(affordance, name, parameters, self._encode) for name in names]
        model = self._ensemble.predict(np.stack(features))
        each = [shrunk(c, p, self._shrink) for c, p in zip(counts, model, strict=True)]
        return GraspStrategy.of(share @ np.array(each) / share.sum(), int(counts.sum()))

    def _counts(self, obj: str, action: str) -> np.ndarray:
        return self._pair_counts.get((obj, action), np.zeros(NUM_TOPOLOGIES))

    def _action_weights(
        self, obj: str, action: str | Mapping[str, float] | None
    ) -> Mapping[str, float]:
        known = load_knowledge()
        if action is None:
            return known.actions_of(obj) or _rows_of_actions()
        weights = {action: 1.0} if isinstance(action, str) else dict(action)
        for name in weights:
            if name not in known.actions:
                raise unknown_name("action", name, known.actions, "the 74 actions of the data set")
        if not weights or not all(np.isfinite(w) and w >= 0 for w in weights.values()):
            raise InputError(f"action weights must be numbers from 0 up, got {echo(weights)}")
        if sum(weights.values()) <= 0:
            raise InputError(f"action weights must not all be 0, got {echo(weights)}")
        return {name: weight for name, weight in weights.items() if weight > 0}


def _rows_of_actions() -> dict[str, float]:
    """How often each action was seen at all: the guess for an object without a history."""
    totals: dict[str, float] = {}
    for (_, action), counts in load_knowledge().pair_counts.items():
        totals[action] = totals.get(action, 0.0) + sum(counts)
    return {action: total for action, total in totals.items() if total > 0}
