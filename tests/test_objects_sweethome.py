"""Laws of the furniture catalogues: true sizes, named authors, nothing that a hand cannot take."""

import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

from maniskill_taskgrasp.assets.objects.commands import import_objects
from maniskill_taskgrasp.assets.objects.folders import cache_folder
from maniskill_taskgrasp.assets.objects.library import load, names
from maniskill_taskgrasp.assets.objects.sweethome import (
    PROPERTIES,
    graspable_entries,
    import_entry,
    parse_properties,
)
from maniskill_taskgrasp.errors import InputError

DEBIAN = Path("/usr/share/sweethome3d/furniture")
CATALOGUE = r"""
# A catalogue of three.
license=Creative Commons Attribution 3.0
name#1=Caf\u00e9 \
   mug
model#1=/made/mug/mug.obj
width#1=11.5
depth#1=8
height#1=10
movable#1=true
doorOrWindow#1=false
creator#1=Ada
name#2=Sofa
model#2=/made/sofa/sofa.obj
width#2=200
depth#2=90
height#2=80
movable#2=true
name#3=Window
model#3=/made/window/window.obj
width#3=10
depth#3=5
height#3=10
movable#3=true
doorOrWindow#3=true
"""


@pytest.fixture(autouse=True)
def own_library(tmp_path, monkeypatch):
    """Each test has an empty library of its own."""
    monkeypatch.setenv("TASKGRASP_HOME", str(tmp_path / "home"))
    cache_folder.cache_clear()
    yield
    cache_folder.cache_clear()


@pytest.fixture
def archive(tmp_path):
    """A catalogue whose mug is drawn a hundred times too small and out of proportion."""
    path = tmp_path / "Made.sh3f"
    with zipfile.ZipFile(path, "w") as zipped:
        zipped.writestr(PROPERTIES, CATALOGUE.encode("latin-1"))
        zipped.writestr(
            "made/mug/mug.obj", trimesh.creation.box((0.05, 0.10, 0.07)).export(file_type="obj")
        )
        zipped.writestr("../escaped.obj", "v 0 0 0")
    return path


def test_properties_are_read_as_java_does():
    """Comments, continued lines and \\u escapes."""
    values = parse_properties(CATALOGUE)
    assert values["name#1"] == "Café mug"
    assert values["license"] == "Creative Commons Attribution 3.0"
    assert not any(key.startswith("#") for key in values)


def test_only_movable_things_for_the_hand_are_taken(archive):
    """The sofa is too large and the window a window; the mug keeps its author and licence."""
    (entry,) = graspable_entries(archive)
    assert entry.name == "caf mug"
    assert entry.size_m == pytest.approx((0.115, 0.10, 0.08))
    assert (entry.author, entry.licence) == ("Ada", "Creative Commons Attribution 3.0")


def test_model_gets_the_size_the_catalogue_states(archive):
    """x is the width, y the height, z the depth, whatever the file's own scale."""
    (result,) = import_objects(archive, progress=False)
    assert result["dimensions_m"] == pytest.approx([0.115, 0.10, 0.08], abs=1e-4)
    model = load("caf mug")
    assert "by Ada" in model.source
    assert model.licence == "Creative Commons Attribution 3.0"
    # The file's y axis is up: standing, 10 cm are vertical.
    standing = next(p for p in model.resting_poses if p.name == "standing")
    assert standing.height == pytest.approx(0.05, abs=1e-3)


def test_broken_catalogue_is_one_clear_line(tmp_path):
    """A zip without the properties, or no zip at all."""
    path = tmp_path / "broken.sh3f"
    path.write_bytes(b"PK but not really")
    with pytest.raises(InputError, match="not a Sweet Home 3D"):
        import_objects(path)
    assert names("imported") == ()


@pytest.mark.slow
def test_debian_catalogue_is_imported(record_property):
    """At least 100 graspable models; each becomes an object; half take 5 s or less of one core."""
    if not DEBIAN.is_dir():
        pytest.skip("Debian's sweethome3d-furniture is not installed")
    seconds, close = [], 0
    entries = [(f, e) for f in sorted(DEBIAN.glob("*.sh3f")) for e in graspable_entries(f)]
    for archive, entry in entries:
        start = time.process_time()
        model, notes = import_entry(archive, entry)
        seconds.append(time.process_time() - start)
        close += not any("convex parts" in note for note in notes)
        assert model.licence != "not stated"
        assert "by " in model.source
        assert np.isfinite(model.inertia).all()
        # A model that lies askew in its stated box is turned into a smaller one.
        assert np.prod(model.extents_m) <= 1.02 * np.prod(entry.size_m), entry.name
    record_property("median_s", float(np.median(seconds)))
    record_property("parts_within_limits", close)
    assert len(entries) >= 100
    assert np.median(seconds) <= 5.0
