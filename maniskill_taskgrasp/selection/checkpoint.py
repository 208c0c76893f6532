"""The selector's file: numpy arrays and one JSON header, checked before it is trusted."""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.selection.ensemble import Ensemble, InputLayout
from maniskill_taskgrasp.selection.features import Described, Describer, Directions, NameVectors
from maniskill_taskgrasp.selection.kernel import KernelConfig, KernelNetwork
from maniskill_taskgrasp.selection.mixture import Mixture

FORMAT = "taskgrasp-selector-3"
PARTS = frozenset(
    ("format", "card", "describer", "kernels", "centres", "perceptrons", "pairs", "counts")
)
ARRAY = "array "
"""What the header has in place of an array starts so; no name of the data set does."""
DAMAGE = (ValueError, EOFError, KeyError, IndexError, TypeError, AttributeError)
"""What numpy and json raise on a file that is damaged or of another kind."""


def save_checkpoint(path: Path, content: Mapping[str, Any]) -> None:
    """Write a checkpoint whole or not at all."""
    arrays: dict[str, Any] = {}
    header = json.dumps(_arrays_out(content, arrays))
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    with partial.open("wb") as file:
        np.savez_compressed(file, header=np.array(header), **arrays)
    partial.replace(path)


def load_checkpoint(path: Path) -> dict[str, Any]:
    """Read a checkpoint.

    Raises:
        InputError: no such file, a damaged file, or a file of another kind.
    """
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            content = _arrays_in(json.loads(str(arrays["header"])), arrays)
    except OSError as error:
        raise InputError(
            f"cannot read selector checkpoint {str(path)!r}: {error.strerror}; "
            "leave the path out to use the shipped one"
        ) from None
    except (*DAMAGE, BadZipFile, zlib.error):
        raise _not_ours(path) from None
    if not isinstance(content, dict) or not content.keys() >= PARTS:
        raise _not_ours(path)
    if content["format"] != FORMAT:
        raise _not_ours(path)
    return content


def _arrays_out(value: Any, arrays: dict[str, Any]) -> Any:
    """`value` as JSON values; its arrays are put aside and replaced by their keys."""
    if isinstance(value, np.ndarray):
        key = f"{ARRAY}{len(arrays)}"
        arrays[key] = value
        return key
    if isinstance(value, Mapping):
        return {name: _arrays_out(part, arrays) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_arrays_out(part, arrays) for part in value]
    return value


def _arrays_in(value: Any, arrays: Mapping[str, np.ndarray]) -> Any:
    """The reverse of `_arrays_out`."""
    if isinstance(value, str) and value.startswith(ARRAY):
        return arrays[value]
    if isinstance(value, dict):
        return {name: _arrays_in(part, arrays) for name, part in value.items()}
    if isinstance(value, list):
        return [_arrays_in(part, arrays) for part in value]
    return value


def _not_ours(path: Path) -> InputError:
    return InputError(
        f"{str(path)!r} is damaged or no selector checkpoint; `python train/selector.py` makes one"
    )


def pack(
    describer: Describer,
    mixture: Mixture,
    pair_counts: Mapping[tuple[str, str], np.ndarray],
    shrink: float,
    card: Mapping[str, object],
) -> dict[str, Any]:
    """A selector as arrays and JSON values; all kernel networks share their centres."""

    def names(vectors: NameVectors) -> dict[str, Any]:
        stacked = np.stack(list(vectors.known.values())).astype(np.float16)
        return {"names": list(vectors.known), "vectors": stacked}

    def directions(part: Directions) -> dict[str, Any]:
        return {"mean": part.mean, "basis": part.basis.astype(np.float32)}

    perceptrons, centres = mixture.perceptrons, mixture.kernels[0].centres
    return {
        "format": FORMAT,
        "card": dict(card),
        "describer": {
            "objects": names(describer.object_names),
            "actions": names(describer.action_names),
            "size_mean": describer.size_mean,
            "size_scale": describer.size_scale,
        },
        "kernels": [
            {
                "config": asdict(network.config),
                "coefficients": network.coefficients.astype(np.float32),
                "bias": network.bias,
            }
            for network in mixture.kernels
        ],
        "centres": {
            "sizes": centres.sizes,
            "classes": centres.classes.astype(np.uint8),
            "objects": centres.objects.tolist(),
            "actions": centres.actions.tolist(),
        },
        "perceptrons": {
            "object_directions": directions(perceptrons.layout.object_directions),
            "action_directions": directions(perceptrons.layout.action_directions),
            "mean": perceptrons.mean,
            "scale": perceptrons.scale,
            "weights": list(perceptrons.weights),
            "biases": list(perceptrons.biases),
        },
        "share": mixture.share,
        "temperature": mixture.temperature,
        "shrink": shrink,
        "pairs": [list(pair) for pair in pair_counts],
        "counts": np.stack(list(pair_counts.values())).astype(np.int16),
    }


def unpack(
    content: Mapping[str, Any],
) -> tuple[Describer, Mixture, dict[tuple[str, str], np.ndarray], float]:
    """Describer, networks, pair counts and shrinkage of a loaded checkpoint."""
    describer = _describer(content["describer"])
    centres = _centres(content["centres"], describer)
    kernels = tuple(
        KernelNetwork(
            config=KernelConfig(**network["config"]),
            centres=centres,
            coefficients=network["coefficients"].astype(float),
            bias=network["bias"],
        )
        for network in content["kernels"]
    )
    mixture = Mixture(
        kernels, _perceptrons(content["perceptrons"]), content["share"], content["temperature"]
    )
    counts = content["counts"].astype(float)
    pairs = {(obj, action): n for (obj, action), n in zip(content["pairs"], counts, strict=True)}
    return describer, mixture, pairs, float(content["shrink"])


def _describer(packed: Mapping[str, Any]) -> Describer:
    def names(part: Mapping[str, Any]) -> NameVectors:
        return NameVectors(dict(zip(part["names"], part["vectors"].astype(float), strict=True)))

    return Describer(
        object_names=names(packed["objects"]),
        action_names=names(packed["actions"]),
        size_mean=packed["size_mean"],
        size_scale=packed["size_scale"],
    )


def _centres(packed: Mapping[str, Any], describer: Describer) -> Described:
    return Described(
        sizes=packed["sizes"],
        classes=packed["classes"].astype(float),
        object_vectors=describer.object_names(packed["objects"]),
        action_vectors=describer.action_names(packed["actions"]),
        objects=np.array(packed["objects"]),
        actions=np.array(packed["actions"]),
    )


def _perceptrons(packed: Mapping[str, Any]) -> Ensemble:
    def directions(part: Mapping[str, Any]) -> Directions:
        return Directions(part["mean"], part["basis"].astype(float))

    return Ensemble(
        layout=InputLayout(
            directions(packed["object_directions"]), directions(packed["action_directions"])
        ),
        mean=packed["mean"],
        scale=packed["scale"],
        weights=tuple(packed["weights"]),
        biases=tuple(packed["biases"]),
    )
