"""Laws of imported meshes: equal terms for good ones, one clear line for bad ones."""

import json
import struct

import numpy as np
import pytest
import trimesh

from maniskill_taskgrasp.assets.objects.affordance import roundness, zingg_shape
from maniskill_taskgrasp.assets.objects.commands import import_objects, list_objects, show_object
from maniskill_taskgrasp.assets.objects.decompose import MAX_PARTS, convex_parts
from maniskill_taskgrasp.assets.objects.folders import cache_folder, user_objects_folder
from maniskill_taskgrasp.assets.objects.library import load, names
from maniskill_taskgrasp.assets.objects.meshfile import infer_units, read_mesh
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import load_knowledge

MESHES = "data/meshes"


@pytest.fixture(autouse=True)
def own_library(tmp_path, monkeypatch):
    """Each test has an empty library of its own."""
    monkeypatch.setenv("TASKGRASP_HOME", str(tmp_path / "home"))
    cache_folder.cache_clear()
    yield
    cache_folder.cache_clear()


def save(mesh, path):
    path.write_bytes(mesh.export(file_type=path.suffix[1:]))
    return path


def cylinder(radius=20.0, height=100.0):
    return trimesh.creation.cylinder(radius=radius, height=height, sections=48)


def snapshot():
    """Files of the user's library and their content."""
    folder = user_objects_folder()
    return {p.name: p.read_bytes() for p in folder.rglob("*")} if folder.exists() else {}


def test_imported_object_is_like_any_other(tmp_path):
    """A cylinder in mm gets units, frame, mass, parts, poses, stands, affordances, and loads."""
    (result,) = import_objects(save(cylinder(), tmp_path / "My Can.stl"))
    assert result["name"] == "my can"
    assert "units mm inferred from a longest extent of 100" in result["notes"]
    assert any("mass" in note and "guessed" in note for note in result["notes"])
    model = load("my can")
    np.testing.assert_allclose(model.extents_m, [0.1, 0.04, 0.04], rtol=1e-3)
    assert model.mass_kg == pytest.approx(300 * np.pi * 0.02**2 * 0.1, rel=0.01)
    assert len(model.parts) == 1
    assert {"standing", "lying"} <= {pose.name for pose in model.resting_poses}
    assert (model.affordance.shape, model.affordance.roundness) == ("prolate", "a")
    assert (model.affordance.type, model.affordance.grasped_dimension) == ("cylinder", "b/c")
    assert model.split == "imported"
    assert names("imported") == ("my can",)
    assert "my can" not in names()
    assert [o["name"] for o in list_objects("imported")] == ["my can"]
    across = model.mass_kg * (3 * 0.02**2 + 0.1**2) / 12
    np.testing.assert_allclose(np.diag(model.inertia)[1:], across, rtol=0.01)
    assert model.visual().is_watertight
    assert show_object("my can")["resting_poses"]


def test_given_units_and_mass_are_taken(tmp_path):
    """Ten units long in cm is 10 cm; the mass is the one given."""
    path = save(cylinder(2, 10), tmp_path / "can.ply")
    (result,) = import_objects(path, units="cm", mass=0.25)
    assert result["dimensions_m"] == pytest.approx([0.1, 0.04, 0.04], rel=1e-3)
    assert load("can").mass_kg == 0.25
    assert result["notes"][0] == "units cm as given"


@pytest.mark.parametrize(
    ("longest", "suffix", "units"),
    [(0.12, ".stl", "m"), (12.0, ".obj", "cm"), (120.0, ".stl", "mm"), (0.5, ".glb", "m")],
)
def test_units_are_those_that_make_a_thing_for_the_hand(longest, suffix, units):
    """0.12 is metres, 12 is centimetres, 120 is millimetres; glTF is metres by its standard."""
    assert infer_units(longest, suffix)[0] == units


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".glb", ".off"])
def test_formats_give_the_same_object(tmp_path, suffix):
    """The same box out of any format has the same size."""
    path = save(trimesh.creation.box((0.12, 0.05, 0.02)), tmp_path / f"box{suffix}")
    np.testing.assert_allclose(
        sorted(read_mesh(path, "m").mesh.extents), [0.02, 0.05, 0.12], atol=1e-6
    )


def test_askew_mesh_is_straightened(tmp_path):
    """A box turned by 30 degrees gets its own extents back."""
    mesh = trimesh.creation.box((0.12, 0.05, 0.02))
    mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 6, [0, 1, 1]))
    model = load(str(save(mesh, tmp_path / "askew.stl")))
    np.testing.assert_allclose(model.extents_m, [0.12, 0.05, 0.02], atol=1e-4)


def test_hollow_shape_is_cut_into_few_parts(tmp_path):
    """An L of two bars becomes two to eight convex parts with its volume, not its hull's."""
    bars = [trimesh.creation.box((0.12, 0.02, 0.02)), trimesh.creation.box((0.02, 0.08, 0.02))]
    bars[1].apply_translation([0.05, 0.04, 0])
    mesh = trimesh.boolean.union(bars, engine="manifold")
    parts = convex_parts(mesh)
    assert 2 <= len(parts) <= MAX_PARTS
    volume = sum(trimesh.Trimesh(p.vertices).convex_hull.volume for p in parts)
    assert volume == pytest.approx(mesh.volume, rel=0.1)


def test_open_mesh_is_imported_with_a_note(tmp_path):
    """A tube without its end discs: volume and inertia come from the parts, and that is said."""
    mesh = cylinder()
    mesh.update_faces(np.abs(mesh.face_normals[:, 2]) < 0.5)
    (result,) = import_objects(save(mesh, tmp_path / "open.stl"))
    assert result["parts"] <= MAX_PARTS
    assert load("open").volume_m3 == pytest.approx(np.pi * 0.02**2 * 0.1, rel=0.1)


def test_fine_mesh_is_thinned(tmp_path):
    """A ball of 82,000 faces is drawn with at most 60,000 and is one part of 64 corners."""
    mesh = trimesh.creation.icosphere(subdivisions=6, radius=0.03)
    model = load(str(save(mesh, tmp_path / "ball.stl")))
    assert len(model.visual().faces) <= 61_000
    assert len(model.parts) == 1
    assert len(model.parts[0].vertices) <= 64
    assert model.affordance.roundness == "abc"


def test_file_on_the_fly_is_made_once(tmp_path, monkeypatch):
    """load(path) imports without storing in the library; a second time it comes from the cache."""
    path = save(cylinder(), tmp_path / "fly.stl")
    first = load(str(path))
    assert snapshot() == {}
    monkeypatch.setattr(
        "maniskill_taskgrasp.assets.objects.importer.read_mesh",
        lambda *_: pytest.fail("read again"),
    )
    again = load(str(path))
    assert again.extents_m == first.extents_m
    assert again.resting_poses == first.resting_poses


def test_importing_twice_replaces(tmp_path):
    """The second import of a name leaves one object, with the new size."""
    path = save(cylinder(), tmp_path / "can.stl")
    import_objects(path)
    save(cylinder(height=80), path)
    import_objects(path)
    assert names("imported") == ("can",)
    assert load("can").extents_m[0] == pytest.approx(0.08, rel=1e-3)


def test_import_does_not_hide_a_catalogue_object(tmp_path):
    """A mesh called hammer.stl becomes "hammer imported"."""
    (result,) = import_objects(save(cylinder(), tmp_path / "hammer.stl"))
    assert result["name"] == "hammer imported"
    assert load("hammer").split != "imported"


def test_folder_imports_what_does_and_says_what_does_not(tmp_path):
    """Good files and bad side by side; equal stems in different folders stay apart."""
    folder = tmp_path / "in"
    (folder / "sub").mkdir(parents=True)
    save(cylinder(), folder / "can.stl")
    save(cylinder(), folder / "sub" / "can.stl")
    (folder / "bad.stl").write_text("nonsense")
    results = import_objects(folder, progress=False)
    assert [r["name"] for r in results if "name" in r] == ["can", "can 2"]
    (bad,) = [r for r in results if "error" in r]
    assert "bad.stl" in bad["file"] and "\n" not in bad["error"]
    assert names("imported") == ("can", "can 2")


def binary_stl(triangles, count=None):
    """Bytes of a binary STL; `count` may lie about the number of triangles."""
    body = b"".join(
        struct.pack("<12fH", 0, 0, 0, *np.asarray(t, dtype=float).ravel(), 0) for t in triangles
    )
    return bytes(80) + struct.pack("<I", len(triangles) if count is None else count) + body


def five_million_faces(path):
    """A file as large as five million triangles, of which the disc holds almost none."""
    with path.open("wb") as file:
        file.write(bytes(80) + struct.pack("<I", 5_000_000))
        file.truncate(84 + 50 * 5_000_000)


TRIANGLE = [[[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]]]
BOX = trimesh.creation.box((0.1, 0.05, 0.02)).triangles


def box_with(value):
    """The box with one corner coordinate replaced."""
    triangles = BOX.copy()
    triangles[3, 1, 2] = value
    return binary_stl(triangles)


MALFORMED = {
    "nothing.stl": b"",
    "text.stl": b"this is not a mesh at all",
    "text.obj": b"dear sir or madam\nplease find enclosed\n",
    "noise.glb": np.random.default_rng(0).bytes(4000),
    "noise.ply": np.random.default_rng(1).bytes(4000),
    "header.ply": b"ply\nformat ascii 1.0\nelement vertex 8\n",
    "picture.png": b"\x89PNG\r\n\x1a\n",
    "no faces.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    "no such vertex.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
    "truncated.stl": binary_stl(BOX)[:300],
    "lying count.stl": binary_stl(BOX, count=4_000_000_000),
    "flat.stl": binary_stl(TRIANGLE),
    "points.stl": binary_stl([[[0.1, 0.1, 0.1]] * 3] * 4),
    "line.stl": binary_stl([[[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]]] * 4),
    "nan.stl": box_with(np.nan),
    "infinite.stl": box_with(np.inf),
    "huge.stl": box_with(3e38),
    "kilometre.stl": binary_stl(BOX * 1e7),
    "speck.stl": binary_stl(BOX * 1e-3),
    "foil.stl": binary_stl(BOX * [1, 1, 0.001]),
    "json.gltf": json.dumps({"asset": {"version": "2.0"}}).encode(),
    "five million.stl": five_million_faces,
}


@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_file_gives_one_clear_line_and_changes_nothing(tmp_path, name, capfd):
    """No traceback, no print, one line with the file's name; the library is as it was."""
    import_objects(save(cylinder(), tmp_path / "good.stl"))
    before, path, content = snapshot(), tmp_path / name, MALFORMED[name]
    content(path) if callable(content) else path.write_bytes(content)
    capfd.readouterr()
    with pytest.raises(InputError) as caught:
        import_objects(path)
    message = str(caught.value)
    assert "\n" not in message and len(message) < 300
    assert name.rsplit(".", 1)[0].split()[0] in message
    assert snapshot() == before
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("kwargs", "match"),
    [
        ({"units": "inch"}, "unknown units"),
        ({"mass": -1.0}, "mass"),
        ({"mass": float("nan")}, "mass"),
    ],
)
def test_bad_options_are_refused(tmp_path, kwargs, match):
    """Units and mass too are a user's input."""
    with pytest.raises(InputError, match=match):
        import_objects(save(cylinder(), tmp_path / "can.stl"), **kwargs)
    assert snapshot() == {}


@pytest.mark.parametrize("path", ["nowhere.stl", "no/such/folder"])
def test_missing_paths_are_named(path):
    """Both ways in say what is missing."""
    with pytest.raises(InputError, match="no "):
        import_objects(path)
    with pytest.raises(InputError, match="no mesh file"):
        load(path)


def test_damaged_library_entry_is_named(tmp_path):
    """A half-written JSON file of an older version gives a clear line, not a traceback."""
    import_objects(save(cylinder(), tmp_path / "can.stl"))
    (user_objects_folder() / "can.json").write_text('{"name": "can"')
    with pytest.raises(InputError, match="damaged"):
        load("can")


def test_zingg_classes_are_those_of_the_data_set():
    """Shape is a function of the extents: it agrees with every object."""
    known = [o for o in load_knowledge().objects.values() if not o.is_floppy]
    wrong = [o.name for o in known if zingg_shape(o.dimensions_m) != o.shape]
    assert wrong == []


def test_roundness_of_simple_shapes():
    """A cylinder is round about its length, a disc about its thickness, a box about nothing."""
    for mesh, shape, expected in (
        (cylinder(2, 10), "prolate", "a"),
        (cylinder(5, 1), "oblate", "c"),
        (trimesh.creation.box((5, 4.9, 1)), "oblate", "non-round"),
        (trimesh.creation.icosphere(radius=2), "equant", "abc"),
    ):
        order = np.argsort(-mesh.extents, kind="stable")
        points = mesh.vertices[:, order]
        assert roundness(points, shape) == expected


@pytest.mark.slow
def test_authors_meshes_are_all_imported(shared_dir):
    """The authors' 20 meshes: all succeed, and their shape class is the data set's."""
    results = import_objects(shared_dir / MESHES, progress=False)
    assert len(results) == 20
    assert [r for r in results if "error" in r] == []
    index = json.loads((shared_dir / MESHES / "index.json").read_text("utf-8"))
    shapes = {e["name"]: e["shape"] for e in index}
    found = {r["name"].removesuffix(" imported"): r["shape"] for r in results}
    assert sum(found.get(name) == shape for name, shape in shapes.items()) >= 18
