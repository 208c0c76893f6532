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
        self._num_rows = 0
        self._watched = np.zeros(len(systems), dtype=bool)
        self._void = np.zeros(len(systems), dtype=bool)
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
        self._watched[self._env_of[body]] = True
        self._table = None
        self._num_rows += 1
        return 2 * (self._num_rows - 1)

    def stepped(self) -> None:
        """A physics step has passed: everything known is out of date."""
        self._table = None
        self._void[:] = False

    def clear(self, envs: Sequence[int]) -> None:
        """These environments are put into a new state: their contacts are void until a step."""
        self._void[envs] = True
        self._table = None

    def table(self) -> np.ndarray:
        """(rows, 3) [Ns] impulses of the last physics step."""
        if self._table is None:
            self._table = self._read()
        return self._table

    def _read(self) -> np.ndarray:
        impulses: list[np.ndarray] = []
        starts: list[int] = []  # First point of each contact that matters.
        slots: list[int] = []
        contact_of_slot: list[int] = []
        for env in np.nonzero(self._watched & ~self._void)[0].tolist():
            for contact in self._systems[env].get_contacts():
                hit = self._slots_hit(*contact.bodies)
                points = contact.points if hit else None
                if not points:
                    continue
                slots += hit
                contact_of_slot += [len(starts)] * len(hit)
                starts.append(len(impulses))
                impulses += [point.impulse for point in points]
        table = np.zeros((self._num_rows, 3), dtype=np.float32)
        if impulses:
            sums = np.add.reduceat(np.concatenate(impulses).reshape(-1, 3), starts, axis=0)
            weights = sums[contact_of_slot]
            for axis in range(3):
                signed = np.bincount(slots, weights[:, axis], minlength=2 * self._num_rows)
                table[:, axis] = signed[0::2] - signed[1::2]
        return table

    def _slots_hit(self, first: Any, second: Any) -> list[int]:
        hit = []
        partners = self._pair_slots.get(first)
        if partners is not None and (slot := partners.get(second)) is not None:
            hit.append(slot)
        if self._body_slots:
            if (slot := self._body_slots.get(first)) is not None:
                hit.append(slot)
            if (slot := self._body_slots.get(second)) is not None:
                hit.append(slot + 1)
        return hit
