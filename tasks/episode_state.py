"""What a state remembers beside poses and joints: flat rows out of tensors, and back."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor


def to_rows(fields: dict[str, Tensor]) -> dict[str, Tensor]:
    """Copies of tensors (num_envs, ...) as (num_envs, d) float32, ManiSkill's form of a state."""
    return {name: field.reshape(len(field), -1).float().clone() for name, field in fields.items()}


def from_rows(fields: dict[str, Tensor], rows: dict[str, Any], env_idx: Tensor) -> None:
    """Write rows, (n, d) or for one environment (d,), into tensors at n environments.

    Raises:
        ValueError: a field has no row, or one of another size.
    """
    for name, field in fields.items():
        if name not in rows:
            raise ValueError(f"the state lacks {name!r}: it has {', '.join(rows)}")
        row, shape = torch.as_tensor(rows[name]), torch.Size((len(env_idx), *field.shape[1:]))
        if row.numel() != shape.numel():
            found = tuple(row.shape)
            raise ValueError(f"{name!r} of the state has shape {found}: {tuple(shape)} is wanted")
        field[env_idx] = row.reshape(shape).to(field)


def unflattened(vector: Any, like: dict[str, Any]) -> dict[str, Any]:
    """Nested rows whose flattening is a vector.

    Args:
        vector: (n, d) or (d,).
        like: nested dict of (num_envs, d_i), in the order in which they were flattened.

    Raises:
        ValueError: the vector has another length than `like`.
    """
    vector = torch.atleast_2d(torch.as_tensor(vector))
    rows, end = _taken(vector, like, 0)
    if end != vector.shape[1]:
        raise ValueError(f"the state has {vector.shape[1]} numbers, {end} are wanted")
    return rows


def _taken(vector: Tensor, like: dict[str, Any], start: int) -> tuple[dict[str, Any], int]:
    rows: dict[str, Any] = {}
    for name, value in like.items():
        if isinstance(value, dict):
            rows[name], start = _taken(vector, value, start)
        else:
            rows[name] = vector[:, start : start + value.shape[1]]
            start += value.shape[1]
    return rows, start
