"""A group of environments whose physics runs in a forked process."""

from __future__ import annotations

import gc
import os
import signal
import sys
import traceback
import warnings
import weakref
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any

from maniskill_taskgrasp.tasks.cpu_batch.group import EnvGroup

MIN_ENVS = 16  # A process with fewer spends more time on messages than it saves.
PARENT_CHECK = 10.0  # [s] between looks whether the parent is still alive.
_open_ends: weakref.WeakSet[Connection] = weakref.WeakSet()


def default_processes(num_envs: int) -> int:
    """Processes that share the physics: one per core this process may use, if worth it."""
    if not sys.platform.startswith("linux"):
        return 1  # Forking is unsafe on macOS and impossible on Windows.
    return max(1, min(len(os.sched_getaffinity(0)), num_envs // MIN_ENVS))


class RemoteGroup:
    """Runs a group's methods in a process forked from this one, over the same arrays.

    The child starts as an exact copy, so nothing is rebuilt or sent but method names and row
    numbers, and the results are the same bits. SAPIEN objects of these environments that are
    still reachable in this process are dead copies from now on.
    """

    def __init__(self, group: EnvGroup):
        self._end, child_end = Pipe()
        self._outstanding = 0
        self._result: Any = None
        parent = os.getpid()
        gc.collect()
        gc.freeze()  # The child must not copy every page for a collection of the parent's objects.
        with warnings.catch_warnings():
            # Python >= 3.12 warns of other threads; the child calls none of their libraries.
            warnings.simplefilter("ignore", DeprecationWarning)
            self._pid = os.fork()
        if self._pid == 0:
            self._end.close()
            for end in list(_open_ends):
                end.close()  # Else siblings would not see the parent go.
            _serve(group, child_end, parent)
        gc.unfreeze()
        child_end.close()
        _open_ends.add(self._end)
        self.close = weakref.finalize(self, _stop, self._end, self._pid)

    def post(self, name: str, *args: Any) -> None:
        """Start a method of the group; the caller need not wait for it."""
        self._end.send((name, args))
        self._outstanding += 1

    def wait(self) -> Any:
        """Result of the last post, once all are done.

        Raises:
            RuntimeError: one of them failed, with the child's own traceback.
        """
        failure = None
        while self._outstanding:
            try:
                succeeded, self._result = self._end.recv()
            except EOFError:
                raise RuntimeError("the process that runs the physics has died") from None
            self._outstanding -= 1
            failure = failure or (None if succeeded else self._result)
        if failure:
            raise RuntimeError(f"physics failed in its own process:\n{failure}")
        return self._result


def _serve(group: EnvGroup, end: Connection, parent: int) -> None:
    """Carry out messages until the parent closes its end or dies; never returns."""
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle.
        gc.disable()
        while True:
            while not end.poll(PARENT_CHECK):
                if os.getppid() != parent:
                    os._exit(0)
            name, args = end.recv()
            try:
                group.post(name, *args)
                end.send((True, group.wait()))
            except Exception:
                end.send((False, traceback.format_exc()))
    except (EOFError, OSError):
        pass
    finally:
        os._exit(0)  # Not through Python's exit: destructors belong to the parent.


def _stop(end: Connection, pid: int) -> None:
    end.close()
    os.waitpid(pid, 0)
