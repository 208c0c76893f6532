"""The selector's file: a plain dict of tensors and JSON values, checked before it is trusted."""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.selection.ensemble import Ensemble
from maniskill_taskgrasp.selection.features import FeatureEncoder, NameProjection

FORMAT = "taskgrasp-selector-1"
KEYS = frozenset(
    ("format", "config", "measured", "objects", "actions", "ensemble", "pairs", "counts", "shrink")
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
    complete = isinstance(content, dict) and content.keys() >= KEYS
    if not complete or content["format"] != FORMAT:
        raise _not_ours(path)
    return content


def _not_ours(path: Path) -> InputError:
    return InputError(
        f"{str(path)!r} is damaged or no selector checkpoint; `python train/selector.py` makes one"
    )


def pack_projection(projection: NameProjection) -> dict[str, Any]:
    """A name projection as tensors; half precision is exact enough for directions."""
    import torch

    return {
        "mean": torch.from_numpy(projection.mean).half(),
        "basis": torch.from_numpy(projection.basis).half(),
        "names": list(projection.known),
        "vectors": torch.from_numpy(np.stack(list(projection.known.values()))).float(),
    }


def unpack_projection(packed: Mapping[str, Any]) -> NameProjection:
    vectors = packed["vectors"].double().numpy()
    return NameProjection(
        mean=packed["mean"].double().numpy(),
        basis=packed["basis"].double().numpy(),
        known=dict(zip(packed["names"], vectors, strict=True)),
    )


def pack_ensemble(ensemble: Ensemble) -> dict[str, Any]:
    """The ensemble as tensors."""
    import torch

    return {
        "mean": torch.from_numpy(ensemble.mean),
        "scale": torch.from_numpy(ensemble.scale),
        "weights": [torch.from_numpy(w) for w in ensemble.weights],
        "biases": [torch.from_numpy(b) for b in ensemble.biases],
        "temperature": float(ensemble.temperature),
    }


def unpack_ensemble(packed: Mapping[str, Any]) -> Ensemble:
    return Ensemble(
        mean=packed["mean"].numpy(),
        scale=packed["scale"].numpy(),
        weights=tuple(w.float().numpy() for w in packed["weights"]),
        biases=tuple(b.float().numpy() for b in packed["biases"]),
        temperature=packed["temperature"],
    )


def unpack_encoder(content: Mapping[str, Any]) -> FeatureEncoder:
    """The feature encoder that a checkpoint's network was trained with."""
    return FeatureEncoder(
        objects=unpack_projection(content["objects"]), actions=unpack_projection(content["actions"])
    )
