"""The robot's numbers and the files written from them."""

import json
import math
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from maniskill_taskgrasp.agents.robot_model import (
    Box,
    Cylinder,
    inertia_of_primitives,
    rotation,
)
from maniskill_taskgrasp.agents.sawyer_ar10.ar10 import HAND_LINKS
from maniskill_taskgrasp.agents.sawyer_ar10.build import build, default_folder
from maniskill_taskgrasp.agents.sawyer_ar10.description import (
    ARM_JOINT_NAMES,
    COUPLED_JOINT_NAMES,
    HAND_JOINT_NAMES,
    PART_PRIMITIVES,
    SAWYER_AR10,
)
from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10

MOVING = (*ARM_JOINT_NAMES, *HAND_JOINT_NAMES, *COUPLED_JOINT_NAMES)


@pytest.fixture(scope="module")
def sheet(shared_dir):
    """The fact sheet of the robot."""
    return json.loads((shared_dir / "facts" / "robot.json").read_text())


def shipped_files(folder):
    """Names of all files under `folder`, relative to it."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


# -- the files ---------------------------------------------------------------------------------


def test_build_reproduces_the_committed_files(tmp_path):
    """The shipped robot is what the code writes, byte for byte, no file more or less."""
    build(tmp_path)
    shipped = default_folder()
    names = shipped_files(shipped)
    assert shipped_files(tmp_path) == names
    for name in names:
        assert (tmp_path / name).read_bytes() == (shipped / name).read_bytes(), name


def test_files_name_no_place_of_the_building_machine():
    """No absolute path and no home folder got into a shipped file; all together stay small."""
    contents = [(default_folder() / name).read_bytes() for name in shipped_files(default_folder())]
    for content in contents:
        assert not re.search(rb"/(work|home|root|tmp|usr|Users)/", content)
    assert sum(map(len, contents)) < 3_000_000


def test_collision_urdf_differs_by_its_visuals_alone():
    """The file for machines without Vulkan is the full one minus every <visual>."""
    full = ET.parse(default_folder() / "sawyer_ar10.urdf").getroot()
    assert full.findall("link/visual")
    for link in full.findall("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    bare = ET.parse(default_folder() / "sawyer_ar10_collision.urdf").getroot()
    assert not list(bare.iter("visual"))
    strip = [ET.canonicalize(ET.tostring(tree), strip_text=True) for tree in (full, bare)]
    assert strip[0] == strip[1]


def test_urdf_has_no_mimic_and_names_exactly_the_shipped_meshes():
    """Mimic tags make SAPIEN's grasps unstable; a missing mesh would only show when rendering."""
    tree = ET.parse(default_folder() / "sawyer_ar10.urdf")
    assert not list(tree.iter("mimic"))
    named = {mesh.get("filename") for mesh in tree.iter("mesh")}
    assert named == {name for name in shipped_files(default_folder()) if name.endswith(".glb")}


# -- the numbers -------------------------------------------------------------------------------


def test_masses_and_arm_inertias_match_the_sheet(sheet):
    """Mass and centre of mass are the sheet's on every link, and so is any inertia it states."""
    for name, facts in sheet["links"].items():
        inertia = SAWYER_AR10.link(name).inertia
        if facts["mass"] is None:
            assert inertia is None
            continue
        assert inertia is not None
        assert inertia.mass == facts["mass"]
        assert list(inertia.com) == facts["com"]
        if facts["inertia_xx_yy_zz_xy_xz_yz"] is not None:
            tensor = [getattr(inertia, term) for term in ("xx", "yy", "zz", "xy", "xz", "yz")]
            assert tensor == facts["inertia_xx_yy_zz_xy_xz_yz"]


def test_collision_primitives_match_the_sheet(sheet):
    """Type, size, place and direction of every primitive are the sheet's."""
    for name, facts in sheet["links"].items():
        primitives = SAWYER_AR10.link(name).collisions
        assert len(primitives) == len(facts["collision"])
        for primitive, fact in zip(primitives, facts["collision"], strict=True):
            np.testing.assert_allclose(primitive.xyz, fact["center"], atol=1e-9)
            if isinstance(primitive, Box):
                assert (list(primitive.size), list(primitive.rpy)) == (fact["size"], fact["rpy"])
            else:
                assert (primitive.radius, primitive.length) == (fact["radius"], fact["length"])
                along = rotation(primitive.rpy)[:, 2]
                np.testing.assert_allclose(along, np.eye(3)["xyz".index(fact["axis"])], atol=1e-9)


def test_joint_limits_match_the_sheet(sheet):
    """Range, speed and effort of all 21 moving joints are the sheet's, and so is the coupling."""
    facts = {joint["name"]: joint for joint in sheet["joints"] if joint["type"] == "revolute"}
    assert set(facts) == set(MOVING)
    for name, fact in facts.items():
        joint = SAWYER_AR10.joint(name)
        for key in ("lower", "upper", "velocity", "effort"):
            assert getattr(joint, key) == fact[key], (name, key)
    couplings = {c.joint: [c.source, c.ratio, c.offset] for c in AR10.couplings}
    assert couplings == {name: fact["mimic"] for name, fact in facts.items() if "mimic" in fact}


def test_coupled_joints_stay_within_their_limits():
    """Wherever a pip joint may stand, its link rod keeps the dip joint inside its range."""
    for coupling in AR10.couplings:
        source, joint = SAWYER_AR10.joint(coupling.source), SAWYER_AR10.joint(coupling.joint)
        for angle in (source.lower, source.upper):
            assert joint.lower <= coupling.ratio * angle + coupling.offset <= joint.upper


def test_every_inertia_is_that_of_a_possible_body():
    """Principal moments are positive and none exceeds the sum of the other two."""
    for link in SAWYER_AR10.links:
        if link.inertia is not None:
            a, b, c = np.linalg.eigvalsh(link.inertia.matrix())
            assert 0.0 < a <= b <= c <= (a + b) * (1.0 + 1e-9), link.name


def test_inertia_of_a_box_cut_in_two_is_that_of_the_whole():
    """Parallel axes: two halves, one of them turned about the cut's axis, make up the box again."""
    whole = Box(name="whole", size=(0.2, 0.1, 0.1), xyz=(0.3, 0.0, 0.0))
    near = Box(name="near", size=(0.1, 0.1, 0.1), xyz=(0.25, 0.0, 0.0))
    far = Box(name="far", size=(0.1, 0.1, 0.1), xyz=(0.35, 0.0, 0.0), rpy=(math.pi / 2, 0.0, 0.0))
    expected = inertia_of_primitives(2.0, (0.3, 0.0, 0.0), [whole]).matrix()
    found = inertia_of_primitives(2.0, (0.3, 0.0, 0.0), [near, far]).matrix()
    np.testing.assert_allclose(found, expected, atol=1e-12)
    closed_form = 2.0 / 12.0 * np.diag([0.02, 0.05, 0.05])
    np.testing.assert_allclose(expected, closed_form, atol=1e-12)


def test_inertia_of_a_lying_cylinder_is_turned_with_it():
    """A cylinder along y has its small moment about y."""
    lying = Cylinder(name="bar", radius=0.01, length=0.3, rpy=(-math.pi / 2, 0.0, 0.0))
    inertia = inertia_of_primitives(1.0, (0.0, 0.0, 0.0), [lying])
    assert inertia.yy == pytest.approx(0.01**2 / 2)
    assert inertia.xx == inertia.zz == pytest.approx((3 * 0.01**2 + 0.3**2) / 12)


def test_tree_has_one_root_and_no_orphan():
    """Every link but the root has exactly one parent, and parents come before their children."""
    known = {SAWYER_AR10.root}
    for joint in SAWYER_AR10.joints:
        assert joint.parent in known, joint.name
        assert joint.child not in known, joint.name
        known.add(joint.child)
    assert known == {link.name for link in SAWYER_AR10.links}


def test_parts_share_out_the_hand():
    """The six sensed parts, in observation order, own every solid link of the hand once."""
    assert list(PART_PRIMITIVES) == ["palm", "index", "middle", "ring", "little", "thumb"]
    owned = [link for links in AR10.part_links.values() for link in links]
    solid = [link.name for link in HAND_LINKS if link.collisions]
    assert sorted(owned) == sorted(solid)
    for part, entries in PART_PRIMITIVES.items():
        assert {link for link, _ in entries} == set(AR10.part_links[part])


def test_default_folder_is_inside_the_package():
    """The shipped files are found through the package, also when it is installed elsewhere."""
    assert default_folder().is_dir()
    assert default_folder().relative_to(Path(default_folder().anchor)).parts[-2:] == (
        "robots",
        "sawyer_ar10",
    )
