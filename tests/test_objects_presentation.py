"""Laws of how objects are offered: the rule, and stands that are real and let the object go."""

import numpy as np
import pytest

from maniskill_taskgrasp.assets.objects.fixtures import RAIL_HEIGHT, outline
from maniskill_taskgrasp.assets.objects.geometry import depth_inside, quat_to_matrix
from maniskill_taskgrasp.assets.objects.library import load, names
from maniskill_taskgrasp.assets.objects.presentation import MAX_SPAN, MIN_HEIGHT, present
from maniskill_taskgrasp.errors import InputError


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("mug", "table"),  # High and narrow enough.
        ("hammer", "table"),  # Its handle is 2 cm high; that the head is 12 cm long is no matter.
        ("marker", "rail"),  # A lying rod of 1 cm.
        ("thin rod", "rail"),
        ("plate", "rack"),  # Flat and wider than the hand.
        ("coin", "rack"),  # Flat, and people take it across its thickness.
        ("metal can", "table"),  # 10 cm across every way: no stand would help.
    ],
)
def test_rule_offers_each_kind_of_thing_as_people_would(name, kind):
    """auto follows the rule, and its reason says why."""
    offered = present(load(name))
    assert offered.kind == kind
    assert " cm" in offered.reason
    assert bool(offered.parts) == (kind != "table")


def test_objects_on_the_bare_table_are_high_enough_or_the_reason_says_so():
    """auto leaves nothing thinner than 1.5 cm on the table without a word."""
    for name in names()[::3]:
        offered = present(load(name))
        if offered.kind == "table" and "within reach" not in offered.reason:
            assert "no " in offered.reason
        if offered.kind == "rail":
            assert f"below {100 * MIN_HEIGHT:.1f} cm" in offered.reason


def test_table_uses_the_pose_that_was_drawn():
    """Pose i of the object is what the table presentation shows."""
    model = load("bottle")
    for index, pose in enumerate(model.resting_poses):
        offered = present(model, "table", index)
        assert offered.quat_wxyz == pose.quat_wxyz
        assert offered.position == (0.0, 0.0, pose.height)


@pytest.mark.parametrize("kind", ["rail", "rack", "holder"])
def test_stand_touches_but_does_not_pierce_and_lets_the_object_rise(kind):
    """At the start no part of the fixture is more than 1 mm in the object, nor on its way up."""
    seen = 0
    for name in names()[::5]:
        model = load(name)
        if kind not in model.stands:
            continue
        seen += 1
        offered = present(model, kind)
        points = outline(model, quat_to_matrix(offered.quat_wxyz)) + offered.position
        for rise in (0.0, 0.01, 0.03, 0.06, 0.1):
            moved = points + np.array([0, 0, rise])
            deepest = max(depth_inside(part, moved).max() for part in offered.parts)
            assert deepest < 1e-3, (name, rise)
    assert seen >= 8


def test_stands_stand_on_the_table():
    """Every board reaches from the table up, none below it."""
    for name, kind in (("marker", "rail"), ("plate", "rack"), ("pen", "holder")):
        for part in present(load(name), kind).parts:
            assert part.position[2] - part.size[2] == pytest.approx(0, abs=1e-9)


def test_rail_raises_the_object_by_its_height():
    """The lowest point of a rod on the rail is near the rail's top, so fingers reach below it."""
    model = load("thin rod")
    offered = present(model, "rail")
    points = outline(model, quat_to_matrix(offered.quat_wxyz)) + offered.position
    assert RAIL_HEIGHT - 0.004 < points[:, 2].min() < RAIL_HEIGHT + 1e-6


def test_holder_takes_the_slim_end_of_a_screwdriver():
    """The thick handle is up, where the hand can get at it."""
    model = load("screwdriver")
    offered = present(model, "holder")
    up = quat_to_matrix(offered.quat_wxyz).T @ [0, 0, 1]
    thick_end = np.sign(
        sum(v[0] for v in outline(model, np.eye(3)) if np.hypot(v[1], v[2]) > 0.012)
    )
    assert up[0] * thick_end > 0.99


def test_bad_wishes_are_refused_in_one_line():
    """Unknown kinds, and fixtures that cannot hold the object, name what would do."""
    with pytest.raises(InputError, match="unknown presentation"):
        present(load("pen"), "shelf")
    with pytest.raises(InputError, match="table"):
        present(load("ball"), "holder")
    with pytest.raises(InputError, match="rack"):
        present(load("mug"), "rack")


def test_stand_never_fails_and_rarely_means_the_table():
    """ "stand" falls back to the table for few objects, with the reason."""
    kinds = [present(load(name), "stand") for name in names()[::3]]
    bare = [offered for offered in kinds if offered.kind == "table"]
    assert len(bare) <= 0.1 * len(kinds)
    assert all("no " in offered.reason for offered in bare)
    assert MAX_SPAN < 0.1
