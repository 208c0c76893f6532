"""Splits the CPU time of a loop into sections, each without the sections inside it."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable
from typing import Any


class Stopwatch:
    """Wraps methods of objects; the innermost wrapped call that runs gets the time."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._running: list[str] = []
        self._since = 0.0

    def wrap(self, owner: Any, method: str, section: str) -> None:
        """Count the time of `owner.method` under a section from now on."""
        original: Callable[..., Any] = getattr(owner, method)

        def timed(*args: Any, **kwargs: Any) -> Any:
            self._turn(section)
            try:
                return original(*args, **kwargs)
            finally:
                self._turn(None)

        setattr(owner, method, timed)

    def _turn(self, section: str | None) -> None:
        """Enter a section, or leave the running one."""
        now = time.process_time()
        if self._running:
            self.seconds[self._running[-1]] += now - self._since
        if section is None:
            self._running.pop()
        else:
            self._running.append(section)
        self._since = now

    def clear(self) -> None:
        """Start again from nothing."""
        self.seconds.clear()
