"""Which grasp: human evidence where there is some, the network where there is none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path

import numpy as np

from maniskill_taskgrasp.errors import InputError, echo, unknown_name
from maniskill_taskgrasp.knowledge import (
    PARAMETERS,
    ActionFacts,
    Affordance,
    load_knowledge,
)
from maniskill_taskgrasp.selection.checkpoint import load_checkpoint, pack, save_checkpoint, unpack
from maniskill_taskgrasp.selection.dataset import NUM_TOPOLOGIES
from maniskill_taskgrasp.selection.features import Describer, EncodeName, Pair
from maniskill_taskgrasp.selection.mixture import Mixture, shrunk
from maniskill_taskgrasp.selection.strategy import GraspStrategy

PairCounts = Mapping[tuple[str, str], np.ndarray]
"""(object, action) -> rows of each topology (15,)."""
SHIPPED = "checkpoints/selector.npz"


class Selector:
    """Ranks the 15 topologies for an object and an action."""

    def __init__(
        self,
        describer: Describer,
        mixture: Mixture,
        pair_counts: PairCounts,
        shrink: float,
        encode: EncodeName | None = None,
    ) -> None:
        """From its parts; `Selector.load` is what most callers want.

        Args:
            describer: what the networks see of a pair.
            mixture: the networks.
            pair_counts: the training rows, counted.
            shrink: strength a of `mixture.shrunk`.
            encode: sentence vectors for names that training did not know; None blanks them.
        """
        self._describer = describer
        self._mixture = mixture
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
            path = str(files("maniskill_taskgrasp.assets").joinpath(SHIPPED))
        return cls(*unpack(load_checkpoint(Path(path))), encode)

    def save(self, path: Path, card: Mapping[str, object]) -> None:
        """Write a checkpoint that `load` reads; `card` says how it was made."""
        save_checkpoint(
            path, pack(self._describer, self._mixture, self._pair_counts, self._shrink, card)
        )

    def parts(self, pairs: Sequence[Pair]) -> tuple[np.ndarray, np.ndarray]:
        """Distributions (n, 15) of the kernel networks and of the perceptrons, evidence unused."""
        return self._mixture.parts(self._describer(pairs, self._encode))

    def counts(self, keys: Sequence[tuple[str, str]]) -> np.ndarray:
        """(n, 15) rows of human data on each (object name, action)."""
        nothing = np.zeros(NUM_TOPOLOGIES)
        return np.array([self._pair_counts.get(key, nothing) for key in keys])

    def predict(self, pairs: Sequence[Pair]) -> np.ndarray:
        """(n, 15) probabilities: evidence where there is some, the networks where there is none."""
        model = self._mixture.predict(self._describer(pairs, self._encode))
        keys = [(affordance.name, action) for affordance, action in pairs]
        return shrunk(self.counts(keys), model, self._shrink)

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
            parameters: task parameters (`knowledge.PARAMETERS`) as far as they are known; they
                weigh the actions against each other where more than one is possible.

        Raises:
            InputError: an unknown object, action or parameter, or weights that are no
                distribution.
        """
        affordance = load_knowledge().affordance(obj) if isinstance(obj, str) else obj
        weights = self._action_weights(affordance.name, action, parameters or {})
        share = np.array(list(weights.values()))
        probabilities = self.predict([(affordance, name) for name in weights])
        rows = self.counts([(affordance.name, name) for name in weights]).sum()
        return GraspStrategy.of(share @ probabilities / share.sum(), int(rows))

    def _action_weights(
        self,
        obj: str,
        action: str | Mapping[str, float] | None,
        parameters: Mapping[str, str],
    ) -> dict[str, float]:
        """Weights of the actions that remain possible; not normalised."""
        actions = load_knowledge().actions
        if action is None:
            weights = {a: float(n) for a, n in load_knowledge().actions_of(obj).items() if n}
            weights = weights or _rows_of_actions()
        else:
            weights = {action: 1.0} if isinstance(action, str) else dict(action)
        for name in weights:
            if name not in actions:
                raise unknown_name("action", name, actions, "the 74 actions of the data set")
        if not all(np.isfinite(w) and w >= 0 for w in weights.values()) or not any(
            weights.values()
        ):
            raise InputError(f"action weights must be from 0 up and not all 0, got {echo(weights)}")
        likelihood = {name: _likelihood(actions[name], parameters) for name in weights}
        return {name: w * likelihood[name] for name, w in weights.items() if w > 0}


def _likelihood(action: ActionFacts, parameters: Mapping[str, str]) -> float:
    """How well task parameters fit an action: the product of their smoothed shares of its rows.

    Parameters only tell actions apart: once the action is known they say nothing more about the
    grasp (docs/selection.md), so they never enter the networks.
    """
    product = 1.0
    for name, value in parameters.items():
        if name not in PARAMETERS:
            raise unknown_name("task parameter", name, PARAMETERS)
        known = sorted({v for a in load_knowledge().actions.values() for v in a.parameters[name]})
        if value not in known:
            raise unknown_name(f"value of {name}", value, known)
        rows = action.parameters[name]
        product *= (rows.get(value, 0) + 1) / (sum(rows.values()) + len(known))
    return product


def _rows_of_actions() -> dict[str, float]:
    """How often each action was seen at all: the guess for an object without a history."""
    totals: dict[str, float] = {}
    for (_, action), counts in load_knowledge().pair_counts.items():
        totals[action] = totals.get(action, 0.0) + sum(counts)
    return totals
