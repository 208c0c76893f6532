"""Contact impulses between chosen bodies, from one pass over the contact lists per step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch


class ImpulseQuery:
    """Rows of the shared impulse table; `cuda_impulses.torch()` is (rows, 3) [Ns]."""

    def __init__(self, rows: Sequence[int], signs: Sequence[int]):
        self.rows = np.array(rows, dtype=int)
        self.signs = np.array(signs, dtype=np.float32)[:, None]
        self._impulses = np.zeros((len(rows), 3), dtype=np.float32)
        self._tensor = torch.from_numpy(self._impulses)

    @property
    def cuda_impulses(self) -> ImpulseQuery:
        """Itself: the name under which ManiSkill looks for the result."""
        return self

    def torch(self) -> torch.Tensor:
        """(rows, 3) [Ns] impulse of the last physics step, as of the last query."""
        return self._tensor

    def fill(self, table: np.ndarray) -> None:
        """Take this query's rows out of the table (all rows, 3)."""
        np.multiply(table[self.rows], self.signs, out=self._impulses)


class ContactTable:
    """Summed contact impulse of every body pair and body that some query asked about.

    An impulse counts as acting on the first body of a pair, as in PhysX: it is positive for the
    first and negative for the second body of a contact.
    """

    def __init__(self, systems: Sequence[Any], env_of: dict[Any, int], num_envs: int):
        self._systems = systems
        self._env_of = env_of
        # Slot 2r counts for row r, slot 2r + 1 against it. Bodies hash by identity.
        self._pair_slots: dict[Any, dict[Any, int]] = {}
        self._body_slots: dict[Any, int] = {}
        self._row_env: list[int] = []
        self._cleared = np.zeros(num_envs, dtype=bool)
        self._table: np.ndarray | None = None

    def pair_query(self, pairs: Sequence[tuple[Any, Any]]) -> ImpulseQuery:
        """Impulse on the first body of each pair by the second."""
        slots = [self._pair_slot(first, second) for first, second in pairs]
        self._table = None
        return ImpulseQuery([slot // 2 for slot in slots], [1 - 2 * (slot % 2) for slot in slots])

    def body_query(self, bodies: Sequence[Any]) -> ImpulseQuery:
        """Net impulse on each body."""
        for body in bodies:
            if body not in self._body_slots:
                self._body_slots[body] = self._new_row(body)
        self._table = None
        return ImpulseQuery([self._body_slots[body] // 2 for body in bodies], [1] * len(bodies))

    def query(self, query: ImpulseQuery) -> None:
        """Bring a query up to date with the last physics step."""
        if self._table is None:
            self._table = self._read()
        query.fill(self._table)

    def stepped(self) -> None:
        """A physics step has passed: everything known is out of date."""
        self._table = None
        self._cleared[:] = False

    def clear(self, envs: np.ndarray | slice) -> None:
        """These environments were put into a new state: their contacts are void until a step."""
        self._cleared[envs] = True
        self._table = None

    def _pair_slot(self, first: Any, second: Any) -> int:
        partners = self._pair_slots.setdefault(first, {})
        if second not in partners:
            slot = self._new_row(first)
            partners[second] = slot
            self._pair_slots.setdefault(second, {})[first] = slot + 1
        return partners[second]

    def _new_row(self, body: Any) -> int:
        self._row_env.append(self._env_of[body])
        return 2 * (len(self._row_env) - 1)

    def _read(self) -> np.ndarray:
        impulses: list[np.ndarray] = []
        starts: list[int] = []  # First point of each contact that matters.
        slots: list[int] = []
        contact_of_slot: list[int] = []
        for system in self._systems:
            for contact in system.get_contacts():
                hit = self._slots_hit(*contact.bodies)
                if not hit:
                    continue
                points = contact.points
                if not points:
                    continue
                slots += hit
                contact_of_slot += [len(starts)] * len(hit)
                starts.append(len(impulses))
                impulses += [point.impulse for point in points]
        num_rows = len(self._row_env)
        if not impulses:
            return np.zeros((num_rows, 3), dtype=np.float32)
        per_contact = np.add.reduceat(np.concatenate(impulses).reshape(-1, 3), starts, axis=0)
        weights = per_contact[contact_of_slot]
        table = np.empty((num_rows, 3), dtype=np.float32)
        for axis in range(3):
            signed = np.bincount(slots, weights[:, axis], minlength=2 * num_rows)
            table[:, axis] = signed[0::2] - signed[1::2]
        table[self._cleared[self._row_env]] = 0.0
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
