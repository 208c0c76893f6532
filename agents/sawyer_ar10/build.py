"""Writes the robot's files: `python -m maniskill_taskgrasp.agents.sawyer_ar10.build [FOLDER]`.

Two URDF files share one tree: the full one, and one without visuals for machines that have no
Vulkan device, where stock SAPIEN cannot load any. Links that cannot move against each other are one
(`fuse`). The output depends on nothing but the code.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from xml.etree import ElementTree as ET

from maniskill_taskgrasp.agents.robot_model import (
    Box,
    Inertia,
    Joint,
    Link,
    Primitive,
    rpy_of,
)
from maniskill_taskgrasp.agents.sawyer_ar10.description import SIMULATED
from maniskill_taskgrasp.agents.sawyer_ar10.fuse import Fusion, Transform
from maniskill_taskgrasp.agents.sawyer_ar10.visuals import link_meshes, mesh_files

MESHES = "meshes"
FRAME_INERTIA = Inertia(mass=1e-5, com=(0.0, 0.0, 0.0), xx=1e-9, yy=1e-9, zz=1e-9)
"""What a mere frame weighs: SAPIEN would give it 1e-6 kg m^2, more than a fingertip has itself."""


def _number(value: float) -> str:
    """Shortest text that is exact to nine digits, so that every machine writes the same."""
    return f"{round(value, 12) + 0.0:.9g}"


def _vector(values: Sequence[float]) -> str:
    return " ".join(_number(value) for value in values)


def _origin(parent: ET.Element, xyz: Sequence[float], rpy: Sequence[float]) -> None:
    ET.SubElement(parent, "origin", xyz=_vector(xyz), rpy=_vector(rpy))


def _add_inertia(element: ET.Element, inertia: Inertia) -> None:
    inertial = ET.SubElement(element, "inertial")
    _origin(inertial, inertia.com, (0.0, 0.0, 0.0))
    ET.SubElement(inertial, "mass", value=_number(inertia.mass))
    terms = ("xx", "xy", "xz", "yy", "yz", "zz")
    ET.SubElement(
        inertial, "inertia", {f"i{term}": _number(getattr(inertia, term)) for term in terms}
    )


def _add_collision(element: ET.Element, primitive: Primitive) -> None:
    collision = ET.SubElement(element, "collision", name=primitive.name)
    _origin(collision, primitive.xyz, primitive.rpy)
    geometry = ET.SubElement(collision, "geometry")
    if isinstance(primitive, Box):
        ET.SubElement(geometry, "box", size=_vector(primitive.size))
    else:
        radius, length = _number(primitive.radius), _number(primitive.length)
        ET.SubElement(geometry, "cylinder", radius=radius, length=length)


def _add_visual(element: ET.Element, mesh: str, pose: Transform) -> None:
    visual = ET.SubElement(element, "visual")
    _origin(visual, pose[:3, 3].tolist(), rpy_of(pose[:3, :3]))
    ET.SubElement(ET.SubElement(visual, "geometry"), "mesh", filename=mesh)


def _add_link(robot: ET.Element, link: Link, meshes: Sequence[tuple[str, Transform]]) -> None:
    element = ET.SubElement(robot, "link", name=link.name)
    _add_inertia(element, link.inertia or FRAME_INERTIA)
    for mesh, pose in meshes:
        _add_visual(element, mesh, pose)
    for primitive in link.collisions:
        _add_collision(element, primitive)


def _add_joint(robot: ET.Element, joint: Joint) -> None:
    element = ET.SubElement(robot, "joint", name=joint.name, type=joint.type)
    _origin(element, joint.xyz, joint.rpy)
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    if joint.type == "fixed":
        return
    ET.SubElement(element, "axis", xyz=_vector(joint.axis))
    limits = ("lower", "upper", "velocity", "effort")
    ET.SubElement(element, "limit", {name: _number(getattr(joint, name)) for name in limits})


def urdf(fusion: Fusion, meshes: dict[str, str]) -> str:
    """URDF text of a fused robot.

    Args:
        fusion: the robot, and where its original links are.
        meshes: original link -> its visual mesh, relative to the file.
    """
    drawn: dict[str, list[tuple[str, Transform]]] = defaultdict(list)
    for original, mesh in meshes.items():
        carrier, pose = fusion.frames[original]
        drawn[carrier].append((mesh, pose))
    root = ET.Element("robot", name=fusion.robot.name)
    for link in fusion.robot.links:
        _add_link(root, link, drawn[link.name])
    for joint in fusion.robot.joints:
        _add_joint(root, joint)
    ET.indent(root)
    return f'<?xml version="1.0"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _write(path: Path, content: bytes) -> None:
    temporary = path.with_name(f".{path.name}.part")
    temporary.write_bytes(content)
    temporary.replace(path)


def build(folder: Path) -> None:
    """Write both URDF files and the visual meshes into `folder`, which is made if absent."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / MESHES).mkdir(exist_ok=True)
    for name, content in mesh_files().items():
        _write(folder / MESHES / f"{name}.glb", content)
    meshes = {link: f"{MESHES}/{mesh}.glb" for link, mesh in link_meshes().items()}
    name = SIMULATED.robot.name
    _write(folder / f"{name}.urdf", urdf(SIMULATED, meshes).encode())
    _write(folder / f"{name}_collision.urdf", urdf(SIMULATED, {}).encode())


def default_folder() -> Path:
    """Where the shipped files live."""
    return Path(str(files("maniskill_taskgrasp.assets"))) / "robots" / SIMULATED.robot.name


if __name__ == "__main__":
    build(Path(sys.argv[1]) if len(sys.argv) > 1 else default_folder())
