"""The selector's file: a plain dict of tensors and JSON values, checked before it is trusted."""

from __future__ import annotations

import pickle
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

FORMAT = "taskgrasp-selector-2"
PARTS = frozenset(
    ("format", "card", "describer", "kernels", "centres", "perceptrons", "pairs", "counts")
)


def save_checkpoint(path: Path, content: Mapping[str, Any]) -> None:
    """Write a checkpoint whole or not at all."""
    import torch

    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    torch.save(dict(content), partial)
    partial.replace(path)


def load_checkpoint(path: Path) -> dict[str, Any]:
    """Read a checkpoint.

    Raises:
        InputError: no such file, a damaged file, or a file of another kind.
    """
    import torch

    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
    except OSError as error:
        raise InputError(
            f"cannot read selector checkpoint {str(path)!r}: {error.strerror}; "
            "leave the path out to use the shipped one"
        ) from None
    except (RuntimeError, ValueError, EOFError, KeyError, BadZipFile, pickle.UnpicklingError):
        raise _not_ours(path) from None
    if not isinstance(content, dict) or not content.keys() >= PARTS:
        raise _not_ours(path)
    if content["format"] != FORMAT:
        raise _not_ours(path)
    return content


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
    """A selector as tensors and JSON values; all kernel networks share their centres."""
    import torch

    def names(vectors: NameVectors) -> dict[str, Any]:
        stacked = np.stack(list(vectors.known.values())).astype(np.float16)
        return {"names": list(vectors.known), "vectors": torch.from_numpy(stacked)}

    def directions(part: Directions) -> dict[str, Any]:
        return {
            "mean": torch.from_numpy(part.mean),
            "basis": torch.from_numpy(part.basis.astype(np.float32)),
        }

    perceptrons, centres = mixture.perceptrons, mixture.kernels[0].centres
    return {
        "format": FORMAT,
        "card": dict(card),
        "describer": {
            "objects": names(describer.object_names),
            "actions": names(describer.action_names),
            "size_mean": torch.from_numpy(describer.size_mean),
            "size_scale": torch.from_numpy(describer.size_scale),
        },
        "kernels": [
            {
                "config": asdict(network.config),
                "coefficients": torch.from_numpy(network.coefficients.astype(np.float32)),
                "bias": torch.from_numpy(network.bias),
            }
            for network in mixture.kernels
        ],
        "centres": {
            "sizes": torch.from_numpy(centres.sizes),
            "classes": torch.from_numpy(centres.classes.astype(np.uint8)),
            "objects": centres.objects.tolist(),
            "actions": centres.actions.tolist(),
        },
        "perceptrons": {
            "object_directions": directions(perceptrons.layout.object_directions),
            "action_directions": directions(perceptrons.layout.action_directions),
            "mean": torch.from_numpy(perceptrons.mean),
            "scale": torch.from_numpy(perceptrons.scale),
            "weights": [torch.from_numpy(w) for w in perceptrons.weights],
            "biases": [torch.from_numpy(b) for b in perceptrons.biases],
        },
        "share": mixture.share,
        "temperature": mixture.temperature,
        "shrink": shrink,
        "pairs": [list(pair) for pair in pair_counts],
        "counts": torch.from_numpy(np.stack(list(pair_counts.values()))).short(),
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
            coefficients=network["coefficients"].double().numpy(),
            bias=network["bias"].numpy(),
        )
        for network in content["kernels"]
    )
    mixture = Mixture(
        kernels, _perceptrons(content["perceptrons"]), content["share"], content["temperature"]
    )
    counts = content["counts"].double().numpy()
    pairs = {(obj, action): n for (obj, action), n in zip(content["pairs"], counts, strict=True)}
    return describer, mixture, pairs, float(content["shrink"])


def _describer(packed: Mapping[str, Any]) -> Describer:
    def names(part: Mapping[str, Any]) -> NameVectors:
        return NameVectors(dict(zip(part["names"], part["vectors"].double().numpy(), strict=True)))

    return Describer(
        object_names=names(packed["objects"]),
        action_names=names(packed["actions"]),
        size_mean=packed["size_mean"].numpy(),
        size_scale=packed["size_scale"].numpy(),
    )


def _centres(packed: Mapping[str, Any], describer: Describer) -> Described:
    return Described(
        sizes=packed["sizes"].numpy(),
        classes=packed["classes"].double().numpy(),
        object_vectors=describer.object_names(packed["objects"]),
        action_vectors=describer.action_names(packed["actions"]),
        objects=np.array(packed["objects"]),
        actions=np.array(packed["actions"]),
    )


def _perceptrons(packed: Mapping[str, Any]) -> Ensemble:
    def directions(part: Mapping[str, Any]) -> Directions:
        return Directions(part["mean"].numpy(), part["basis"].double().numpy())

    return Ensemble(
        layout=InputLayout(
            directions(packed["object_directions"]), directions(packed["action_directions"])
        ),
        mean=packed["mean"].numpy(),
        scale=packed["scale"].numpy(),
        weights=tuple(w.numpy() for w in packed["weights"]),
        biases=tuple(b.numpy() for b in packed["biases"]),
    )
