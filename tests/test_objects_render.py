"""Laws of object pictures: they show the object, and where nothing can be drawn they say so."""

import os
import subprocess
import sys

import numpy as np
import pytest

from maniskill_taskgrasp.assets.objects.commands import show_object
from maniskill_taskgrasp.assets.objects.library import load, names
from maniskill_taskgrasp.assets.objects.render import CARD, LABEL, TILE, contact_sheet, pose_shown
from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.tasks.rendering import rendering_available

draws = pytest.mark.skipif(not rendering_available(), reason="pictures need a Vulkan device")


def pixels(path):
    """(height, width, 3) of a picture file."""
    from PIL import Image

    return np.asarray(Image.open(path).convert("RGB"), dtype=int)


@pytest.mark.parametrize("name", ["card", "card.xyz", "card.stl"])
def test_name_of_no_picture_is_one_clear_line(name, tmp_path):
    """Refused before anything is drawn."""
    with pytest.raises(InputError, match=r"names no picture: \.png"):
        show_object("coin", tmp_path / name)


@draws
def test_picture_that_cannot_be_written_is_one_clear_line(tmp_path):
    """Below a file, where no folder can be."""
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="cannot write"):
        show_object("coin", tmp_path / "file" / "coin.png")


@pytest.mark.slow
@draws
def test_card_shows_mesh_parts_offer_and_every_pose(tmp_path):
    """Three pictures and one a resting pose, none of them empty, above lines of numbers."""
    facts = show_object("hammer", tmp_path / "hammer.png")
    card = pixels(tmp_path / "hammer.png")
    count = 3 + len(facts["resting_poses"])
    rows = -(-count // 3)
    assert card.shape[1] == 3 * CARD
    assert card.shape[0] > rows * (CARD + LABEL)
    for index in range(count):
        top, left = index // 3 * (CARD + LABEL), index % 3 * CARD
        picture = card[top : top + CARD, left : left + CARD]
        ground = picture[5, 5]
        assert (np.abs(picture - ground).max(axis=2) > 40).mean() > 0.01, index


@pytest.mark.slow
@draws
def test_contact_sheet_shows_each_object_in_its_colours(tmp_path):
    """The screwdriver's tile is red in part, the tennis ball's greenish yellow for the most."""
    contact_sheet([load("screwdriver"), load("ball")], tmp_path / "sheet.png", columns=2)
    sheet = pixels(tmp_path / "sheet.png")
    assert sheet.shape == (TILE + LABEL, 2 * TILE, 3)
    red, green, blue = sheet[:TILE, :TILE].reshape(-1, 3).T
    assert ((red > 2 * green) & (red > 2 * blue)).mean() > 0.01
    red, green, blue = sheet[:TILE, TILE:].reshape(-1, 3).T
    assert ((green > red) & (green > 2 * blue)).mean() > 0.3


def test_pose_shown_is_one_of_the_object_s():
    """A bottle stands, a pen lies."""
    assert all(pose_shown(load(name)) in load(name).resting_poses for name in names())
    assert pose_shown(load("bottle")).name == "standing"
    assert pose_shown(load("pen")).name == "lying"


def test_without_a_vulkan_device_the_picture_is_refused_in_one_line(tmp_path):
    """The numbers need none, the picture does."""
    bare = {**os.environ, "VK_DRIVER_FILES": "/dev/null", "VK_ICD_FILENAMES": "/dev/null"}
    command = [sys.executable, "-m", "maniskill_taskgrasp", "objects", "show", "hammer"]
    shown = subprocess.run(command, env=bare, capture_output=True, text=True, check=False)
    assert shown.returncode == 0, shown.stderr
    refused = subprocess.run(
        [*command, "--out", str(tmp_path / "hammer.png")],
        env=bare,
        capture_output=True,
        text=True,
        check=False,
    )
    assert refused.returncode == 2
    assert "Vulkan" in refused.stderr.splitlines()[-1]
    assert "Traceback" not in refused.stderr
    assert not (tmp_path / "hammer.png").exists()
