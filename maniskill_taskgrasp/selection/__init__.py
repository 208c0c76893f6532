"""Which grasp topology: data, network and what this hand can do with the answer."""

from __future__ import annotations

from typing import Any

__all__ = ["GraspStrategy", "Selector", "feasible"]

_HOME = {
    "GraspStrategy": "maniskill_taskgrasp.selection.strategy",
    "Selector": "maniskill_taskgrasp.selection.selector",
    "feasible": "maniskill_taskgrasp.selection.feasibility",
}


def __getattr__(name: str) -> Any:
    """Import on first use, so that importing the package stays light."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOME[name]), name)
