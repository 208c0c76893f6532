"""Laws of the offset estimate at hover, of fixtures under noise, and of the rule that uses both."""

import gymnasium as gym
import pytest
import torch

import maniskill_taskgrasp  # noqa: F401  (Registers the task.)
from maniskill_taskgrasp.agents.rotations import quat_to_matrix
from maniskill_taskgrasp.episode import HOVER, PHASE_ENDS
from maniskill_taskgrasp.tasks.closing import ConstantClosing, HoverRule
from maniskill_taskgrasp.tasks.offset import (
    PRIOR_STD,
    OffsetModel,
    displaced,
    following,
    posterior_gain,
)
from maniskill_taskgrasp.tasks.rewards import centre_term

PALM = torch.tensor([[0.06, -0.02, 0.10]])


def model(jacobian, error):
    gain = posterior_gain(jacobian, error)
    n, parts = jacobian.shape[:2]
    return OffsetModel(torch.full((n, parts), 0.1), jacobian, gain, PALM, PALM)


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


def test_estimate_finds_the_offset_where_distances_are_exact():
    generator = torch.Generator().manual_seed(0)
    jacobian = torch.randn(1, 6, 3, generator=generator) * torch.tensor([1.0, 1.0, 0.05])
    exact = model(jacobian, 1e-6)
    offset = torch.tensor([[0.01, -0.005, 0.1]])
    distances = exact.nominal + (jacobian @ offset[..., None])[..., 0]
    seen = exact.shift(exact.gaps(distances, torch.zeros(1, 3)))
    torch.testing.assert_close(seen, following(offset, PALM), atol=1e-4, rtol=0)


def test_estimate_does_not_change_when_the_palm_starts_to_follow():
    """What the palm has done already is not asked for twice (to first order in the turn)."""
    generator = torch.Generator().manual_seed(1)
    jacobian = torch.randn(1, 6, 3, generator=generator) * torch.tensor([1.0, 1.0, 0.05])
    exact = model(jacobian, 1e-6)
    residual = torch.tensor([[0.004, 0.002, 0.02]])
    x, y, yaw = residual[0]
    as_object = torch.tensor([[x + yaw * PALM[0, 1], y - yaw * PALM[0, 0], yaw]])
    distances = exact.nominal - (jacobian @ as_object[..., None])[..., 0]
    seen = exact.shift(exact.gaps(distances, residual))  # Nothing was off: the palm should go back.
    torch.testing.assert_close(seen, torch.zeros(1, 3), atol=1e-4, rtol=0)


def test_gain_shrinks_with_error_and_is_bounded_by_the_prior():
    generator = torch.Generator().manual_seed(2)
    jacobian = torch.randn(4, 6, 3, generator=generator) * torch.tensor([1.0, 1.0, 0.05])
    sharp, dull = (posterior_gain(jacobian, error) for error in (1e-3, 1e-1))
    assert (dull.norm(dim=(1, 2)) < sharp.norm(dim=(1, 2))).all()
    # gain @ jacobian is a shrinkage: in units of the prior its eigenvalues lie in [0, 1].
    scale = torch.tensor(PRIOR_STD)
    shrinkage = (sharp @ jacobian) * scale / scale[:, None]
    values = torch.linalg.eigvals(shrinkage).real
    assert (values >= -1e-4).all() and (values <= 1 + 1e-4).all()


def test_blind_models_see_nothing():
    blind = OffsetModel.blind(2, 6, torch.device("cpu"))
    assert (blind.shift(blind.gaps(torch.rand(2, 6), torch.rand(2, 3))) == 0).all()


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


def test_the_hover_rule_brings_the_palm_nearer(blind_env):
    """By the time of the closing the palm lacks less of the shift than on its own path."""
    blind_env.reset(seed=4)
    rule = HoverRule(blind_env)
    for _ in range(PHASE_ENDS[HOVER] + 8):
        blind_env.step(rule(None))
    lacking = blind_env.needed_shift() - blind_env._palm_shift()
    # Across the fingers (x); along a long object distances tell little, and it matters little.
    assert lacking[:, 0].abs().mean() < 0.5 * blind_env._true_shift[:, 0].abs().mean()
