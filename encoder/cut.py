"""A cut: one contour as the torch will make it. Geometry only, so that rules can judge it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, overload

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point

Direction = Literal["cw", "ccw"]
Side = Literal["left", "right", "bottom", "top"]


@dataclass(frozen=True, slots=True)
class Span:
    """The stretch of a contour that a cut follows, where others have cut the rest.

    `begin` and `end` are where the torch's centre joins the compensated contour and leaves it: at a corner, the nearest
    point of the contour would not say which.
    """

    begin: Point
    end: Point


@dataclass(frozen=True, slots=True)
class Stretch:
    """A stretch of a contour that is cut before the rest: where the torch's centre joins and leaves it, which way."""

    contour: str
    span: Span
    direction: Direction

    @property
    def reversed(self) -> Stretch:
        """The same the other way round."""
        way: Direction = "cw" if self.direction == "ccw" else "ccw"
        return Stretch(self.contour, Span(self.span.end, self.span.begin), way)


@dataclass(frozen=True, slots=True)
class Tab:
    """A stretch of a contour that stays uncut, so that the part holds to the sheet: its middle and its width, mm.

    `at` lies on the contour; `width_mm` is the metal that stays between the two ends of the kerf.
    """

    at: Point
    width_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class Cut:
    """One contour, cut (or marked) once.

    `entry` lies on the contour. The torch's centre follows `lead_in` from `pierce` to the point where it joins the
    kerf-compensated contour, once around the compensated contour, then `lead_out` (any overcut included) from the
    joining point to where it is switched off; both are open paths. Either may be None: the torch starts, or stops,
    where it joins. `zone` counts from 1, 0 where none is known; times are seconds from the program's start. `excused`
    are the ids of hard rules that the plan says it could not keep here.

    A `linked` cut is not pierced: the torch stays on after the cut before, `pierce` is where that ends, and `lead_in`
    is the link through the waste. A cut with a `span` follows only that stretch of its contour; earlier ones have cut
    the rest of it.

    `tabs` are left uncut. Where one of them is the last stretch of the round, the torch goes off before it: the
    lead-out is then that place alone. Over all others the torch moves on, unlit.

    Another `torch` than the first makes the cut at the very time of the first torch's cut of the contour `together`, by
    the same motion.

    One with a `way` begins its contour and leaves it unfinished: it cuts a `span` as a stretch of the way of that name,
    and the last cut of the contour comes later.
    """

    contour: str
    entry: Point
    direction: Direction
    pierce: Point
    lead_in: Curve | None = None
    lead_out: Curve | None = None
    zone: int = 0
    start_s: float = 0.0
    end_s: float = 0.0
    excused: tuple[str, ...] = ()
    linked: bool = False
    span: Span | None = None
    tabs: tuple[Tab, ...] = ()
    torch: int = 1
    together: str = ""
    way: str = ""

    @property
    def join(self) -> Point:
        """Where the torch joins the contour's ring: the end of the lead-in, else where it is switched on."""
        return self.pierce if self.lead_in is None else self.lead_in.end

    @property
    def end(self) -> Point:
        """Where the torch is switched off: the end of the lead-out, else the entry."""
        if self.lead_out is None:
            return self.entry
        return self.lead_out.end


@dataclass(frozen=True, slots=True)
class Pierce:
    """A hole that is pierced before the cut that begins there, in a pass of its own.

    `before` is the position of the first cut after it. `contour` is that which is cut from there, "" where nobody says.
    """

    contour: str
    at: Point
    before: int
    start_s: float = 0.0
    end_s: float = 0.0


@dataclass(frozen=True, slots=True)
class HotSpot:
    """Where and when a simulation found metal hottest while one cut had its effect: °C, mm, s from the start.

    `part` is the id of the part that the place lies on, "" between parts.
    """

    peak_c: float
    at: Point
    at_s: float
    part: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class CutSequence(Sequence[Cut]):
    """The cuts in order, with what a rule needs to judge them and cannot see in one cut alone.

    `hot_spots` is what a simulation of these very cuts has measured, in order of time; None if nobody has made one.
    The first `made` cuts are facts: a program that was stopped after them has made them, and the torch is at home when
    the others begin. Times of these count from the start of the old program.

    `begun` are burns that cut a stretch of a contour and finish none, each with the position of the next cut.
    `pierces` are holes that were pierced in a pass before, in order.

    Cuts that several torches make together stand beside each other, and nothing is to be read from their order.
    """

    cuts: tuple[Cut, ...]
    start_side: Side | None = None
    home: Point = (0.0, 0.0)
    hot_spots: tuple[HotSpot, ...] | None = None
    made: int = 0
    begun: tuple[tuple[int, Cut], ...] = ()
    pierces: tuple[Pierce, ...] = ()

    @overload
    def __getitem__(self, key: int) -> Cut: ...
    @overload
    def __getitem__(self, key: slice) -> tuple[Cut, ...]: ...
    def __getitem__(self, key: int | slice) -> Cut | tuple[Cut, ...]:
        return self.cuts[key]

    def __len__(self) -> int:
        return len(self.cuts)

    def __iter__(self) -> Iterator[Cut]:
        return iter(self.cuts)

    @property
    def new(self) -> tuple[Cut, ...]:
        """The cuts that are still to be made."""
        return self.cuts[self.made :]

    @property
    def way(self) -> tuple[Cut, ...]:
        """The new cuts of the first torch, which all others go along with: the way of the machine."""
        return tuple(cut for cut in self.new if cut.torch == 1)

    @property
    def shifts(self) -> dict[int, Point]:
        """How far each further torch that cuts is from the first, mm."""
        first = {cut.contour: cut for cut in self.cuts if cut.torch == 1}
        found: dict[int, Point] = {}
        for cut in self.cuts:
            if cut.torch > 1 and (leader := first.get(cut.together)) is not None:
                shift = cut.pierce[0] - leader.pierce[0], cut.pierce[1] - leader.pierce[1]
                found.setdefault(cut.torch, shift)
        return found

    def spacing_mm(self, axis: Literal["x", "y"]) -> float | None:
        """How far each torch that cuts is from the one before; None where one cuts alone."""
        apart = [shift[axis == "y"] / (torch - 1) for torch, shift in sorted(self.shifts.items())]
        return round(apart[0], 3) if apart else None

    def moments(self) -> dict[str, int]:
        """Contour id → when it is cut, counted from 1: what several torches cut together has one number."""
        of_first: dict[str, int] = {}
        for cut in self.cuts:
            if cut.torch == 1:
                of_first.setdefault(cut.contour, len(of_first) + 1)
        return {c.contour: of_first.get(c.together if c.torch > 1 else c.contour, 0) for c in self.cuts}

    def turned(self, by: int) -> CutSequence:
        """The same, where of what several torches cut together each is named `by` places sooner, the first last."""
        groups: dict[int, list[Cut]] = {}
        at = self.moments()
        for cut in self.cuts:
            groups.setdefault(at[cut.contour], []).append(cut)
        turned = (group[by % len(group) :] + group[: by % len(group)] for group in groups.values())
        return replace(self, cuts=tuple(cut for group in turned for cut in group))

    @property
    def burns(self) -> Iterator[tuple[int, Cut]]:
        """All cuts with their positions, from 1 on, and before each the burns that were begun since the one before."""
        begun = list(self.begun)
        for position, cut in enumerate(self.cuts, 1):
            while begun and begun[0][0] <= position:
                yield begun.pop(0)
            yield position, cut
        yield from begun

    def finishes(self, position: int, cut: Cut) -> bool:
        """Whether one of `burns` is the cut at that position, and does not only come before it."""
        return position <= len(self.cuts) and self.cuts[position - 1] is cut

    def moment(self, position: int, cut: Cut) -> int:
        """When one of `burns` comes: twice its position, or one less where it finishes no contour."""
        return 2 * position - (not self.finishes(position, cut))

    @property
    def new_burns(self) -> tuple[tuple[int, Cut], ...]:
        """Those of `burns` that are still to be made."""
        return tuple((position, cut) for position, cut in self.burns if position > self.made)

    @property
    def pierced(self) -> dict[int, list[Pierce]]:
        """Position of a cut → the holes that are pierced right before it, in order."""
        found: dict[int, list[Pierce]] = {}
        for pierce in self.pierces:
            found.setdefault(pierce.before, []).append(pierce)
        return found

    def positions(self) -> dict[str, int]:
        """Contour id → position, counted from 1."""
        return {c.contour: k for k, c in enumerate(self.cuts, 1)}
