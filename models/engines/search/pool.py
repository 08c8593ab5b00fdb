"""The best routes of several annealings, and what is made of two of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Ints

SIZE = 10  # routes kept


@dataclass(frozen=True, eq=False, slots=True)
class Elite:
    """A lawful route (sites in cutting order) and its cost, µm."""

    cost: int
    route: Ints

    def same(self, other: Elite) -> bool:
        """Whether both are one route."""
        return self.cost == other.cost and bool((self.route == other.route).all())


class Pool:
    """A few different routes; pairs of them are drawn by random numbers of its own."""

    def __init__(self, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self.members: list[Elite] = []

    def add(self, elite: Elite) -> None:
        """Take a route in if it is new, and let the dearest go if there are too many."""
        if not any(elite.same(member) for member in self.members):
            self.members = sorted([*self.members, elite], key=lambda member: member.cost)[:SIZE]

    def keep_best(self) -> None:
        """Let all go but the best: the next generation comes from new annealings."""
        self.members = self.members[:1]

    def pair(self) -> tuple[Elite, Elite]:
        """Two routes, the better first; twice the same if there is one only."""
        count = len(self.members)
        i, j = sorted(self._random.choice(count, 2, replace=False).tolist()) if count > 1 else (0, 0)
        return self.members[i], self.members[j]

    def succeed(self, elder: Elite, child: Elite) -> None:
        """Put a child in the place of the worse of its parents, unless it is worse itself or there already."""
        if child.cost <= elder.cost and not any(child.same(member) for member in self.members):
            rest = [member for member in self.members if member is not elder]
            self.members = sorted([*rest, child], key=lambda member: member.cost)
