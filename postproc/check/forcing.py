"""What the hard order rules put before a contour in every plan, by their own geometry."""

from __future__ import annotations

from collections import defaultdict
from functools import cached_property

import numpy as np

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting

from .each_torch import asked_of, torch_of_each


class Forcing:
    """Called with a contour id: the contours that must be cut before it.

    What was cut before a stop is among them. What is cut in one go with a contour comes with it. Orders that the plan
    itself does not keep are left out: they lie on cycles, where one of them has to give way.
    """

    def __init__(self, nest: Nest, cuts: CutSequence, profile: Profile) -> None:
        self.nest, self.cuts, self.profile = nest, cuts, profile

    def __call__(self, contour: str) -> frozenset[str]:
        own = self._runs.get(contour, (contour,))
        inside = self._inside(contour, frozenset(own))
        before = self._before[self._number[contour]] if contour in self._number else 0
        bits = np.unpackbits(
            np.frombuffer(before.to_bytes(len(self._groups) // 8 + 1, "little"), np.uint8), bitorder="little"
        )
        outside = (name for k in np.flatnonzero(bits).tolist() for name in self._groups[k])
        made = frozenset(cut.contour for cut in self.cuts[: self.cuts.made])
        return frozenset(inside) | (frozenset(outside) - frozenset(own)) | made

    def _inside(self, contour: str, own: frozenset[str]) -> list[str]:
        """What the orders put before a contour within the run that it is cut in."""
        reached = [name for name in self._directly[contour] if name in own]
        seen = set(reached)
        for name in reached:
            new = (self._directly[name] & own) - seen
            seen |= new
            reached += new
        return reached

    @cached_property
    def _groups(self) -> list[tuple[str, ...]]:
        """What is cut in one go, and every other contour by itself, in the order of the cuts."""
        at = self.cuts.positions()
        names = {*at, *self._directly, *(name for before in self._directly.values() for name in before)}
        groups = {self._runs.get(name, (name,)) for name in names}
        return sorted(groups, key=lambda group: (min(at.get(name, 0) for name in group), group))

    @cached_property
    def _number(self) -> dict[str, int]:
        """Contour → the number of its group."""
        return {name: k for k, group in enumerate(self._groups) for name in group}

    @cached_property
    def _before(self) -> list[int]:
        """For each group all the groups that must go before it, a bit each.

        Groups are gone through in the order of the cuts, which what is kept of the orders follows: once is enough,
        but where a run is torn apart and so on a cycle.
        """
        straight = [
            {self._number[b] for name in group for b in self._directly[name]} - {k}
            for k, group in enumerate(self._groups)
        ]
        with_itself = [1 << k for k in range(len(self._groups))]
        in_turn = all(other < k for k, others in enumerate(straight) for other in others)
        changed = True
        while changed:
            changed = False
            for k, others in enumerate(straight):
                reached = with_itself[k]
                for other in others:
                    reached |= with_itself[other]
                if reached != with_itself[k]:
                    with_itself[k], changed = reached, not in_turn
        return [reached & ~(1 << k) for k, reached in enumerate(with_itself)]

    @cached_property
    def _directly(self) -> dict[str, set[str]]:
        """Contour → those that some order puts before it."""
        at, book, torches = self.cuts.positions(), self.profile.rulebook(), torch_of_each(self.cuts)
        found: dict[str, set[str]] = defaultdict(set)
        for rule, setting in self._hard.items():
            for before, after in book[rule].pairs(self.nest, self.cuts, setting.options):
                if at.get(before, 0) < at.get(after, 0) and asked_of(book[rule], (before, after), torches):
                    found[after].add(before)
        return found

    @cached_property
    def _hard(self) -> dict[str, RuleSetting]:
        return {rule: s for rule, s in self.profile.settings().items() if s.strength == "hard"}

    @cached_property
    def _runs(self) -> dict[str, tuple[str, ...]]:
        """Contour → all that is cut in one go with it."""
        book = self.profile.rulebook()
        return {
            name: tuple(sorted(run))
            for rule, setting in self._hard.items()
            for run in book[rule].together(self.nest, setting.options)
            for name in run
        }
