"""Laws of palm poses, of the joint paths that reach them, and of stored grasps."""

import math

import numpy as np
import pytest
import torch

from maniskill_taskgrasp.agents.sawyer_ar10.hand import AR10
from maniskill_taskgrasp.assets.objects import library
from maniskill_taskgrasp.episode import MAX_EPISODE_STEPS, PHASE_ENDS
from maniskill_taskgrasp.tasks.arm_ik import resample
from maniskill_taskgrasp.tasks.grasp_library import (
    Grasp,
    dump_grasps,
    nearest_grasps,
    stored_grasps,
)
from maniskill_taskgrasp.tasks.placement import place
from maniskill_taskgrasp.tasks.posture_space import PostureSpace
from maniskill_taskgrasp.tasks.pregrasp import (
    HOVER_DISTANCE,
    LIFT_DISTANCE,
    palm_path,
    palm_rotation,
)
from maniskill_taskgrasp.topology import TOPOLOGIES, resolve_topology


@pytest.mark.parametrize(
    ("angles", "fingers", "normal"),
    [
        ((0.0, 0.0, 0.0), (1, 0, 0), (0, 0, -1)),  # Palm down, fingers away from the robot.
        ((math.pi / 2, 0.0, 0.0), (0, 0, -1), (-1, 0, 0)),  # Full tilt: fingers down.
        ((0.0, math.pi / 2, 0.0), (1, 0, 0), (0, 1, 0)),  # Rolled sideways: palm to the left.
        ((0.0, 0.0, math.pi / 2), (0, 1, 0), (0, 0, -1)),  # Yaw turns the fingers to the left.
    ],
)
def test_palm_rotation_known_poses(angles, fingers, normal):
    rotation = palm_rotation(*torch.tensor(angles)[:, None])[0]
    torch.testing.assert_close(rotation[:, 2], torch.tensor(fingers).float(), atol=1e-6, rtol=0)
    torch.testing.assert_close(rotation[:, 1], torch.tensor(normal).float(), atol=1e-6, rtol=0)


def test_palm_path_puts_the_object_where_the_pregrasp_says():
    """The object's centre, seen from the palm, is the pregrasp's first three numbers."""
    generator = torch.Generator().manual_seed(0)
    pregrasp = torch.rand(20, 6, generator=generator) - 0.5
    centre = torch.rand(20, 3, generator=generator)
    path = palm_path(pregrasp, centre)
    seen = (path.rotation.transpose(1, 2) @ (centre - path.grasp)[..., None])[..., 0]
    torch.testing.assert_close(seen, pregrasp[:, :3], atol=1e-6, rtol=0)
    torch.testing.assert_close((path.lift - path.grasp)[:, 2], torch.full((20,), LIFT_DISTANCE))
    gap = (path.hover - path.grasp).norm(dim=1)
    torch.testing.assert_close(gap, torch.full((20,), HOVER_DISTANCE), atol=1e-6, rtol=0)


def test_palm_path_comes_from_where_the_palm_faces_away():
    """Palm down: from above. Palm sideways: level, along its normal."""
    pregrasp = torch.zeros(2, 6)
    pregrasp[1, 4] = math.pi / 2
    path = palm_path(pregrasp, torch.zeros(2, 3))
    retreat = (path.hover - path.grasp) / HOVER_DISTANCE
    expected = torch.tensor([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    torch.testing.assert_close(retreat, expected, atol=1e-6, rtol=0)


def test_resample_ends_where_the_path_ends_and_starts_and_stops_softly():
    path = torch.linspace(0, 1, 9)[None, :, None].expand(2, 9, 7)
    steps = resample(path, 16)
    assert steps.shape == (2, 16, 7)
    torch.testing.assert_close(steps[:, -1], path[:, -1])
    change = steps[0, 1:, 0] - steps[0, :-1, 0]
    assert (change > 0).all()
    assert change[-1] < 0.3 * change[7] and steps[0, 0, 0] < 0.3 * change[7]


def test_clock_adds_up():
    assert PHASE_ENDS[-1] == MAX_EPISODE_STEPS
    assert list(PHASE_ENDS) == sorted(set(PHASE_ENDS))


@pytest.mark.parametrize("slug", [t.slug for t in TOPOLOGIES])
def test_posture_space_keeps_the_posture_within_its_name(slug):
    """Fingers that a topology holds still never move, whatever the search tries."""
    topology = resolve_topology(slug)
    space = PostureSpace.of(AR10, topology)
    rng = np.random.default_rng(0)
    numbers = rng.uniform(space.lower, space.upper, (50, 8))
    preshape, closing = space.expand(numbers)
    moving = AR10.postures[slug].moving.reshape(-1, 2).any(1)
    moving[0] = True  # The thumb's preshape is searched even where it does not close.
    still = np.repeat(~moving, 2)
    np.testing.assert_array_equal(preshape[:, still], closing[:, still])
    assert (closing[:, 1] >= preshape[:, 1]).all()
    own_preshape, own_closing = space.expand(space.start()[None])
    assert own_preshape.shape == own_closing.shape == (1, len(AR10.actuators))


def grasp(**changes):
    values = {
        "topology": "power_pad_abd_2",
        "obj": "ball",
        "presentation": "table",
        "extents": (0.05, 0.05, 0.05),
        "height": 0.025,
        "mass": library.load("ball").mass_kg,
        "pregrasp": (0.0,) * 6,
        "preshape": (0.5,) * 10,
        "closing": (1.0,) * 10,
        "lift": 1.0,
        "both": 1.0,
        "trials": 64,
    }
    return Grasp(**{**values, **changes})


def test_mismatch_prefers_like_size_and_good_grasps():
    placement = place(library.load("ball"))
    size = tuple(placement.extents.tolist())
    same = grasp(extents=size, height=float(placement.centre[2]))
    larger = grasp(extents=tuple(1.4 * s for s in size), height=float(placement.centre[2]))
    lighter = grasp(extents=size, height=float(placement.centre[2]), mass=0.001)
    worse = grasp(extents=size, height=float(placement.centre[2]), lift=0.2, both=0.0)
    assert same.mismatch(placement) < larger.mismatch(placement)
    assert same.mismatch(placement) < lighter.mismatch(placement)
    assert same.mismatch(placement) < worse.mismatch(placement)


def test_grasps_of_kin_are_carried_over_and_come_second():
    """A pinch with two fingers serves one with three; a palm grasp never does."""
    placement = place(library.load("ball"))
    size, height = tuple(placement.extents.tolist()), float(placement.centre[2])
    own, kin, other = (
        grasp(topology=slug, extents=size, height=height)
        for slug in ("precision_pad_abd_2_4", "precision_pad_abd_2_3", "power_palm_abd_2_5")
    )
    topology = resolve_topology("precision_pad_abd_2_4")
    ranked = nearest_grasps(AR10, topology, placement, 3, [other, kin, own])
    assert ranked[0] == own
    assert [g.topology for g in ranked] == [topology.slug] * 2
    ring = AR10.actuators.index("ring_mcp")
    assert ranked[1].closing[ring] > ranked[1].preshape[ring]


def test_stored_grasps_come_from_train_objects_only():
    """No test object was ever searched on."""
    test = set(library.names("test"))
    assert not {grasp.obj for grasp in stored_grasps()} & test


def test_dump_grasps_does_not_depend_on_the_order_found():
    a, b = grasp(obj="a"), grasp(obj="b")
    assert dump_grasps([a, b]) == dump_grasps([b, a])
