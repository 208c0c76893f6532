"""A minimal GLB (binary glTF 2.0) writer, so that a mesh's bytes depend on no library's version."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942
VERTEX_BUFFER, INDEX_BUFFER = 34962, 34963
FLOAT32, UINT16, UINT32 = 5126, 5123, 5125


@dataclass(frozen=True, kw_only=True)
class Surface:
    """Triangles of one material."""

    material: dict[str, Any]
    """As glTF's own `materials` entries."""
    vertices: NDArray[np.float64]
    """(v, 3) [m]"""
    normals: NDArray[np.float64]
    """(v, 3) unit vectors"""
    faces: NDArray[np.int64]
    """(f, 3) indices of vertices"""


class _Buffer:
    """Binary chunk under construction, with the accessors that describe it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, array: NDArray[Any], kind: str, component: int, target: int) -> int:
        """Append an array and return the index of its accessor."""
        raw = array.tobytes()
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw), "target": target}
        self.views.append(view)
        accessor = {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "count": len(array),
            "type": kind,
        }
        if kind == "VEC3":
            accessor["min"] = array.min(axis=0).tolist()
            accessor["max"] = array.max(axis=0).tolist()
        self.accessors.append(accessor)
        self.data += raw + b"\0" * (-len(raw) % 4)
        return len(self.accessors) - 1

    def primitive(self, surface: Surface, material: int) -> dict[str, Any]:
        """Append a surface and return its glTF primitive."""
        short = len(surface.vertices) <= 0xFFFF
        indices = surface.faces.ravel().astype("<u2" if short else "<u4")
        vectors = [array.astype("<f4") for array in (surface.vertices, surface.normals)]
        position, normal = (self.add(array, "VEC3", FLOAT32, VERTEX_BUFFER) for array in vectors)
        width = UINT16 if short else UINT32
        return {
            "attributes": {"POSITION": position, "NORMAL": normal},
            "indices": self.add(indices, "SCALAR", width, INDEX_BUFFER),
            "material": material,
        }


def _chunk(kind: int, data: bytes, filler: bytes) -> bytes:
    data += filler * (-len(data) % 4)
    return struct.pack("<II", len(data), kind) + data


def glb(name: str, surfaces: Sequence[Surface]) -> bytes:
    """Contents of a GLB file that holds one mesh with one primitive per surface."""
    buffer = _Buffer()
    primitives = [buffer.primitive(surface, index) for index, surface in enumerate(surfaces)]
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "meshes": [{"name": name, "primitives": primitives}],
        "materials": [surface.material for surface in surfaces],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    chunks = _chunk(JSON_CHUNK, text, b" ") + _chunk(BINARY_CHUNK, bytes(buffer.data), b"\0")
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
