"""Colours of the robot and its visual meshes: one GLB file per distinct part."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from maniskill_taskgrasp.agents.sawyer_ar10.glb import Surface, glb
from maniskill_taskgrasp.agents.sawyer_ar10.look_ar10 import LOOKS as AR10_LOOKS
from maniskill_taskgrasp.agents.sawyer_ar10.look_sawyer import LOOKS as SAWYER_LOOKS
from maniskill_taskgrasp.agents.sawyer_ar10.look_sawyer import Look
from maniskill_taskgrasp.agents.sawyer_ar10.shapes import Soup, shade

MILLIMETRE = 1e-3  # [m]


@dataclass(frozen=True)
class Material:
    """Appearance in the metallic-roughness model."""

    rgb: tuple[float, float, float]
    """As displayed (sRGB), 0..1."""
    roughness: float = 0.6
    metallic: float = 0.0

    def gltf(self, name: str) -> dict[str, Any]:
        """Entry of a glTF file's `materials`, whose colours are linear light intensities."""
        rgb = np.array(self.rgb)
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        return {
            "name": name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [*np.round(linear, 4).tolist(), 1.0],
                "metallicFactor": self.metallic,
                "roughnessFactor": self.roughness,
            },
        }


MATERIALS = {
    # The CAD's pure red, toned down to the product's.
    "red": Material((0.80, 0.06, 0.06), 0.38),
    "dark": Material((0.29, 0.29, 0.29), 0.5),
    "iron": Material((0.20, 0.20, 0.21), 0.6),
    "grey": Material((0.70, 0.70, 0.70), 0.5),
    "white": Material((0.96, 0.96, 0.96), 0.4),
    "black": Material((0.10, 0.10, 0.10), 0.45),
    "screen": Material((0.03, 0.03, 0.04), 0.15),
    "eye": Material((0.92, 0.95, 0.97), 0.5),
    "lens": Material((0.79, 0.82, 0.93), 0.2),
    "orange": Material((1.0, 0.40, 0.12), 0.45),
    "steel": Material((0.75, 0.76, 0.78), 0.3, 0.2),
    # Sheet metal, rod ends and rubber of the AR10's own colour tables.
    "sheet": Material((0.10, 0.10, 0.40), 0.35, 0.1),
    "rod_end": Material((0.45, 0.68, 0.90), 0.4),
    "rubber": Material((0.08, 0.08, 0.08), 0.85),
}


def link_meshes() -> dict[str, str]:
    """Link -> name of its mesh; the four fingers share theirs."""
    return {
        **{link: link for link in SAWYER_LOOKS},
        **{link: mesh for mesh, (links, _) in AR10_LOOKS.items() for link in links},
    }


def mesh_files() -> dict[str, bytes]:
    """Mesh name -> contents of its GLB file, in metres and link coordinates."""
    looks: dict[str, Callable[[], Look]] = {
        **SAWYER_LOOKS,
        **{mesh: look for mesh, (_, look) in AR10_LOOKS.items()},
    }
    return {mesh: _mesh(mesh, look()) for mesh, look in looks.items()}


def _surface(name: str, soups: list[Soup]) -> Surface:
    """All shapes of one material, smoothed one by one."""
    shaded = [shade(soup) for soup in soups]
    starts = np.cumsum([0, *(len(vertices) for vertices, _, _ in shaded[:-1])])
    return Surface(
        material=MATERIALS[name].gltf(name),
        vertices=np.concatenate([vertices for vertices, _, _ in shaded]) * MILLIMETRE,
        normals=np.concatenate([normals for _, normals, _ in shaded]),
        faces=np.concatenate(
            [faces + start for (_, _, faces), start in zip(shaded, starts, strict=True)]
        ),
    )


def _mesh(name: str, look: Look) -> bytes:
    """GLB contents of one part, with one surface per material."""
    shapes: dict[str, list[Soup]] = {}
    for material, soup in look:
        shapes.setdefault(material, []).append(soup)
    return glb(name, [_surface(material, soups) for material, soups in shapes.items()])
