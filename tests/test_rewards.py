"""Reward terms and outcomes: known answers, bounds, and the order of failure classes."""

import math

import pytest
import torch

from maniskill_taskgrasp.episode import HELD_STEPS, LIFT_START, MAX_EPISODE_STEPS
from maniskill_taskgrasp.tasks import rewards
from maniskill_taskgrasp.tasks.outcome import FAILURES, LIFT_HEIGHT, Outcome

NAMED = torch.tensor([[False, True, True, False, False, True]])
THUMB = torch.tensor([[False, False, False, False, False, True]])


@pytest.mark.parametrize(
    ("links", "force", "success", "expected"),
    [
        (0, 0.0, False, -1000.0),  # Without contact nothing else counts.
        (0, 9.0, False, -1000.0),
        (3, 20.0, False, 29.0),  # b1 c - b2 f = 30 - 1.
        (3, 20.0, True, 1029.0),
        (0, 0.0, True, 0.0),
    ],
)
def test_paper_reward_known_answers(links, force, success, expected):
    reward = rewards.paper_reward(
        torch.tensor([links]), torch.tensor([force]), torch.tensor([success])
    )
    assert reward.item() == pytest.approx(expected)


def test_reach_averages_the_named_parts():
    distances = torch.tensor([[9.0, 0.0, 0.05, 9.0, 9.0, 0.01]])
    expected = (1 + (1 - math.tanh(0.75)) + (1 - math.tanh(0.15))) / 3
    assert rewards.reach_term(distances, NAMED).item() == pytest.approx(expected, abs=1e-6)


def test_contact_counts_named_parts_that_press():
    forces = torch.tensor([[5.0, 0.05, 0.04, 5.0, 5.0, 1.0]])
    assert rewards.contact_term(forces, NAMED).item() == pytest.approx(2 / 3)


def test_balance_is_that_of_the_weaker_side():
    fingers = NAMED & ~THUMB
    for thumb, index, middle in ((4.0, 9.0, 9.0), (9.0, 2.0, 2.0)):
        forces = torch.tensor([[50.0, index, middle, 50.0, 50.0, thumb]])
        balance = rewards.balance_term(forces, THUMB, fingers).item()
        assert balance == pytest.approx(math.tanh(1.0), abs=1e-6)
    assert rewards.balance_term(torch.zeros(1, 6), THUMB, fingers).item() == 0


def test_lift_is_a_share_of_the_height():
    lift = torch.tensor([-0.1, 0.0, 0.05, 0.2, 0.5])
    expected = torch.tensor([0.0, 0.0, 0.25, 1.0, 1.0])
    torch.testing.assert_close(rewards.lift_term(lift, LIFT_HEIGHT), expected)


def test_centre_is_one_only_where_the_palm_lacks_nothing():
    shifts = torch.tensor([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, -0.01, 0.0], [0, 0, 0.25]])
    term = rewards.centre_term(shifts)
    assert term[0] == 1
    # A centimetre either way, and a turn that moves the fingertips as far, count the same.
    torch.testing.assert_close(term[1:], term[1].expand(3))


def test_terms_stay_in_their_bounds():
    generator = torch.Generator().manual_seed(0)
    forces, distances = 40 * torch.rand(2, 256, 6, generator=generator)
    named = torch.rand(256, 6, generator=generator) > 0.5
    shift = torch.randn(256, 3, generator=generator)
    for term in (
        rewards.reach_term(distances, named),
        rewards.contact_term(forces, named),
        rewards.balance_term(forces, named, ~named),
        rewards.lift_term(shift[:, 0], LIFT_HEIGHT),
        rewards.centre_term(shift),
    ):
        assert term.min() >= 0 and term.max() <= 1


def outcome_after(lifts, force=1.0, speed=0.0):
    """Outcome of one environment whose object rose to these heights [m], pressed throughout."""
    outcome = Outcome(1, 2, torch.device("cpu"))
    forces = torch.zeros(1, 2, 3)
    forces[:, 0, 0] = force
    for lift in lifts:
        touch = forces.norm(dim=-1)
        outcome.record(torch.tensor([lift]), forces, touch, torch.tensor([speed]))
    return outcome


@pytest.mark.parametrize(
    ("lifts", "force", "speed", "step", "expected"),
    [
        ([0.0], 0.0, 0.0, LIFT_START, "none"),  # Nothing is lost before the lift.
        ([0.0], 0.0, 0.0, LIFT_START + 1, "no_contact"),
        ([0.0], 1.0, 0.0, LIFT_START + 1, "none"),
        ([0.0], 1.0, 0.0, MAX_EPISODE_STEPS, "not_lifted"),
        ([0.1, 0.02], 1.0, 0.0, LIFT_START + 9, "slipped"),
        ([0.22, 0.22, 0.02], 1.0, 0.0, LIFT_START + 9, "dropped"),
        ([0.0], 1.0, float("nan"), 3, "unstable"),
        ([0.21] * HELD_STEPS, 1.0, 0.0, MAX_EPISODE_STEPS, "none"),
    ],
)
def test_failure_classes(lifts, force, speed, step, expected):
    outcome = outcome_after(lifts, force, speed)
    failure = outcome.failure(torch.tensor([step]), torch.tensor([lifts[-1]]))
    assert FAILURES[int(failure)] == expected


def test_success_needs_height_touch_and_time():
    up = LIFT_HEIGHT + 0.01
    assert bool(outcome_after([up] * HELD_STEPS).success)
    assert not bool(outcome_after([up] * (HELD_STEPS - 1)).success)
    assert not bool(outcome_after([up] * HELD_STEPS, force=0.0).success)
    assert not bool(outcome_after([up] * 5 + [0.1] + [up] * 5).success)
