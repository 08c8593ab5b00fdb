"""What is already cut of a nest when a program goes on after a stop, and what is left of the nest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from .cut import Cut
from .nest import Contour, Nest, Part


@dataclass(frozen=True, eq=False, slots=True)
class AlreadyCut:
    """The cuts that a stopped program has made, in order; `broken_off` is the one after them, where it is begun anew.

    Nobody knows how far that one has come: all of its path may be void, and all of it may be metal. `begun` are cuts
    that left their contours unfinished, each with the number of the cut that came after it.
    """

    cuts: tuple[Cut, ...] = ()
    broken_off: Cut | None = None
    begun: tuple[tuple[int, Cut], ...] = ()

    def __bool__(self) -> bool:
        return bool(self.cuts) or self.broken_off is not None

    @property
    def contours(self) -> frozenset[str]:
        """Ids of the contours that are cut (or marked)."""
        return frozenset(cut.contour for cut in self.cuts)


NOTHING_CUT = AlreadyCut()


def loose_contours(nest: Nest, parent: Mapping[str, str], out: frozenset[str]) -> dict[str, str]:
    """Contours that can no longer be cut, each with the contour around it that is out: their metal has fallen out.

    `parent` names the contour that immediately contains each contour, where there is one.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(400, 100, part("P", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]))
    >>> loose_contours(plate, {"P.hole1": "P.outer"}, frozenset({"P.outer"}))
    {'P.hole1': 'P.outer'}
    """
    through = {c.id for c in nest.contours if c.kind != "mark"} & out
    found = {}
    for contour in nest.contours:
        around = parent.get(contour.id)
        while around is not None and around not in through:
            around = parent.get(around)
        if around is not None and contour.id not in out:
            found[contour.id] = around
    return found


def rest_of(nest: Nest, gone: frozenset[str]) -> Nest:
    """The nest without contours that are out or loose; a part without its outer contour goes as a whole.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> both = part("A", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]), part("B", rect(110, 10, 80, 80))
    >>> plate = nest(400, 100, *both)
    >>> [contour.id for contour in rest_of(plate, frozenset({"A.hole1", "B.outer"})).contours]
    ['A.outer']
    """

    def left(contours: tuple[Contour, ...]) -> tuple[Contour, ...]:
        return tuple(c for c in contours if c.id not in gone)

    parts: list[Part] = [
        replace(part, holes=left(part.holes), marks=left(part.marks), slits=left(part.slits))
        for part in nest.parts
        if part.outer.id not in gone
    ]
    return replace(nest, parts=tuple(parts), scrap=left(nest.scrap), stretches=left(nest.stretches), drawn=None)
