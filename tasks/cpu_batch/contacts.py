"""Contact impulses between chosen bodies, from one pass over the contact lists per step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from sapien import physx

IMPULSE = physx.PhysxContactPoint.impulse.fget  # Faster than looking the attribute up.


class ContactTable:
    """Summed contact impulse of every pair of bodies and every body that was asked about.

    As in PhysX, an impulse acts on the first body of a contact and its opposite on the second.
    """

    def __init__(self, systems: Sequence[Any], env_of: dict[Any, int]):
        """
        Args:
            systems: one for each environment.
            env_of: environment of every body that can be first in a pair.
        """
        self._systems = systems
        self._env_of = env_of
        # Slot 2r counts for row r, slot 2r + 1 against it. Bodies hash by identity.
        self._pair_slots: dict[tuple[Any, Any], int] = {}
        self._body_slots: dict[Any, int] = {}
        self._row_env: list[int] = []
        self._watched = np.zeros(len(systems), dtype=bool)
        self._void = np.zeros(len(systems), dtype=bool)
        # Slots that a contact of two bodies counts for, as they come to touch.
        self._hits: dict[tuple[Any, Any], tuple[int, ...]] = {}
        self._table: np.ndarray | None = None

    def add_pair(self, first: Any, second: Any) -> tuple[int, int]:
        """Row of the impulse between two bodies, and 1 or -1 to make it act on the first."""
        if (first, second) not in self._pair_slots:
            slot = self._new_slot(first if first in self._env_of else second)
            self._pair_slots[first, second] = slot
            self._pair_slots[second, first] = slot + 1
        slot = self._pair_slots[first, second]
        return slot // 2, 1 - 2 * (slot % 2)

    def add_body(self, body: Any) -> tuple[int, int]:
        """Row of the net impulse on a body, and 1."""
        if body not in self._body_slots:
            self._body_slots[body] = self._new_slot(body)
        return self._body_slots[body] // 2, 1

    def _new_slot(self, body: Any) -> int:
        self._row_env.append(self._env_of[body])
        self._watched[self._env_of[body]] = True
        self._hits.clear()
        self._table = None
        return 2 * (len(self._row_env) - 1)

    def stepped(self) -> None:
        """The environments have been stepped: everything known is out of date."""
        self._table = None
        self._void[:] = False

    def clear(self, envs: Sequence[int]) -> None:
        """These environments are put into a new state: their contacts are void until a step."""
        self._void[envs] = True
        if self._table is not None:
            self._table[self._void[self._row_env]] = 0.0

    def table(self) -> np.ndarray:
        """(rows, 3) [Ns] impulses of the last physics step."""
        if self._table is None:
            self._table = self._look()
        return self._table

    def _look(self) -> np.ndarray:
        """Sum the contacts that somebody asked about.

        Runs over all contacts every step, many of which nobody asked about: reject those fast.
        """
        known, hits = self._hits, []
        impulses: list[np.ndarray] = []
        starts: list[int] = []  # First point of each contact.
        for env in np.flatnonzero(self._watched & ~self._void).tolist():
            for contact in self._systems[env].get_contacts():
                bodies = tuple(contact.bodies)
                hit = known.get(bodies)
                if hit is None:
                    hit = known[bodies] = self._slots_of(*bodies)
                if hit and (points := contact.points):
                    starts.append(len(impulses))
                    impulses.extend(map(IMPULSE, points))
                    hits.append(hit)
        return _sums(impulses, starts, hits, len(self._row_env))

    def _slots_of(self, first: Any, second: Any) -> tuple[int, ...]:
        """Slots that a contact of these bodies counts for."""
        pair, own = self._pair_slots.get((first, second)), self._body_slots.get(first)
        other = self._body_slots.get(second)
        slots = (pair, own, None if other is None else other + 1)
        return tuple(slot for slot in slots if slot is not None)


def _sums(
    impulses: list[np.ndarray], starts: list[int], hits: list[tuple[int, ...]], rows: int
) -> np.ndarray:
    """(rows, 3) [Ns] impulses of contacts, those against a row with a minus.

    Args:
        impulses: (3,) [Ns] of every point.
        starts: first point of each contact.
        hits: slots that each contact counts for.
        rows: of the table.
    """
    table = np.zeros((rows, 3), dtype=np.float32)
    if not hits:
        return table
    points = np.concatenate(impulses).reshape(-1, 3)
    contacts = np.add.reduceat(points, starts, axis=0)
    slots = [slot for hit in hits for slot in hit]
    weights = np.repeat(contacts, [len(hit) for hit in hits], axis=0)
    for axis in range(3):
        signed = np.bincount(slots, weights[:, axis], minlength=2 * rows)
        table[:, axis] = signed[0::2] - signed[1::2]
    return table
