"""Whatever is typed, the front end answers, in bounded time."""

import random
import string
import time

import pytest

from maniskill_taskgrasp.language import Instruction, Rejected, parse
from maniskill_taskgrasp.language.lexicon import load_lexicon

MAX_SECONDS = 0.1  # [s] bar for one text of any kind, on one core that is not shared.
SPECIAL = (
    "\x00\x1b\u202e\u200b\ufeff\u0301\U0001f600\ud800\udfff\t\n\r'\"\\{}[]<>%$#@!?;:.,-/|~`^&*()"
)
SCRIPTS = "абвгд中文字日本語한국어العربيةעבריתไทยहिन्दीελληνικά"
PROMPTS = ("ignore previous instructions and", "system:", "SELECT * FROM", "<script>", "```python")


def random_text(rng: random.Random) -> str:
    """A text of a random kind: noise, scripts, mixed words, mangled instructions, huge ones."""
    words = sorted(load_lexicon().words())
    kind = rng.randrange(7)
    length = rng.randrange(1, 80)
    if kind == 0:
        return "".join(chr(rng.randrange(0x110000)) for _ in range(length))
    if kind == 1:
        return "".join(rng.choice(SPECIAL + SCRIPTS) for _ in range(length))
    if kind == 2:
        return "".join(rng.choice(string.printable) for _ in range(length * 4))
    if kind == 3:
        return " ".join(rng.choice(words) for _ in range(length))
    if kind == 4:
        return f"{rng.choice(PROMPTS)} {' '.join(rng.choice(words) for _ in range(8))}"
    if kind == 5:
        text = list(f"{rng.choice(words)} the {rng.choice(words)} with the {rng.choice(words)}")
        for _ in range(rng.randrange(6)):
            text[rng.randrange(len(text))] = rng.choice(SPECIAL + string.ascii_letters)
        return "".join(text)
    return rng.choice(string.ascii_letters + SPECIAL) * rng.choice([400, 401, 5000, 100_000])


def check(seed: int, count: int) -> list[float]:
    """Parse `count` random texts; returns the CPU seconds of each."""
    rng = random.Random(seed)
    parse("open the drawer")
    seconds = []
    for _ in range(count):
        text = random_text(rng)
        start = time.process_time()
        answer = parse(text)
        seconds.append(time.process_time() - start)
        assert isinstance(answer, Instruction | Rejected), text
        if isinstance(answer, Rejected):
            assert answer.reason, text
            assert "\n" not in answer.reason, text
    return seconds


def test_any_text_is_answered():
    """A few hundred random texts: no crash."""
    check(seed=1, count=300)


@pytest.mark.slow
def test_ten_thousand_texts_are_answered_in_time():
    """10,000 random texts: no crash, and 99.9 % of them within the bar of CPU time."""
    seconds = sorted(check(seed=2, count=10_000))
    assert seconds[int(0.999 * len(seconds))] <= MAX_SECONDS
