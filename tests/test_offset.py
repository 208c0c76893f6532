"""Laws of the offset filter, of fixtures under noise, and of the rules that follow the object."""

from dataclasses import replace

import gymnasium as gym
import pytest
import torch

import maniskill_taskgrasp  # noqa: F401  (Registers the task.)
from maniskill_taskgrasp.agents.hand import PARTS
from maniskill_taskgrasp.agents.rotations import quat_to_matrix
from maniskill_taskgrasp.episode import CLOSE_START, HOVER, PHASE_ENDS
from maniskill_taskgrasp.tasks.closing import (
    ConstantClosing,
    FollowRule,
    GuardedRule,
    HoverRule,
)
from maniskill_taskgrasp.tasks.offset import OffsetFilter, displaced, following
from maniskill_taskgrasp.tasks.probing import ASIDE, ASIDE_STEPS, DOWN, RAISED, ProbingRule
from maniskill_taskgrasp.tasks.rewards import centre_term

PALM = torch.tensor([[0.06, -0.02, 0.10]])


@pytest.mark.parametrize(
    ("offset", "shift"),
    [
        ([0.01, -0.02, 0.0], [0.01, -0.02, 0.0]),  # Without a turn the palm moves as the object.
        ([0.0, 0.0, torch.pi / 2], [-0.04, 0.08, torch.pi / 2]),  # (0.06, -0.02) to (0.02, 0.06).
    ],
)
def test_following_known_shifts(offset, shift):
    seen = following(torch.tensor([offset]), PALM)
    torch.testing.assert_close(seen, torch.tensor([shift]), atol=1e-6, rtol=0)


def test_a_palm_that_follows_sees_the_object_as_planned():
    """Object pose in the frame of the displaced palm is the nominal one."""
    pose = torch.tensor([[0.0, 0.0, 0.05, 1.0, 0.0, 0.0, 0.0]])
    offset = torch.tensor([[0.01, -0.015, 0.3]])
    moved = displaced(pose, torch.zeros(1, 3), offset)
    shift = following(offset, PALM)
    palm = PALM + torch.nn.functional.pad(shift[:, :2], (0, 1))
    turned = displaced(torch.tensor([[0.0, 0, 0, 1, 0, 0, 0]]), torch.zeros(1, 3), shift)
    seen = quat_to_matrix(turned[:, 3:]).transpose(1, 2) @ (moved[:, :3] - palm)[..., None]
    torch.testing.assert_close(seen[..., 0], pose[:, :3] - PALM, atol=1e-6, rtol=0)


def linear(jacobian):
    """Distances that are exactly linear in the offset."""
    return lambda offset: 0.1 + (jacobian @ offset[..., None])[..., 0]


def filtered(error, biases, looks, seed=0):
    """Mean offset error [m, m, rad] after some looks from different sides."""
    generator = torch.Generator().manual_seed(seed)
    offset = torch.tensor([[0.012, -0.007, 0.15]])
    belief = OffsetFilter(1, 6, error, torch.device("cpu"))
    for _ in range(looks):
        scale = torch.tensor([1.0, 1.0, 0.05])
        expected = linear(torch.randn(1, 6, 3, generator=generator) * scale)
        belief.look(torch.tensor([0]), expected(offset) + biases, expected)
    return belief.mean[0, :3] - offset[0]


def test_filter_finds_the_offset_from_exact_distances():
    off = filtered(0.0, torch.zeros(1, 6), looks=1)
    assert off[:2].abs().max() < 1e-3 and off[2].abs() < 0.03


def test_filter_tells_constant_errors_from_the_offset_by_looking_again():
    """One look cannot, several from different sides can."""
    biases = torch.tensor([[0.004, -0.004, 0.004, 0.004, -0.004, -0.004]])
    once, often = (filtered(0.004, biases, looks) for looks in (1, 7))
    assert often[:2].norm() < 0.5 * once[:2].norm()
    assert often[:2].norm() < 1.5e-3


def test_filter_touches_only_the_rows_it_is_given_and_forgets_on_reset():
    belief = OffsetFilter(3, 6, 0.0, torch.device("cpu"))
    expected = linear(torch.ones(1, 6, 3))
    belief.look(torch.tensor([1]), torch.full((1, 6), 0.11), expected)
    assert belief.mean[1].abs().sum() > 0
    assert (belief.mean[[0, 2]] == 0).all()
    belief.reset(torch.tensor([1]))
    assert (belief.mean == 0).all()
    torch.testing.assert_close(belief.covariance[1], belief.covariance[0])


def test_touch_moves_the_belief_towards_the_part_that_is_felt():
    """The thumb should be 2 cm off; it touches: the object is believed nearer to it."""
    jacobian = torch.zeros(1, 6, 3)
    jacobian[0, 5, 0] = -1.0  # The thumb's distance falls as the object moves along x.
    expected = lambda offset: 0.02 + (jacobian @ offset[..., None])[..., 0]  # noqa: E731
    belief = OffsetFilter(1, 6, 0.0, torch.device("cpu"))
    forces = torch.zeros(1, 6)
    belief.feel(torch.tensor([0]), forces, expected)
    assert belief.mean[0, 0].abs() < 1e-4  # Nothing felt, nothing learned.
    forces[0, 5] = 1.0
    belief.feel(torch.tensor([0]), forces, expected)
    assert belief.mean[0, 0] > 0.015


def test_covariance_stays_symmetric_and_shrinks():
    belief = OffsetFilter(1, 6, 0.004, torch.device("cpu"))
    before = belief.covariance[0].clone()
    generator = torch.Generator().manual_seed(0)
    expected = linear(torch.randn(1, 6, 3, generator=generator))
    belief.look(torch.tensor([0]), torch.full((1, 6), 0.1), expected)
    after = belief.covariance[0]
    torch.testing.assert_close(after, after.T, atol=1e-6, rtol=0)
    assert torch.linalg.eigvalsh(before - after).min() > -1e-6


def test_centre_term_is_one_at_the_centre_and_falls_with_distance():
    shift = torch.tensor([[0.0, 0.0, 0.0], [0.005, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.3]])
    term = centre_term(shift)
    assert term[0] == 1
    assert term.diff()[:2].max() < 0
    assert ((term >= 0) & (term <= 1)).all()


@pytest.fixture(scope="module")
def blind_env():
    env = gym.make(
        "TaskGrasp-v0",
        num_envs=8,
        objects=["marker", "salt shaker"],
        topology="precision pad abd 2-3",
        noise="blind",
        control_mode="pd_synergy_wrist",
    ).unwrapped
    yield env
    env.close()


def test_noise_moves_the_fixture_with_the_object(blind_env):
    """A marker on its rail is displaced by up to 2 cm and 15 degrees, and stays on it."""
    blind_env.reset(seed=3)
    rule = ConstantClosing(blind_env)
    before = blind_env.obj.pose.p.clone()
    fixture = blind_env.fixture.pose.p - torch.as_tensor(blind_env._fixture_pose[:, :3])
    assert fixture[::2, :2].norm(dim=1).max() > 0.005
    for _ in range(PHASE_ENDS[HOVER]):
        blind_env.step(rule(None))
    moved = (blind_env.obj.pose.p - before).norm(dim=1)
    assert moved.max() < 0.003


@pytest.mark.parametrize("rule", [HoverRule, FollowRule])
def test_rules_bring_the_palm_nearer(blind_env, rule):
    """By the time of the closing the palm lacks less of the shift than on its own path."""
    blind_env.reset(seed=4)
    policy = rule(blind_env)
    for _ in range(CLOSE_START):
        blind_env.step(policy(None))
    lacking = blind_env.needed_shift() - blind_env._palm_shift()
    # Across the fingers (x); along a long object distances tell little, and it matters little.
    assert lacking[:, 0].abs().mean() < 0.4 * blind_env._memory.true_shift[:, 0].abs().mean()


def test_a_guarded_part_waits_until_the_other_side_touches(blind_env, monkeypatch):
    """Only the thumb feels the object: its motors creep, the fingers close on."""
    blind_env.reset(seed=5)
    guarded, follow = GuardedRule(blind_env), FollowRule(blind_env)
    for _ in range(CLOSE_START + 3):
        blind_env.step(follow(None))
    forces = torch.zeros(blind_env.num_envs, len(PARTS))
    forces[:, PARTS.index("thumb")] = 1.0
    alone = replace(blind_env.reading, forces=forces)
    monkeypatch.setattr(blind_env, "_reading", alone)
    thumb = torch.tensor([part == "thumb" for part in blind_env.agent.hand.actuator_parts])
    palm = guarded._num_palm
    waiting, closing = guarded(None)[:, palm:], follow(None)[:, palm:]
    moving = blind_env.agent.controller.controllers["hand"].activation() < 0.9
    assert (waiting[:, thumb & moving.all(0)] < closing[:, thumb & moving.all(0)]).all()
    assert torch.equal(waiting[:, ~thumb], closing[:, ~thumb])
    both = forces.clone()
    both[:, PARTS.index("index")] = 1.0
    monkeypatch.setattr(blind_env, "_reading", replace(alone, forces=both))
    assert torch.equal(guarded(None)[:, palm:], closing)


def _pushed_up(env, part):
    """What is felt now, but for 1 N straight up on the end of one part."""
    hand = env.agent.hand
    names = [link for own in PARTS for link in hand.part_links[own]]
    reading, link = env.reading, names.index(hand.tip_links[part])
    local = torch.zeros_like(reading.local_forces)
    local[:, link] = reading.link_frames[:, link, 2, :3]  # World z in the link's frame.
    return replace(reading, local_forces=local)


def test_a_probing_palm_comes_down_late_with_the_hand_open(blind_env):
    blind_env.reset(seed=6)
    rule = ProbingRule(blind_env)
    arm = blind_env.agent.controller.controllers["arm"]
    heights, closing = [], []
    for _ in range(CLOSE_START + 10):
        action = rule(None)
        blind_env.step(action)
        heights.append(arm.residual[:, 2].clone())
        closing.append(action[:, rule._num_palm :].amax(1))
    untouched = rule._landed_at > CLOSE_START + 10
    assert untouched.any()
    heights, closing = torch.stack(heights)[:, untouched], torch.stack(closing)[:, untouched]
    assert heights[PHASE_ENDS[HOVER] : CLOSE_START].allclose(torch.tensor(RAISED), atol=1e-4)
    assert (heights[-1] <= DOWN).all()
    assert (closing[:CLOSE_START] == 0).all() and (closing[-1] == 1).all()


@pytest.mark.parametrize(("part", "sign"), [("index", 1.0), ("thumb", -1.0)])
def test_a_digit_that_lands_sends_the_palm_aside_and_up(blind_env, monkeypatch, part, sign):
    """Towards the side of what landed, so that the object comes between thumb and fingers."""
    blind_env.reset(seed=7)
    rule = ProbingRule(blind_env)
    arm = blind_env.agent.controller.controllers["arm"]
    for _ in range(CLOSE_START - 2):
        blind_env.step(rule(None))
    before = arm.residual.clone()
    rule._landed_at[:] = CLOSE_START + 100  # Nothing has landed so far.
    monkeypatch.setattr(blind_env, "_reading", _pushed_up(blind_env, part))
    rule(None)
    tips = blind_env.reading.link_frames[:, rule._tips, :2, 3]
    towards = tips[:, ~rule._thumb].mean(1) - tips[:, rule._thumb].mean(1)
    way = rule._aside - before[:, :2]
    assert (rule._landed_at == CLOSE_START - 2).all()
    assert way.norm(dim=1).allclose(torch.tensor(ASIDE), atol=1e-5)
    assert (sign * (way * towards).sum(1) > 0.9 * ASIDE * towards.norm(dim=1)).all()
    wanted = rule._palm(blind_env.elapsed_steps.long())
    assert wanted[:, 2].allclose(torch.tensor(RAISED), atol=1e-4)
    later = rule._palm(blind_env.elapsed_steps.long() + ASIDE_STEPS)
    assert (later[:, 2] == 0).all() and torch.equal(later[:, :2], rule._aside)
