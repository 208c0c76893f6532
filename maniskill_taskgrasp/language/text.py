"""Raw typing -> clean sentences, each in the form that the parser reads best.

The small English model takes many a bare imperative for a noun ("Hammer the nail"); after "you
should" it parses nearly all of them, so imperatives get that opener.
"""

from __future__ import annotations

import re
import unicodedata

from maniskill_taskgrasp.language.words import word_list, word_map, word_set

MAX_CHARACTERS = 400  # Longest instruction that is read; a spoken minute is about 800.
MAX_SEGMENTS = 8  # Later sentences are not read; a note says so.
MOST_SENTENCES_OF_A_WORD = 3
MAX_WORD = 40  # Longer runs of letters are no word.
OPENER = "you should "

SHORTHAND = word_map("shorthand")
FILLERS = word_set("fillers")
"""Words that may precede an imperative without changing it."""
OPENING_PHRASES = word_list("opening_phrases")
URGENT = frozenset(["please", "now", "quick", "quickly", "hurry"])
"""Words that make a request of a name alone."""


IDIOMS = word_map("idioms")
"""Set phrases and the plain words that mean the same here."""
QUOTES = str.maketrans("’‘“”„«»`´", '\'\'"""""\'\'')
HESITATION = re.compile(
    r"^(?:look|listen|see),|,\s*you know(?=,)|\b(?:u+h+|u+m+|h+m+|e+r+m*|ah+)\b,?|\blike,\s"
)
SELF_CORRECTION = re.compile(
    r"(?:^[\w-]+,?\s|\b(?:the|a|an|my|your)\s(?:[\w-]+\s){0,3}?[\w-]+,?\s)"
    r"(?:no|i mean|sorry|or rather),?\s(?=(?:the|a|an|my|your)\s)"
)
"""What a speaker takes back: "the stapler, no, the tape"."""


USABLE = re.compile(
    r"\bdo you have(?= (?:\w+ ){2,4}(?:i|we) (?:could|can|may|might) (?:use|have|borrow))"
)
"""Asks for a thing where the rest of "do you have" only asks."""
PAUSE_CORRECTION = re.compile(
    r"\b(?:the|a|an|my|your|that|this)\s(?:[\w-]+\s){0,2}?[\w-]+?(?P<particle>\s(?:off|on|up|down|out|in))?"
    r"\s*(?:\.{2,}|[-–—]{2,}|\s[-–—]\s)\s*"
    r"(?:(?:well|no|wait|er+|u+m+|u+h+|h+m+|sorry|actually|or rather|i mean)[,\s]+)*"
    r"(?=(?:the|a|an|my|your)\s)"
)
"""The same after a pause: "the yarn... the string"."""


NEGATIVE_QUESTION = re.compile(
    r"(?:^|(?<=[.!?;,] ))"
    r"(?:(?P<verb>is|are|was|did|should|would|could|wo|can|ca|has|have)n't (?=you\b)|"
    r"(?P<other>is|are|was|do|does|did|should|would|could|wo|can|ca|has|have)n't "
    r"(?=(?:it|we|i|that|this|the|these|those|my|someone|somebody|he|she|they)\b))"
)
"""Questions that expect a yes: "shouldn't you be oiling that chain?" denies nothing."""
NEGATED_STEMS = {"wo": "will", "ca": "can"}
IF_YOU_WOULD = re.compile(
    r",?\s*if you (?:would|could|can|please|will|may|wouldn't mind)(?: be so kind)?(?=[.!?]*$)"
)
NUMBERED = re.compile(r"(?:^|(?<=\s))\(?\d{1,2}[.)](?=\s)")
"""Numbers of a list: "1) take the sponge 2) scrub the sink"."""


def clean(text: str) -> str:
    """One line of lower-case words and plain punctuation.

    Compatibility forms are unfolded (NFKC), control, format and picture characters and markup
    dropped, hesitation and what the speaker took back left out, set phrases put plainly.
    """
    text = unicodedata.normalize("NFKC", text[: 2 * MAX_CHARACTERS].replace("…", ","))
    kept = (c if unicodedata.category(c)[0] not in "CS" or c in "&$+<>=^`|~" else " " for c in text)
    text = "".join(kept).translate(QUOTES).lower()
    text = re.sub(r"</?\w{1,8}>", " ", text)
    text = re.sub(r"([a-z])\1{2,}", r"\1\1", text)
    text = USABLE.sub("give me", NUMBERED.sub(";", text))
    text = NEGATIVE_QUESTION.sub(
        lambda m: NEGATED_STEMS.get(verb := m["verb"] or m["other"], verb) + " ",
        IF_YOU_WOULD.sub(" please", text),
    )
    text = PAUSE_CORRECTION.sub(
        lambda m: f"{m['particle'].strip()} " if m["particle"] else "", text
    )
    text = re.sub(r"\b(what|who|where|how|when|why)'s\b", r"\1 is", text)
    text = re.sub(r"(?<=[a-z])/(?=[a-z])", " or ", text)
    text = re.sub(r"[\"()\[\]{}*_#<>|\\^~=+]", " ", text)
    text = re.sub(r"\.{2,}|\s[-–—]+\s|--+|[–—]", " , ", text)
    text = re.sub(r"([.!?,;:])\1+", r"\1", text)
    words = [SHORTHAND.get(w, w) for w in HESITATION.sub(" ", text).split()]
    text = " ".join(w for w in words if w and len(w) <= MAX_WORD)
    text = re.sub(r"\s+([.,;:!?])", r"\1", text)
    for phrase, plain in IDIOMS.items():
        if phrase in text:
            text = re.sub(rf"\b{re.escape(phrase)}\b", plain, text)
    text = GOT.sub("give me ", LEAD.sub("please ", SELF_CORRECTION.sub("", text)))
    text = re.sub(r"\s+", " ", text)
    text = re.sub(r"\s+([.,;:!?])", r"\1", text)
    return re.sub(r",[\s,]*,", ",", text).strip(" ,")


def split_sentences(text: str) -> list[str]:
    """Sentences and parts between semicolons; a decimal point does not split."""
    parts = re.split(r"[.!?;]+(?=\s|$)|:(?=\s)", text)
    if len(parts) > MOST_SENTENCES_OF_A_WORD and all(len(part.split()) < 2 for part in parts):
        parts = [" ".join(part.strip() for part in parts)]  # "Open. The. Drawer."
    return [part.strip(" ,.:-'") for part in parts if re.search(r"\w", part)]


LEAD = re.compile(
    r"\b(?:(?:what|all) (?:i|we)(?:'d| would)? (?:really )?(?:like|want|need|ask)(?: (?:of|from))?"
    r"(?: you)?(?: (?:to do|now|first))? is(?: for you)?(?: to)?|the (?:first|next|only|main) "
    r"(?:job|task|thing|step)(?: to do)?(?: now)? is(?: for you)?(?: to)?|"
    r"the (?:plan|idea) is(?: for you)? to|"
    r"(?:what|which)(?: \w+)? (?:would|do|should|can|could) (?:you|we|i) (?:use|take) to|"
    r"(?:(?:can|could|would|will) you )?(?:please )?show (?:me|us) how (?:to|you|you would|i can)|"
    r"(?:and )?who (?:is going|wants|is supposed) to|"
    r"when (?:are you going to|will you)(?: finally)?"
    r") (?!(?:a|an|the|my|your|some|that|this|one|for|be|you)\b)"
)
"""What leads up to the request itself: "what I'd like you to do is put", "who's going to"."""
GOT = re.compile(r"^(?:have you |you |anybody |anyone )?got (?=(?:a|an|any|some)\b)")
"""Asks for a thing: "got any tape?"."""
WALK = re.compile(
    r"(?:go|walk|come|head|run) (?:(?:over|back|up|down|out|in) )?(?:to|into) (?:the|my|your) "
    r"(?:[\w-]+ ){0,2}?[\w-]+(?:,| and| then)+ (?=\w)"
)
"""On the way to the task: "go over to the bench and ..."."""


def strip_opener(segment: str) -> str:
    """The segment without greetings, ways to go and set phrases before its verb."""
    while True:
        before = segment
        segment = segment.lstrip(" ,-")
        walk = WALK.match(segment)
        segment = segment[walk.end() :] if walk else segment
        for phrase in OPENING_PHRASES:
            if segment.startswith(phrase + " "):
                segment = segment[len(phrase) :].lstrip(" ,")
        first, _, rest = segment.partition(" ")
        if first.strip(",") in FILLERS and rest:
            segment = rest
        if segment == before:
            return segment
