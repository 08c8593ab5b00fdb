"""What the hard order rules put before a contour in every plan, by their own geometry."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from functools import cached_property

from ...encoder.cut import CutSequence
from ...encoder.nest import Nest
from ...rules.profile import Profile
from ...rules.sections import RuleSetting


class Forcing:
    """Called with a contour id: the contours that must be cut before it.

    What is cut in one go with a contour comes with it. Orders that the plan itself does not keep are left out: they
    lie on cycles, where one of them has to give way.
    """

    def __init__(self, nest: Nest, cuts: CutSequence, profile: Profile) -> None:
        self.nest, self.cuts, self.profile = nest, cuts, profile

    def __call__(self, contour: str) -> frozenset[str]:
        own = self._run(contour)
        inside = self._back(self._directly[contour] & own, lambda name: self._directly[name] & own)
        outside = self._back(self._before(own), lambda name: self._before(self._run(name)) | self._run(name))
        return inside | (outside - own)

    def _back(self, start: Iterable[str], onward: Callable[[str], Iterable[str]]) -> frozenset[str]:
        """Everything that can be reached, the start too."""
        waiting = list(start)
        seen = set(waiting)
        while waiting:
            new = set(onward(waiting.pop())) - seen
            seen |= new
            waiting += new
        return frozenset(seen)

    def _before(self, run: frozenset[str]) -> frozenset[str]:
        """What some order puts before a contour of the run, and so before all of it."""
        return frozenset(name for member in run for name in self._directly[member]) - run

    def _run(self, contour: str) -> frozenset[str]:
        return self._runs.get(contour, frozenset({contour}))

    @cached_property
    def _directly(self) -> dict[str, set[str]]:
        """Contour → those that some order puts before it."""
        at, book = self.cuts.positions(), self.profile.rulebook()
        found: dict[str, set[str]] = defaultdict(set)
        for rule, setting in self._hard.items():
            for before, after in book[rule].pairs(self.nest, self.cuts, setting.options):
                if at.get(before, 0) < at.get(after, 0):
                    found[after].add(before)
        return found

    @cached_property
    def _hard(self) -> dict[str, RuleSetting]:
        return {rule: s for rule, s in self.profile.settings().items() if s.strength == "hard"}

    @cached_property
    def _runs(self) -> dict[str, frozenset[str]]:
        """Contour → all that is cut in one go with it."""
        book = self.profile.rulebook()
        return {
            name: frozenset(run)
            for rule, setting in self._hard.items()
            for run in book[rule].together(self.nest, setting.options)
            for name in run
        }
