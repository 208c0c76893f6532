"""Raw typing -> clean sentences, each in the form that the parser reads best.

The small English model takes many a bare imperative for a noun ("Hammer the nail"); after "you
should" it parses nearly all of them, so imperatives get that opener.
"""

from __future__ import annotations

import re
import unicodedata

MAX_CHARACTERS = 400  # Longest instruction that is read; a spoken minute is about 800.
MAX_SEGMENTS = 8  # Later sentences are not read; a note says so.
MAX_WORD = 40  # Longer runs of letters are no word.
OPENER = "you should "

SHORTHAND = {
    "w/": "with",
    "u": "you",
    "ur": "your",
    "pls": "please",
    "plz": "please",
    "plase": "please",
    "thx": "",
    "thanks": "",
    "asap": "",
    "gonna": "going to",
    "wanna": "want to",
    "gotta": "have to",
    "gimme": "give me",
    "lemme": "let me",
    "dont": "don't",
    "cant": "can't",
    "im": "i'm",
    "&": "and",
    "teh": "the",
    "uh": "",
    "um": "",
    "er": "",
    "erm": "",
    "hmm": "",
}
FILLERS = frozenset(
    ["please", "kindly", "hey", "hi", "hello", "ok", "okay", "so", "robot", "now", "then", "well", "just", "first", "firstly", "next", "finally", "afterwards", "lastly", "and", "but", "or", "also", "quickly", "carefully", "slowly", "gently", "simply", "only", "yes", "yeah", "oh", "alright", "secondly", "later", "again", "maybe", "perhaps", "actually", "dear", "sir", "madam", "buddy", "mate", "assistant", "sawyer", "always"]
)
"""Words that may precede an imperative without changing it."""
OPENING_PHRASES = (
    "after that",
    "when you are done",
    "when done",
    "once done",
    "if you have a moment",
    "if you can",
    "if possible",
    "if you don't mind",
    "for me",
    "be a dear and",
    "be so kind as to",
    "be so good as to",
    "go ahead and",
    "go and",
    "come and",
    "try to",
    "be sure to",
    "make sure to",
    "make sure you",
    "do me a favor and",
    "do me a favour and",
    "remember to",
    "don't forget to",
    "do not forget to",
    "you need to",
    "you must",
    "you should",
    "you have to",
    "you can",
    "feel free to",
    "why don't you",
    "why not",
    "how about you",
    "the first step is to",
    "your job is to",
    "your task is to",
    "it's time to",
    "it is time to",
    "time to",
    "help me to",
    "help me",
    "let's",
    "let us",
    "start by",
    "begin by",
    "proceed to",
    "your next task is to",
)


def clean(text: str) -> str:
    """One line of lower-case words and plain punctuation.

    Compatibility forms are unfolded (NFKC), control, format and picture characters dropped.
    """
    text = unicodedata.normalize("NFKC", text[: 2 * MAX_CHARACTERS])
    kept = (c if unicodedata.category(c)[0] not in "CS" or c in "&$+<>=^`|~" else " " for c in text)
    text = "".join(kept).translate(str.maketrans("’‘“”„«»`´…", '\'\'"""""\'\'.'))
    text = re.sub(r"[\"()\[\]{}*_#<>|\\^~=+]", " ", text.lower())
    text = re.sub(r"\s[-–—]+\s|--+|[–—]", " , ", text)
    text = re.sub(r"([.!?,;:])\1+", r"\1", text)
    words = [SHORTHAND.get(w, w) for w in text.split()]
    text = " ".join(w for w in words if w and len(w) <= MAX_WORD)
    return re.sub(r"\s+([.,;:!?])", r"\1", text).strip()


def split_sentences(text: str) -> list[str]:
    """Sentences and parts between semicolons; a decimal point does not split."""
    parts = re.split(r"[.!?;]+(?=\s|$)|:(?=\s)", text)
    return [part.strip(" ,.:-'") for part in parts if re.search(r"\w", part)]


def strip_opener(segment: str) -> str:
    """The segment without greetings and set phrases before its verb."""
    while True:
        before = segment
        segment = segment.lstrip(" ,-")
        for phrase in OPENING_PHRASES:
            if segment.startswith(phrase + " "):
                segment = segment[len(phrase) :].lstrip(" ,")
        first, _, rest = segment.partition(" ")
        if first.strip(",") in FILLERS and rest:
            segment = rest
        if segment == before:
            return segment
