"""Text that is refused before parsing, and what cleaning may and may not change."""

import pytest

from maniskill_taskgrasp.language import Rejected, parse
from maniskill_taskgrasp.language.text import MAX_CHARACTERS, clean, split_sentences


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("", "empty"),
        (" \t\n", "empty"),
        ("open the door " * 100, "too_long"),
        ("請把毛巾遞給我", "other_language"),  # Another script.
        ("Gib mir bitte den Hammer", "other_language"),  # Latin script, no English.
        ("12345 !!!", "off_topic"),  # No words.
        ("the green bottle", "no_action"),
        ("Pick it up.", "no_object"),
        ("Close the box and do not close the box.", "contradictory"),
    ],
)
def test_refusal_names_its_kind(text, kind):
    """Every kind of unusable text has its own kind of refusal."""
    answer = parse(text)
    assert isinstance(answer, Rejected)
    assert answer.kind == kind


@pytest.mark.parametrize("text", ["", "xyzzy", "Pick it up.", "the green bottle", "é" * 5000])
def test_reason_is_one_line_that_says_what_would_do(text):
    """A refusal's reason fits on one line and helps."""
    reason = parse(text).reason
    assert "\n" not in reason
    assert 20 < len(reason) < 300


def test_long_text_is_not_repeated():
    """A refusal of 100 kB carries at most the length limit of it."""
    assert len(parse("a" * 100_000).text) == MAX_CHARACTERS


def test_clean_removes_what_is_not_language():
    """Control characters, pictures, markup and full-width forms leave plain words."""
    assert clean("<b>Ｏｐｅｎ</b>\x00 the\u202e dra\u200bwer 😀!!!") == "open the dra wer!"


def test_clean_keeps_decimals_and_units():
    """A decimal point ends no sentence."""
    assert split_sentences(clean("Move it 2.5 cm. Then stop.")) == ["move it 2.5 cm", "then stop"]


def test_clean_takes_back_what_the_speaker_took_back():
    """After "no" the second name counts."""
    assert clean("Pass the fork, no, the spoon.") == "pass the spoon."


def test_clean_is_idempotent():
    """What is clean stays as it is."""
    for text in ("Fold the towel, please!", "pick up - the - pen", "A.B.C", "uhh, like, hold it"):
        assert clean(clean(text)) == clean(text)
