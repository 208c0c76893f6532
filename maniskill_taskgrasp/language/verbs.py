"""Inflected English verbs -> the base form under which the lexicon lists them."""

from __future__ import annotations

from functools import cache

from maniskill_taskgrasp.language.lexicon import NOMINALS, load_lexicon
from maniskill_taskgrasp.language.words import word_map

IRREGULAR = word_map("irregular")
DOUBLING = frozenset("bdgklmnprt")  # Final consonants that double: "grip" -> "gripping".


def inflections(verb: str) -> set[str]:
    """Regular and listed irregular forms of a base verb.

    Both readings of a doubtful spelling are given ("sanding" and "sandding" do no harm).
    """
    forms = {verb, verb + "s", verb + "es", verb + "ed", verb + "ing"}
    if verb.endswith("e"):
        forms |= {verb + "d", verb[:-1] + "ing"}
    if verb.endswith("y"):
        forms |= {verb[:-1] + "ies", verb[:-1] + "ied"}
    if len(verb) > 2 and verb[-1] in DOUBLING and verb[-2] in "aeiou":
        forms |= {verb + verb[-1] + "ed", verb + verb[-1] + "ing"}
    return forms | set(IRREGULAR.get(verb, "").split())


@cache
def base_forms() -> dict[str, str]:
    """Inflected form or deverbal noun -> base verb of the lexicon; a base form is its own."""
    verbs = load_lexicon().verbs
    forms: dict[str, str] = {}
    for verb in sorted(verbs):
        for form in inflections(verb):
            forms.setdefault(form, verb)
    forms.update({noun: verb for noun, verb in NOMINALS.items() if verb in verbs})
    forms.update({verb: verb for verb in verbs})
    return forms


def base_of(lower: str) -> str | None:
    """The lexicon's base verb of a word, None where it has none."""
    return base_forms().get(lower)
