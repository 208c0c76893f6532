"""Text that is refused before any parsing: empty, too long, another language, no words at all."""

from __future__ import annotations

import unicodedata

from maniskill_taskgrasp.errors import echo
from maniskill_taskgrasp.language.instruction import Rejected
from maniskill_taskgrasp.language.text import MAX_CHARACTERS
from maniskill_taskgrasp.language.verbs import base_of

TRY = "try 'tighten the bolt with the wrench' or 'hand me the mug'"

FOREIGN_WORDS = frozenset(
    # German, Dutch, French, Spanish, Portuguese, Italian, Nordic, Polish, Turkish, Indonesian.
    ["der", "das", "und", "ist", "nicht", "mit", "dem", "den", "ein", "eine", "einen", "bitte", "ich", "du", "mir", "auf", "zu", "gib", "öffne", "nimm", "mach", "wisch", "halt", "het", "een", "mij", "geef", "alsjeblieft", "van", "niet", "op", "doe", "pak", "le", "la", "les", "des", "du", "une", "est", "pas", "avec", "pour", "moi", "toi", "donne", "donnez", "ouvre", "ouvrez", "ferme", "prends", "prenez", "mettez", "s'il", "vous", "plaît", "el", "los", "las", "una", "por", "con", "para", "dame", "abre", "cierra", "toma", "pon", "coge", "favor", "limpia", "y", "del", "al", "il", "lo", "gli", "di", "che", "per", "prendi", "apri", "chiudi", "dammi", "e", "um", "uma", "os", "na", "com", "não", "abra", "feche", "pegue", "og", "er", "av", "til", "med", "det", "kan", "vær", "och", "att", "som", "är", "jag", "ge", "öppna", "stäng", "ta", "mi", "na", "się", "jest", "proszę", "podaj", "otwórz", "weź", "bir", "ve", "bu", "lütfen", "aç", "ver", "kapat", "tolong", "buka", "ambil", "dan", "itu", "saya", "je", "tu", "nous", "votre", "mon", "ma", "sur", "dans", "mein", "dein", "deine", "hole", "bring'", "mich", "sie", "wir", "ihr", "haben", "hast", "sind", "ja", "nein", "oui", "non", "sí", "qué", "como", "esta", "este"]
) - frozenset("e y na ma mi al per la ta os as op bu on halt pack dan ja the van com as")
ENGLISH_WORDS = frozenset(
    ["the", "a", "an", "and", "or", "to", "of", "in", "on", "with", "it", "is", "this", "that", "these", "those", "my", "your", "his", "her", "its", "our", "their", "me", "you", "i", "we", "them", "for", "from", "at", "by", "up", "down", "off", "out", "please", "can", "could", "would", "should", "need", "want", "not", "don't", "do", "then", "so", "but", "be", "has", "have", "are", "was", "as", "into", "over", "some", "any", "use"]
)
FOREIGN_SHARE = 0.2  # Share of words that must be another language's function words.


def letters_are_foreign(text: str) -> bool:
    """Whether most letters belong to another script than the Latin one."""
    letters = [c for c in text if c.isalpha()]
    foreign = sum(not unicodedata.name(c, "").startswith("LATIN") for c in letters)
    return foreign > 0.3 * len(letters)


def is_other_language(words: list[str]) -> bool:
    """Whether the function words of a Latin-script text are not English."""
    pieces = [p for w in words for p in w.replace("-", " ").strip(".,!?;:¿¡").split()]
    foreign = [p for p in pieces if p in FOREIGN_WORDS]
    accents = [p for p in pieces if any(ord(c) > 127 and c.isalpha() for c in p)]
    english = [p for p in pieces if p in ENGLISH_WORDS or base_of(p)]
    strange = len({*foreign, *accents})
    return strange > 0 and strange >= FOREIGN_SHARE * len(pieces) and strange > len(english)


def refuse(text: str, cleaned: str) -> Rejected | None:
    """The rejection of a text that needs no parsing, None where it may be an instruction.

    Args:
        text: as typed.
        cleaned: the same after `text.clean`.
    """
    if not text.strip():
        return Rejected(text, f"the text is empty: {TRY}", "empty")
    if len(text) > MAX_CHARACTERS:
        reason = (
            f"{len(text)} characters came: at most {MAX_CHARACTERS} are read, one task at a time"
        )
        return Rejected(text[:MAX_CHARACTERS], reason, "too_long")
    if letters_are_foreign(cleaned) or is_other_language(cleaned.split()):
        reason = f"{echo(text)} seems to be another language: say it in English, {TRY}"
        return Rejected(text, reason, "other_language")
    if not any(c.isalpha() for c in cleaned):
        return Rejected(text, f"{echo(text)} has no words: {TRY}", "off_topic")
    return None
