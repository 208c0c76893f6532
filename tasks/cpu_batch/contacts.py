"""Contact impulses between chosen bodies, from one pass over the contact lists per step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


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
        self._pair_slots: dict[Any, dict[Any, int]] = {}
        self._body_slots: dict[Any, int] = {}
        self._row_env: list[int] = []
        self._watched = np.zeros(len(systems), dtype=bool)
        self._void = np.zeros(len(systems), dtype=bool)
        self._found = _Found()
        self._complete = False  # All that is watched was looked at since the last step.
        self._asked = self._eager = False
        self._table: np.ndarray | None = None

    def add_pair(self, first: Any, second: Any) -> tuple[int, int]:
        """Row of the impulse between two bodies, and 1 or -1 to make it act on the first."""
        partners = self._pair_slots.setdefault(first, {})
        if second not in partners:
            slot = self._new_slot(first if first in self._env_of else second)
            partners[second] = slot
            self._pair_slots.setdefault(second, {})[first] = slot + 1
        slot = partners[second]
        return slot // 2, 1 - 2 * (slot % 2)

    def add_body(self, body: Any) -> tuple[int, int]:
        """Row of the net impulse on a body, and 1."""
        if body not in self._body_slots:
            self._body_slots[body] = self._new_slot(body)
        return self._body_slots[body] // 2, 1

    def _new_slot(self, body: Any) -> int:
        self._row_env.append(self._env_of[body])
        self._watched[self._env_of[body]] = True
        self._complete = False
        self._table = None
        return 2 * (len(self._row_env) - 1)

    def stepping(self) -> None:
        """A physics step comes: everything known is out of date."""
        # Who asked after the last step will ask after this one.
        self._eager, self._asked = self._asked, False
        self._complete = self._eager
        self._found = _Found()
        self._table = None
        self._void[:] = False

    def stepped(self, env: int) -> None:
        """An environment has been stepped: look at its contacts, if anybody is going to ask."""
        if self._eager and self._watched[env]:
            self._look(env)

    def clear(self, envs: Sequence[int]) -> None:
        """These environments are put into a new state: their contacts are void until a step."""
        self._void[envs] = True
        if self._table is not None:
            self._table[self._void[self._row_env]] = 0.0

    def table(self) -> np.ndarray:
        """(rows, 3) [Ns] impulses of the last physics step."""
        self._asked = True
        if not self._complete:
            self._found = _Found()
            for env in np.nonzero(self._watched & ~self._void)[0].tolist():
                self._look(env)
            self._complete = True
        if self._table is None:
            self._table = self._found.sums(len(self._row_env))
            self._table[self._void[self._row_env]] = 0.0
        return self._table

    def _look(self, env: int) -> None:
        """Find the contacts of an environment that somebody asked about.

        Runs over all contacts every step, most of which nobody asked about: reject those fast.
        """
        pair_slots, body_slots, found = self._pair_slots, self._body_slots, self._found
        for contact in self._systems[env].get_contacts():
            first, second = contact.bodies
            partners = pair_slots.get(first)
            slot = partners.get(second) if partners else None
            hit: tuple[int, ...] = () if slot is None else (slot,)
            if body_slots:
                if (own := body_slots.get(first)) is not None:
                    hit = (*hit, own)
                if (own := body_slots.get(second)) is not None:
                    hit = (*hit, own + 1)
            if hit and (points := contact.points):
                found.add(hit, points)


class _Found:
    """Contacts that were asked about, after one step."""

    def __init__(self) -> None:
        self._impulses: list[np.ndarray] = []
        self._starts: list[int] = []  # First point of each contact.
        self._hits: list[tuple[int, ...]] = []  # Slots that each contact counts for.

    def add(self, hit: tuple[int, ...], points: list[Any]) -> None:
        """Take in one contact."""
        self._starts.append(len(self._impulses))
        self._impulses += [point.impulse for point in points]
        self._hits.append(hit)

    def sums(self, rows: int) -> np.ndarray:
        """(rows, 3) [Ns] impulses, those against a row with a minus."""
        table = np.zeros((rows, 3), dtype=np.float32)
        if not self._hits:
            return table
        points = np.concatenate(self._impulses).reshape(-1, 3)
        contacts = np.add.reduceat(points, self._starts, axis=0)
        slots = [slot for hit in self._hits for slot in hit]
        weights = np.repeat(contacts, [len(hit) for hit in self._hits], axis=0)
        for axis in range(3):
            signed = np.bincount(slots, weights[:, axis], minlength=2 * rows)
            table[:, axis] = signed[0::2] - signed[1::2]
        return table
