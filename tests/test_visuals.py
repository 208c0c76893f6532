"""The shapes the robot is drawn with, and that pictures show contact where the physics has it."""

import itertools
import json
import struct

import numpy as np
import pytest

from maniskill_taskgrasp.agents.robot_model import rotation
from maniskill_taskgrasp.agents.sawyer_ar10.description import HAND_JOINT_NAMES, SAWYER_AR10
from maniskill_taskgrasp.agents.sawyer_ar10.elbow import Elbow
from maniskill_taskgrasp.agents.sawyer_ar10.glb import Surface, glb
from maniskill_taskgrasp.agents.sawyer_ar10.look_ar10 import LOOKS as AR10_LOOKS
from maniskill_taskgrasp.agents.sawyer_ar10.look_sawyer import LOOKS as SAWYER_LOOKS
from maniskill_taskgrasp.agents.sawyer_ar10.shapes import (
    cylinder,
    plate,
    rounded_box,
    shade,
)
from maniskill_taskgrasp.agents.sawyer_ar10.visuals import MATERIALS, link_meshes

LOOKS = {**SAWYER_LOOKS, **{mesh: look for mesh, (_, look) in AR10_LOOKS.items()}}


def volume(soup):
    """Volume that a closed soup encloses; negative when it is inside out."""
    return np.einsum("ij,ij->", soup[:, 0], np.cross(soup[:, 1], soup[:, 2])) / 6.0


def is_closed(soup):
    """Whether every edge is run through once each way."""
    points = np.round(soup, 6)
    edges = {}
    for triangle in points:
        corners = [tuple(corner + 0.0) for corner in triangle]
        if len(set(corners)) < 3:
            continue
        for start, stop in itertools.pairwise([*corners, corners[0]]):
            edges[start, stop] = edges.get((start, stop), 0) + 1
    return all(edges.get((stop, start), 0) == count for (start, stop), count in edges.items())


def visual_points(link, material=None):
    """(n, 3) [m] corners of a link's visible shapes, of one material if it is named."""
    look = LOOKS[link_meshes()[link]]()
    soups = [soup for name, soup in look if material in (None, name)]
    return np.concatenate(soups).reshape(-1, 3) * 1e-3


@pytest.mark.parametrize("part", LOOKS)
def test_every_shape_is_outside_out_and_of_a_known_material(part):
    """Each shape of each part encloses a positive volume and has a material to be drawn with."""
    for material, soup in LOOKS[part]():
        assert material in MATERIALS
        assert volume(soup) > 0


@pytest.mark.parametrize(
    ("soup", "expected"),
    [
        (cylinder(10.0, 30.0, sectors=96), np.pi * 100 * 30),
        # Less what is missing from four edges each way, and from eight corners.
        (
            rounded_box((20, 30, 40), 5, 12),
            20 * 30 * 40 - (4 - np.pi) * 5**2 * (10 + 20 + 30) - (8 - np.pi * 4 / 3) * 5**3,
        ),
        # Two half discs and the rectangle between them.
        (plate([(0, 0, 5), (20, 0, 5)], 2, bevel=0.0, sectors=96), 2 * (np.pi * 25 + 200)),
    ],
)
def test_shapes_enclose_their_closed_form_volume(soup, expected):
    """Basic shapes are closed, and as large as their formula says to 1 %."""
    assert is_closed(soup)
    assert volume(soup) == pytest.approx(expected, rel=0.01)


def test_plate_lies_across_its_axis():
    """The two outline coordinates are the ones that follow the plate's axis cyclically."""
    discs = [(0, 0, 1), (10, 0, 1), (0, 20, 1)]
    spans = {axis: np.ptp(plate(discs, 3, axis).reshape(-1, 3), axis=0) for axis in "xyz"}
    for axis, expected in (("x", [3, 12, 22]), ("y", [22, 3, 12]), ("z", [12, 22, 3])):
        np.testing.assert_allclose(spans[axis], expected, atol=0.05)


@pytest.mark.parametrize("cut", [None, 20.0])
def test_elbow_is_round_at_its_ends_and_flat_where_it_is_cut(cut):
    """Both openings have their radius, nothing passes the flat, and the cap lies just on it."""
    elbow = Elbow(
        length_in=150, length_out=120, radius_in=60, radius_bend=55, radius_out=50, bend=9, cut=cut
    )
    tube, cap = elbow.parts()
    points = tube.reshape(-1, 3)
    start, stop = points[points[:, 2] == -150], points[points[:, 1] == 120]
    assert np.linalg.norm(start[:, :2], axis=1).max() == pytest.approx(60)
    assert np.linalg.norm(stop[:, [0, 2]], axis=1).max() == pytest.approx(50)
    assert volume(tube) > 0
    outward = np.array([0.0, -1.0, 1.0]) / np.sqrt(2.0)
    if cut is None:
        assert len(cap) == 0
    else:
        assert (points @ outward).max() == pytest.approx(cut, abs=0.3)
        heights = cap.reshape(-1, 3) @ outward - cut
        assert -2.1 < heights.min() < 0 < heights.max() < 3.6


def test_shading_rounds_tubes_and_keeps_edges():
    """On a cylinder the wall's normals turn smoothly, and the rims stay sharp."""
    vertices, normals, faces = shade(cylinder(10.0, 30.0, sectors=24))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=2e-4)
    flat = np.abs(normals[:, 2]) > 0.5
    np.testing.assert_allclose(np.abs(normals[flat, 2]), 1.0, atol=2e-4)
    radial = vertices[~flat, :2] / 10.0
    np.testing.assert_allclose(normals[~flat, :2], radial, atol=2e-3)
    assert len(faces) == 4 * 24


def test_glb_holds_what_was_put_in():
    """Header, chunks and accessors lead back to the same vertices, normals and faces."""
    vertices, normals, faces = shade(rounded_box((1, 2, 3), 0.2))
    surface = Surface(material={"name": "m"}, vertices=vertices, normals=normals, faces=faces)
    content = glb("part", [surface, surface])
    magic, version, length, json_length, _ = struct.unpack_from("<4sIIII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content))
    document = json.loads(content[20 : 20 + json_length])
    binary = content[28 + json_length :]
    assert document["buffers"][0]["byteLength"] == len(binary)
    for primitive in document["meshes"][0]["primitives"]:
        wanted = (
            (primitive["attributes"]["POSITION"], vertices.astype("<f4")),
            (primitive["attributes"]["NORMAL"], normals.astype("<f4")),
            (primitive["indices"], faces.ravel().astype("<u2")),
        )
        for index, expected in wanted:
            view = document["bufferViews"][document["accessors"][index]["bufferView"]]
            raw = binary[view["byteOffset"] :][: view["byteLength"]]
            found = np.frombuffer(raw, expected.dtype).reshape(expected.shape)
            np.testing.assert_array_equal(found, expected)


PADS = [link.name for link in SAWYER_AR10.links for shape in link.collisions if shape.name == "pad"]


@pytest.mark.parametrize("link", PADS)
def test_rubber_tips_are_drawn_where_they_collide(link):
    """The thimble touches all six faces of its collision box; its rounded corners lack < 3.5 mm."""
    pad = next(shape for shape in SAWYER_AR10.link(link).collisions if shape.name == "pad")
    points = (visual_points(link, "rubber") - pad.xyz) @ rotation(pad.rpy)
    half = np.array(pad.size) / 2
    np.testing.assert_allclose(points.max(axis=0), half, atol=3e-4)
    np.testing.assert_allclose(points.min(axis=0), -half, atol=3e-4)
    for signs in itertools.product((-1, 0, 1), repeat=3):
        way = np.array(signs)
        if way.any():
            length = np.linalg.norm(way)
            lack = (np.abs(way) @ half - (points @ way).max()) / length
            assert -3e-4 <= lack <= 3.5e-3, signs


def test_palm_face_is_drawn_where_it_collides():
    """The visible palm ends within 0.6 mm of the collision boxes, all over its grasping side."""
    palm = SAWYER_AR10.link("hand_base")
    points = visual_points("hand_base")
    for box in palm.collisions:
        if box.name.endswith("_palm"):
            low = np.array(box.xyz) - np.array(box.size) / 2
            high = np.array(box.xyz) + np.array(box.size) / 2
            above = points[
                np.all((points[:, ::2] > low[::2]) & (points[:, ::2] < high[::2]), axis=1)
            ]
            assert abs(above[:, 1].max() - high[1]) <= 6e-4, box.name


@pytest.mark.parametrize("segment", ["proximal", "middle"])
def test_finger_plates_are_drawn_where_they_collide(segment):
    """Sheets of a finger segment end within 1 mm of its box, towards the palm and to the sides."""
    link = SAWYER_AR10.link(f"index_{segment}")
    box = link.collisions[0]
    high = np.array(box.xyz) + np.array(box.size) / 2
    points = visual_points(link.name, "sheet")
    np.testing.assert_allclose(points.max(axis=0)[:2], high[:2], atol=1e-3)


def test_sawyer_is_drawn_in_its_real_size():
    """Each arm link's picture is as large as the manufacturer's mesh to within 12 mm a side."""
    extents = {  # [mm] lower and upper corner, from RethinkRobotics/sawyer_robot.
        "head": ((-41, -128, -7), (41, 128, 240)),
        "l1": ((-67, -140, 1), (69, 72, 202)),
        "l2": ((-53, -53, 1), (53, 53, 316)),
        "l3": ((-54, -126, -174), (54, 57, 0)),
        "l4": ((-53, -47, 7), (54, 47, 322)),
        "l5": ((-46, -76, -2), (50, 51, 152)),
        "l6": ((-42, -41, -40), (42, 68, 25)),
    }
    for link, (low, high) in extents.items():
        points = visual_points(link) * 1e3
        np.testing.assert_allclose(points.min(axis=0), low, atol=12, err_msg=link)
        np.testing.assert_allclose(points.max(axis=0), high, atol=12, err_msg=link)


@pytest.mark.slow
def test_robot_renders_in_its_colours():
    """ManiSkill's loader and SAPIEN show the red arm, the white rings and the dark pedestal."""
    import sapien

    try:
        sapien.render.get_device_summary()
    except RuntimeError:
        pytest.skip("there is no Vulkan device")
    from maniskill_taskgrasp.agents.sawyer_ar10.studio import PALM_DOWN, Studio, posture

    studio = Studio()
    studio.pose(posture(PALM_DOWN, [SAWYER_AR10.joint(name).lower for name in HAND_JOINT_NAMES]))
    view = studio.picture((2.25, -1.95, 0.7), (0.24, 0.0, -0.16), 0.56, (96, 96)).astype(int)
    red, green, blue = np.moveaxis(view, -1, 0)
    shares = {
        "red": np.mean((red > 120) & (green < 70) & (blue < 70)),
        "dark": np.mean((red < 80) & (green < 80) & (blue < 80)),
        "blue": np.mean((blue > 50) & (blue > 2 * red)),
    }
    assert shares["red"] > 0.03
    assert shares["dark"] > 0.05
    assert shares["blue"] > 0.0005
