"""Rule locks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from kerfwise.encoder.cut import CutSequence, Tab
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Ids, Nest
from kerfwise.rules.lock import Lock, check_locks
from kerfwise.rules.options.option import setting
from kerfwise.rules.options.quantities import LENGTH, likely
from kerfwise.rules.options.yaml_positions import wrong_at
from kerfwise.rules.rule import Plant, Rule, RuleSetting, Violation
from kerfwise.rules.statements import AtLeast, Before, Forbid, Precede, Statement

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts


@dataclass(frozen=True, slots=True)
class LocksOptions:
    """`locks` come from the profile's own key of that name."""

    entry_tolerance_mm: float = setting(0.5, likely(LENGTH, 0.0, 1000.0), "an entry this near to the locked one is it")
    locks: tuple[Lock, ...] = ()


class Locks(Rule[LocksOptions]):
    """What the operator has locked stays as it is.

    ## What it does

    The `locks` of a job file (of a profile, before) fix single decisions, in words such as `P2.outer first`, or as
    mappings: `{contour: ID, before: ID}`, `{contour: ID, position: first | last | N}` (over all contours, marks
    included; 1 is first, and the number of contours is last), `{contour: ID, entry: [x, y]}`,
    `{contour: ID, direction: cw | ccw}`, `{part: ID, zone: N}`,
    `{contour: ID, tab: [x, y] | off}`, and `{contour: ID, linked: false}`: no link leads to it, it is pierced. Tabs are
    made by hold-small-parts, which must be on for one to be there. Always hard. Orders of level-ahead and hull-before
    that locks leave no room for are dropped, as few as can be, and listed; the zones follow positions that are locked.
    A lock that contradicts any other hard rule is an error that names both.

    ## Links, tabs and other cuts

    - **Links**: `linked: false` rules out each link to a contour. A locked entry or direction holds with a link, too.
    - **Tabs**: `tab: [x, y]` and `tab: off` decide them. A locked entry keeps its place, and tabs give way to it.
    - **Common cuts**: A locked direction, place or order holds for cuts along stretches, too. A locked entry is
      mostly one of the whole round: the part is then cut before its neighbours.
    - **Scrap lines**: They have names, `scrap1` and so on, by which positions and orders of them are locked, among each
      other.

    ## Why

    The operator knows what no rule does: a scratch on the sheet, a part that is waited for, a clamp in the way.

    ## Wrong

    `{contour: P2.outer, position: first}`, and the plan begins with `P1.outer`.

    ## Right

    `{contour: P2.outer, position: first}`, and the plan begins with `P2.outer`.
    """

    id = "locks"
    sentence = "What the operator has locked stays as it is."
    source = "plant practice"
    Options = LocksOptions
    takes_no_file = "zones, and what gives way to a lock, are worked out from the locks themselves"
    strengths = ("hard",)
    relaxed_last = True

    def statements(self, facts: Facts, options: LocksOptions) -> Iterator[Statement]:
        check_locks(options.locks, facts.whole_nest)
        for lock in options.locks:
            if lock.contour is None:
                _check_zone(facts, lock)
            elif lock.contour in facts.nest.index:
                yield from self._of_contour(facts, lock, lock.contour, options.entry_tolerance_mm)

    def _of_contour(self, facts: Facts, lock: Lock, name: str, tolerance_mm: float) -> Iterator[Statement]:
        contours, i = facts.nest.contours, facts.nest.index[name]
        others = [k for k in range(facts.n) if k != i]
        if lock.before is not None and lock.before in facts.nest.index:
            sentence = f"{name} is cut before {lock.before}: {lock.because}"
            yield Precede(i, facts.nest.index[lock.before], self.about((name, lock.before), sentence))
        place = lock.place_among(len(facts.whole_nest.contours))
        if isinstance(place, int):
            about = self.about((name,), f"{name} is cut {place} in order: {lock.because}")
            ahead, behind = tuple(Before(k, i) for k in others), tuple(Before(i, k) for k in others)
            ones = (1,) * len(others)
            left = place - len(facts.already_cut)
            yield AtLeast(ahead, ones, left - 1, about)
            yield AtLeast(behind, ones, facts.n - left, about)
        elif place is not None:
            for k in others:
                first, then = (i, k) if place == "first" else (k, i)
                ids = (contours[first].id, contours[then].id)
                sentence = f"{ids[0]} is cut before {ids[1]}: {name} is {place}, {lock.because}"
                yield Precede(first, then, self.about(ids, sentence))
        yield from self._entries(facts, lock, i, tolerance_mm)

    def excluded(self, facts: Facts, options: LocksOptions) -> Iterator[Forbid]:
        """What the locks say of how contours are entered and which way round they are cut."""
        for lock in options.locks:
            if lock.contour in facts.nest.index:
                yield from self._entries(facts, lock, facts.nest.index[lock.contour], options.entry_tolerance_mm)

    def _entries(self, facts: Facts, lock: Lock, i: int, tolerance_mm: float) -> Iterator[Forbid]:
        name = facts.nest.contours[i].id
        for number in facts.candidates_of(i):
            candidate = facts.candidates[number]
            if lock.entry is not None and not _is_at(candidate.entry, lock.entry, facts.nest.contours[i], tolerance_mm):
                sentence = f"{name} is entered at {_spoken(lock.entry)}: {lock.because}"
                yield Forbid(number, self.about((name,), sentence))
            if lock.tab is not None and not _tabbed(candidate.tabs, lock.tab, tolerance_mm):
                yield Forbid(number, self.about((name,), f"{name} {_asked(lock.tab)}: {lock.because}"))
            if lock.direction is not None and candidate.direction != lock.direction:
                yield Forbid(number, self.about((name,), f"{name} is cut {lock.direction}: {lock.because}"))

    def check_with(
        self, options: LocksOptions, plant: Plant, rules: Mapping[str, RuleSetting]
    ) -> Iterator[tuple[str, str]]:
        tabs = [lock for lock in options.locks if isinstance(lock.tab, tuple)]
        if tabs and rules["hold-small-parts"].strength == "off":
            yield (
                "entry_tolerance",
                f"{tabs[0].contour} is locked to have a tab, and rule hold-small-parts, which makes tabs, is off",
            )

    def pairs(self, nest: Nest, cuts: CutSequence, options: LocksOptions) -> list[Ids]:
        found: list[Ids] = []
        for lock in options.locks:
            others = [c.id for c in nest.contours if c.id != lock.contour]
            if lock.contour is not None and lock.before is not None:
                found.append((lock.contour, lock.before))
            place = lock.place_among(len(nest.contours))
            if lock.contour is not None and place == "first":
                found += [(lock.contour, other) for other in others]
            if lock.contour is not None and place == "last":
                found += [(other, lock.contour) for other in others]
        return found

    def violations(self, nest: Nest, cuts: CutSequence, options: LocksOptions) -> list[Violation]:
        check_locks(options.locks, nest)
        at = cuts.positions()
        found = []
        for lock in options.locks:
            for ids, what, orders in _broken(nest, cuts, lock, options.entry_tolerance_mm):
                positions = tuple(at[name] for name in ids)
                found.append(Violation(self.id, ids, f"{what}: {lock.because}", positions, orders))
        return found


def _broken(
    nest: Nest, cuts: CutSequence, lock: Lock, tolerance_mm: float
) -> Iterator[tuple[tuple[str, ...], str, tuple[Ids, ...]]]:
    """What a lock finds wrong: contour ids that are cut, words, and the orders that are the wrong way round."""
    at = cuts.positions()
    if lock.part is not None:
        for contour in nest.part_of[lock.part]:
            if contour.id in at and (zone := cuts[at[contour.id] - 1].zone) not in (0, lock.zone):
                text = f"{contour.id} (cut {at[contour.id]}) is in zone {zone}, not in zone {lock.zone}"
                yield (contour.id,), text, ()
        return
    name = lock.contour or ""
    if name not in at:
        return
    k = at[name]
    cut = cuts[k - 1]
    if lock.before is not None and at.get(lock.before, k) < k:
        yield (name, lock.before), f"{name} (cut {k}) must be cut before {lock.before} (cut {at[lock.before]})", ()
    place = lock.place_among(len(nest.contours))
    if place is not None and k != _number(place, cuts):
        ahead = tuple((name, other.contour) for other in cuts[cuts.made : k - 1]) if place == "first" else ()
        behind = tuple((other.contour, name) for other in cuts[k:]) if place == "last" else ()
        yield (name,), f"{name} is cut {k} in order, not {place}", ahead + behind
    if lock.entry is not None and not _is_at(cut.entry, lock.entry, nest.contour(name), tolerance_mm):
        yield (name,), f"{name} (cut {k}) is entered at {_spoken(cut.entry)}, not at {_spoken(lock.entry)}", ()
    if lock.tab is not None and not _tabbed(cut.tabs, lock.tab, tolerance_mm):
        has = ", ".join(_spoken(tab.at) for tab in cut.tabs) or "none"
        yield (name,), f"{name} (cut {k}) {_asked(lock.tab)}; those that it has: {has}", ()
    if lock.direction is not None and cut.direction != lock.direction:
        yield (name,), f"{name} (cut {k}) is cut {cut.direction}, not {lock.direction}", ()
    if lock.linked is False and cut.linked:
        yield (name,), f"{name} (cut {k}) is linked with the cut before, not pierced", ()


def _number(place: int | Literal["first", "last"], cuts: CutSequence) -> int:
    """A place as a number; the first is that of the cuts which are still to be made."""
    return cuts.made + 1 if place == "first" else len(cuts) if place == "last" else place


def _is_at(entry: Point, locked: Point, contour: Contour, tolerance_mm: float) -> bool:
    """Whether an entry is the point of the contour nearest to the locked one."""
    along_mm, _ = contour.curve.project(locked)
    return math.dist(entry, contour.curve.point_at(along_mm)) <= tolerance_mm


def _tabbed(tabs: Sequence[Tab], place: Point | Literal["off"], tolerance_mm: float) -> bool:
    """Whether tabs are as a lock wants them."""
    return not tabs if place == "off" else any(math.dist(tab.at, place) <= tolerance_mm for tab in tabs)


def _asked(tab: Point | Literal["off"]) -> str:
    return "has no tab" if tab == "off" else f"has a tab at {_spoken(tab)}"


def _spoken(point: Point) -> str:
    return f"({point[0]:g}, {point[1]:g})"


def _check_zone(facts: Facts, lock: Lock) -> None:
    whole = facts if facts.past is None else facts.past.whole
    part = whole.nest.part_of[lock.part or ""]
    zone = int(whole.zone[whole.nest.index[part.outer.id]])
    if zone != lock.zone and part.id in facts.nest.part_of:
        zones = f"only in zone {zone} of 1…{whole.zone.max()}"
        raise wrong_at(lock.place, f"lock: part {part.id} cannot be in zone {lock.zone}, {zones}")
