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
        self._table = None
        return 2 * (len(self._row_env) - 1)

    def stepped(self) -> None:
        """A physics step has passed: everything known is out of date."""
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
            self._table = self._read()
        return self._table

    def _read(self) -> np.ndarray:
        found = self._find()
        num_rows = len(self._row_env)
        table = np.zeros((num_rows, 3), dtype=np.float32)
        if not found:
            return table
        impulses: list[np.ndarray] = []
        starts: list[int] = []  # First point of each contact.
        for _, points in found:
            starts.append(len(impulses))
            impulses += [point.impulse for point in points]
        sums = np.add.reduceat(np.concatenate(impulses).reshape(-1, 3), starts, axis=0)
        slots = [slot for hit, _ in found for slot in hit]
        weights = np.repeat(sums, [len(hit) for hit, _ in found], axis=0)
        for axis in range(3):
            signed = np.bincount(slots, weights[:, axis], minlength=2 * num_rows)
            table[:, axis] = signed[0::2] - signed[1::2]
        return table

    def _find(self) -> list[tuple[tuple[int, ...], list[Any]]]:
        """Slots and points of every contact that somebody asked about.

        Runs over all contacts every step, most of which nobody asked about: reject those fast.
        """
        found = []
        pair_slots, body_slots = self._pair_slots, self._body_slots
        for env in np.nonzero(self._watched & ~self._void)[0].tolist():
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
                    found.append((hit, points))
        return found
