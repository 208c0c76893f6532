"""Whole instructions filled by code: a phrase of the lexicon in one of many frames of talking.

Each frame is a way in which people ask for something: orders, favours, needs, passives, tools
handed over for a purpose, sequences, chatter around the request. Slots:

{imp}   "tighten the bolt with the wrench"      {ger}   "tightening the bolt with the wrench"
{np}    "the bolt"                              {done}  "tightened with the wrench"
{doing} "tightening with the wrench"            {held}  "wrench"
{it}    "tighten it with the wrench"            {other} another imperative
{bare}  "tighten the bolt"                      {baring} "tightening the bolt"
"""

from __future__ import annotations

import random
from dataclasses import dataclass

from maniskill_taskgrasp.knowledge import load_knowledge
from maniskill_taskgrasp.language.lexicon import TOOL_ACTIONS, Phrase, load_lexicon
from maniskill_taskgrasp.language.objects import HAND_TOOLS, PHONING, used_for
from maniskill_taskgrasp.language.verbs import DOUBLING, IRREGULAR
from maniskill_taskgrasp.language.words import word_list

PEOPLE = word_list("people")
"""Whom people phone."""
TARGETS = word_list("targets")
"""Things that tools are used on; the table's own objects are what is held."""
USUAL_TOOL = 0.7  # Share of sentences whose object people really used for the action.
SYNONYM = 0.4  # Share of objects that are called by another name.

FRAMES = tuple(
    """{imp}
{imp}
{imp}
{imp} please
please {imp}
can you {imp}?
could you {imp}?
could you please {imp}
would you {imp} for me?
will you {imp}, please?
would you mind {ger}?
do you mind {ger} for me?
i need you to {imp}
i want you to {imp}
i'd like you to {imp}
i would appreciate it if you could {imp}
it would be nice if you {imp}
it would be great if someone could {imp}
do me a favor and {imp}
be a dear and {imp}
would you be so kind as to {imp}
i was wondering if you could {imp}
is there any chance you could {imp}?
can i get you to {imp}?
how about you {imp}?
how about {ger}?
why don't you {imp}?
let's {imp}
let us {imp} now
go ahead and {imp}
go {imp}
try to {imp}
try {ger}
start {ger}
make sure you {imp}
don't forget to {imp}
remember to {imp}
you should {imp}
you have to {imp}
we need to {imp}
we have to {imp} before lunch
i need to {imp}
i want to {imp}
i have to {imp}
i'm going to {imp}
i would like to {imp}
help me {imp}
help me with {ger}
it's time to {imp}
your job is to {imp}
the next step is to {imp}
now {imp}
ok now {imp}
first {imp}
hey, {imp}
hey robot, {imp}
listen, {imp}
quick, {imp}!
carefully {imp}
{imp} carefully
{imp} gently
{imp} right now
{imp}, will you?
{imp}, would you?
{imp} when you have a minute
{imp} if you don't mind
{imp} before it gets dark
{imp} so that we can go home
i'm busy, so {imp}
my hands are full, {imp}
someone should {imp}
somebody has to {imp}
can someone {imp}?
who can {imp}?
are you able to {imp}?
do you think you could {imp}?
could i ask you to {imp}?
sorry to bother you, but could you {imp}
ugh, just {imp}
yo can u {imp}
um, could you, like, {imp}
well, i guess you could {imp}
so basically i want you to {imp}
{np} needs {doing}
{np} needs to be {done}
{np} has to be {done}
{np} must be {done}
{np} should be {done}
{np} ought to be {done}
{np} wants {doing}
{np} is to be {done}
{np} still has to be {done}
{np} hasn't been {done} yet
can {np} be {done}?
could {np} be {done}?
i need {np} {done}
i want {np} {done}
i'd like {np} {done}
have {np} {done}
get {np} {done}
i'd like to have {np} {done}
you see {np}? {it}
look at {np}, {it}
here is {np}, {it}
there's {np}, {it}
{np} is over there. {it}
about {np}: {it}
take {np} and {it}
hand me the {held} so i can {bare}
hand me the {held}, i need to {bare}
pass me the {held} so that i can {bare}
give me the {held}, i have to {bare}
give me the {held} to {bare}
bring me the {held}, i want to {bare}
bring the {held} for {baring}
get the {held} and {bare}
grab the {held} and {bare}
grab a {held} to {bare}
take the {held} and {bare}
take the {held} to {bare}
pick up the {held} and {bare}
use the {held} to {bare}
use the {held} for {baring}
use a {held} and {bare}
i need the {held} to {bare}
i need the {held} for {baring}
i need a {held}, i'm about to {bare}
i need to {bare}, pass me the {held}
i have to {bare}, where is the {held}?
i want to {bare}, can i have the {held}?
i'm {baring}, hand me the {held}
we are going to {bare}, fetch the {held}
with the {held}, {bare}
using the {held}, {bare}
{bare} by means of the {held}
{bare} using a {held}
find me something to {bare} with
i need something to {bare}
pass me something for {baring}
{imp} and then {other}
{imp}, then {other}
first {imp}, then {other}
{imp} and {other}
{imp}. after that, {other}
before you {other}, {imp}
after {ger}, {other}
once you have {doneall}, {other}
don't {other}, {imp}
don't {other}, just {imp}
instead of {otherger}, {imp}
{imp}, but don't {other}
{imp} without {otherger}
no, don't {other}. {imp} instead""".splitlines()
)


IDLE_FRAMES = tuple(
    """i bought a new {name} yesterday
my sister loves her {name}
the {name} was invented long ago
he {past} last week
they {past} yesterday
she {past} all day
my father always {past} when i was young
i {past} this morning, it was fun
we were {ger} when it started to rain
i am {ger} already
i dreamt about {ger}
{ger} is boring
{ger} is bad for your back
what is a {name}?
what does a {name} do?
what is the best {name} for beginners?
how much does a {name} cost?
how many {name}s are there in the world?
where can i buy a {name}?
who invented the {name}?
why do people {imp}?
when did you {imp}?
how often do you {imp}?
do you like my {name}?
do you know how to {imp}?
have you ever seen a {name}?
did you {imp}?
is the {name} expensive?
tell me about the history of the {name}
tell me a story about a {name}
explain how people {imp}
describe the {name}
write a poem about a {name}
translate {name} into french
my favourite thing is the {name}
the {name} is blue
the {name} costs ten dollars
{name}s are made in china
there was a {name} in the movie
the {name} in this picture looks old
a very heavy {name}
nothing beats a good {name}
i think the {name} is ugly
i have three {name}s at home
the {name} broke last year
never {imp}
do not {imp}
don't {imp} please
you must not {imp}
please stop {ger}
i don't want you to {imp}
{verb} {topic}
please {verb} {topic}
can you {verb} {topic}?
what do you think of {topic}?
tell me about {topic}
i love {topic}
{topic} is great
who knows {topic}?
i am worried about {topic}
how do i {verb} {topic}?
what happened to {topic}?
let's talk about {topic}
we should {verb} {topic}
my friend will {verb} {topic}""".splitlines()
)
"""Talk that asks the hand for nothing: tales, questions, opinions, bans, other people's jobs."""
OFF_TOPIC_VERBS = word_list("off_topic_verbs")
OFF_TOPIC_NOUNS = word_list("off_topic_nouns")


@dataclass(frozen=True)
class Words:
    """One request in pieces."""

    verb: str
    rest: str
    """What follows the verb but its object: particle or noun."""
    np: str
    tool: str
    """"with the wrench", empty where none is named."""
    held: str
    split: bool
    """The object stands between verb and particle."""

    def told(self, verb: str, *, np: str | None = None, tool: bool = True) -> str:
        """The request with a form of its verb."""
        np = self.np if np is None else np
        inner = (np, self.rest) if self.split else (self.rest, np)
        return " ".join(filter(None, (verb, *inner, self.tool if tool else "")))


def gerund(verb: str) -> str:
    """The -ing form."""
    if verb.endswith("ie"):
        return verb[:-2] + "ying"
    if verb.endswith("e") and not verb.endswith(("ee", "oe", "ye")):
        return verb[:-1] + "ing"
    return (verb + verb[-1] if _doubles(verb) else verb) + "ing"


def participle(verb: str) -> str:
    """The past participle."""
    if verb in IRREGULAR:
        return IRREGULAR[verb].split()[-1]
    if verb.endswith("e"):
        return verb + "d"
    if verb.endswith("y") and verb[-2:-1] not in "aeiou":
        return verb[:-1] + "ied"
    return (verb + verb[-1] if _doubles(verb) else verb) + "ed"


def past(verb: str) -> str:
    """The past tense."""
    return IRREGULAR[verb].split()[0] if verb in IRREGULAR else participle(verb)


def _doubles(verb: str) -> bool:
    vowels = sum(c in "aeiou" for c in verb)
    short = len(verb) > 2 and vowels == 1 and verb[-2] in "aeiou"
    return short and verb[-1] in DOUBLING


def _call(name: str, rng: random.Random) -> str:
    """An object by its name or by one of its synonyms."""
    others = [n for n, found in load_lexicon().names.items() if found[0][0] == name and n != name]
    return rng.choice(others) if others and rng.random() < SYNONYM else name


def choose_words(phrase: Phrase, rng: random.Random) -> Words:
    """Fill a phrase of the lexicon with things."""
    used = [name for name, _ in used_for(phrase.action)] or [*HAND_TOOLS]
    usual = rng.random() < USUAL_TOOL
    held = _call(rng.choice(used if usual else sorted(load_knowledge().objects)), rng)
    target = rng.choice(PEOPLE if phrase.action in PHONING else TARGETS)
    article = rng.choice(["the", "the", "the", "this", "that", "my", "a", "those", "your"])
    noun = rng.choice(sorted(phrase.nouns)) if phrase.nouns else ""
    rest = " ".join(phrase.words)
    split = bool(rest) and rng.random() < 0.5
    if phrase.action in TOOL_ACTIONS:
        tool = f"with {rng.choice(['the', 'a', 'this', 'my'])} {held}" if rng.random() < 0.4 else ""
        np = f"{article} {noun or (target if rng.random() < 0.8 else held)}"
        return Words(phrase.verb, rest, np, tool, held, split)
    np = f"{article} {noun or held}"
    where = f"{rng.choice(['on', 'from', 'near', 'in'])} the {target}"
    return Words(phrase.verb, rest, np, where if rng.random() < 0.2 else "", held, split)


def fill_frame(phrase: Phrase, other: Phrase, rng: random.Random, frame: str | None = None) -> str:
    """One whole instruction that asks for a phrase's action.

    Args:
        phrase: what is asked for.
        other: what a sequence asks for afterwards, or what is forbidden.
        rng: source of the choices.
        frame: one of `FRAMES`; drawn where None.
    """
    words, more = choose_words(phrase, rng), choose_words(other, rng)
    frame = rng.choice(FRAMES) if frame is None else frame
    doing, done = gerund(words.verb), participle(words.verb)
    return frame.format(
        imp=words.told(words.verb),
        ger=words.told(doing),
        bare=words.told(words.verb, tool=False),
        baring=words.told(doing, tool=False),
        it=words.told(words.verb, np="it"),
        doing=words.told(doing, np=""),
        done=words.told(done, np=""),
        doneall=words.told(done),
        np=words.np,
        held=words.held,
        other=more.told(more.verb, tool=False),
        otherger=more.told(gerund(more.verb), tool=False),
    )


def fill_idle_frame(phrase: Phrase, rng: random.Random) -> str:
    """One text that asks for nothing, with the words of a phrase that would.

    Args:
        phrase: what it speaks of.
        rng: source of the choices.
    """
    words = choose_words(phrase, rng)
    return rng.choice(IDLE_FRAMES).format(
        name=_call(words.held, rng),
        imp=words.told(words.verb),
        ger=words.told(gerund(words.verb)),
        past=words.told(past(words.verb)),
        verb=rng.choice(OFF_TOPIC_VERBS),
        topic=rng.choice(OFF_TOPIC_NOUNS),
    )
