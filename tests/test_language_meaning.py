"""Requests that no verb shows: read by the trained head, and what stays refused."""

import numpy as np
import pytest

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language import Instruction, Rejected, parse
from maniskill_taskgrasp.language.actions import HAND_OVER, NO_ACTION, load_head
from maniskill_taskgrasp.language.meaning import features, is_request, meanings
from maniskill_taskgrasp.language.situations import load_situations
from maniskill_taskgrasp.language.text import clean
from maniskill_taskgrasp.language.understand import read_segments


def read(text):
    """Meaning and features of a text of one segment."""
    segments, docs = read_segments(clean(text))
    meaning = meanings([segments[0].text])[0]
    return meaning, features(meaning, segments[0], docs[0], docs[0]._.mentions)


@pytest.mark.parametrize(
    ("text", "action", "name"),
    [
        ("Isn't it time somebody folded the blanket?", "folding", "blanket"),  # Told in the past.
        ("Shouldn't you be folding the blanket?", "folding", "blanket"),  # Expects a yes.
        ("I can not see a thing in this cellar.", "aiming", "flashlight"),  # A situation.
    ],
)
def test_request_without_an_asking_verb_is_read_by_meaning(text, action, name):
    """Where the grammar asks for nothing, the whole request decides."""
    answer = parse(text)
    assert isinstance(answer, Instruction), answer
    assert (answer.action, answer.object) == (action, name)


@pytest.mark.parametrize("text", ["The mug, if you would.", "Mug!"])
def test_name_alone_is_a_transfer_where_it_is_asked_for(text):
    """Politeness or an exclamation mark make a name a request."""
    answer = parse(text)
    assert isinstance(answer, Instruction), answer
    assert (answer.transfer, answer.action, answer.object) == (True, None, "mug")


@pytest.mark.parametrize(
    "text",
    [
        "Whatever you do, don't fold the blanket.",
        "She folded the blanket yesterday.",
        "What's the best way to fold a blanket?",
        "Where is the hammer?",
        "I watched a film about dinosaurs.",
    ],
)
def test_what_asks_for_nothing_stays_refused(text):
    """Bans, tales, questions for an answer in words and small talk."""
    assert isinstance(parse(text), Rejected)


def test_looked_for_tool_is_held():
    """ "Where is the hose?" names what the wish that follows is done with."""
    answer = parse("Where's the hose? I want to rinse the plate.")
    assert (answer.action, answer.object) == ("rinsing", "hose")


def test_decision_weighs_the_features():
    """One weight a feature and a bias; a plain request passes and small talk does not."""
    _, asked = read("fold the blanket")
    _, idle = read("the weather is lovely today")
    assert len(load_head().decision) == len(asked) + 1
    assert is_request(asked)
    assert not is_request(idle)


def test_head_knows_requests_for_objects():
    """A request for an object and small talk have classes of their own."""
    assert set(load_head().classes) == {*load_knowledge().actions, HAND_OVER, NO_ACTION}
    assert read("would you hand me the mug?")[0].hands_over
    assert read("my sister got married in june")[0].probabilities[NO_ACTION] > 0.5


def test_situations_name_actions_and_objects_of_the_data():
    """Every situation is helped by one of the 74 actions with one of the 286 objects."""
    situations = load_situations()
    assert len(load_head().situation_vectors) == len(situations)
    assert {s.action for s in situations} <= set(load_knowledge().actions)
    assert {s.object for s in situations} <= set(load_knowledge().objects)
    np.testing.assert_allclose(np.linalg.norm(load_head().situation_vectors, axis=1), 1, atol=1e-5)
