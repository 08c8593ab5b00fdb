"""What moving contours of a plan to another place would do, answered at once: what it costs, or what forbids it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.models.plan.explain import Setting, make_setting, try_order
from kerfwise.models.plan.explain.words import difference
from kerfwise.rules.options.suggest import unknown
from kerfwise.rules.statements import About, Statement
from kerfwise.rules.stating.lazy import afterthoughts

from .explaining import Explainer


@dataclass(frozen=True, slots=True)
class Moved:
    """A plan's contours moved to another place, the others in the order that they had.

    Attributes
    ----------
    contours
        What is moved, in the order in which it is cut.
    place
        Where the first of them is cut then, from 1.
    breaks
        What forbids it: none for a lawful move.
    more_mm
        What the plan costs more than now with the best entries along the new order; None where it is forbidden.
    looked
        Whether what only geometry finds in a whole order, such as narrow strips, is in the answer.
    """

    contours: tuple[str, ...]
    place: int
    breaks: tuple[About, ...] = ()
    more_mm: float | None = None
    looked: bool = False

    @property
    def lawful(self) -> bool:
        """Whether nothing forbids it."""
        return not self.breaks

    @property
    def sentence(self) -> str:
        """The same in words.

        Examples
        --------
        >>> Moved(("P2.outer",), 1, (), 12.5).sentence
        'P2.outer can be cut as number 1: 12.5 mm more'
        """
        told = f"{self.contours[0]}{f' and {len(self.contours) - 1} more' if len(self.contours) > 1 else ''}"
        if self.more_mm is not None:
            return f"{told} can be cut as number {self.place}: {difference(round(self.more_mm * UM_PER_MM))}"
        first = self.breaks[0]
        more = f" (and {len(self.breaks) - 1} more)" if len(self.breaks) > 1 else ""
        return f"{told} cannot be cut as number {self.place}: {first.rule}: {first.sentence}{more}"


class Mover:
    """Judges moves of one plan; what the rules state is worked out once, and each move in hundredths of a second."""

    def __init__(self, explainer: Explainer) -> None:
        self._explainer = explainer
        self._without: tuple[frozenset[str], Setting] | None = None

    def move(
        self, contours: Collection[str], place: int, given_up: Iterable[str] = (), look: bool = False
    ) -> tuple[Moved, tuple[int, ...]]:
        """Contours moved together, the first of them to a place (from 1), and the route along the new order.

        Parameters
        ----------
        contours
            Their ids.
        place
            Of the first; the others follow it in the order that they have.
        given_up
            Why locks are there (`Lock.because`) that do not count: the move takes their place.
        look
            Also look for what only geometry finds, which takes longer.

        Raises
        ------
        InputError
            If the plan does not cut a contour of that name, or has no such place.
        """
        setting = self._setting(frozenset(given_up))
        index = setting.facts.nest.index
        for name in contours:
            if name not in index:
                raise InputError(unknown("contour", name, index))
        numbers = {index[name] for name in contours}
        unit = [c for c in setting.order if c in numbers]
        rest = [c for c in setting.order if c not in numbers]
        at = place - 1 - setting.made
        if not 0 <= at <= len(rest):
            raise InputError(f"place {place}: expected one from {setting.made + 1} to {setting.made + len(rest) + 1}")
        order = [*rest[:at], *unit, *rest[at:]]
        names = tuple(setting.name(c) for c in unit)
        tried = try_order(setting, order, look=look)
        if tried.cost is None:
            return Moved(names, place, tried.breaks, None, look), ()
        strips_mm = self._seen_mm(order) - self._seen_now_mm if look else 0.0
        return Moved(names, place, (), (tried.cost - setting.cost) / UM_PER_MM + strips_mm, look), tried.route

    def _setting(self, given_up: frozenset[str]) -> Setting:
        """The setting of the plan; without locks that do not count it is made anew, and kept for the next question."""
        if not given_up:
            return self._explainer.setting
        if self._without is None or self._without[0] != given_up:
            of = self._explainer
            left = tuple(s for s in of.stated.statements if not _says(s.about, given_up))
            self._without = given_up, make_setting(of.facts, of.profile, replace(of.stated, statements=left), of.plan)
        return self._without[1]

    @cached_property
    def _seen_now_mm(self) -> float:
        return self._seen_mm(self._explainer.setting.order)

    def _seen_mm(self, order: Sequence[int]) -> float:
        """What an order costs for what only geometry finds in it."""
        thoughts: Iterable[Statement] = afterthoughts(self._explainer.facts, self._explainer.profile)(order)
        return sum(thought.weight or 0.0 for thought in thoughts)


def _says(about: About, reasons: Iterable[str]) -> bool:
    return any(about.sentence.endswith(reason) for reason in reasons)
