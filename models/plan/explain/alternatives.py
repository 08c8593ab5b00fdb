"""What holds a contour in its place, and what would change if it were cut or entered elsewhere."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.cut import Direction
from kerfwise.encoder.geometry.segment import Point
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.evaluate import broken, broken_orders, order_cost
from kerfwise.rules.statements import (
    About,
    Statement,
    by_kind,
    contours_named,
    holds,
)
from kerfwise.rules.stating.lazy_statements import forbids_later, lazy_statements

from .context import PlanContext, Stuck, costs_here, lawful_travel, resite

# What a plan costs with one place of its order changed: from the best ways to that place, and on from it.
#
# With F(k, s) the least cost of the first k places, the last of them by site s, and B(k, s) the least of all that
# follows it, the plan costs F(k, s) + B(k, s) with that site. An order that differs between two places only is worked
# out between them. Both are exact where a step's cost depends on nothing but the contours that are out and the two
# sites.


class PositionCosts:
    """The best ways along the order of a plan, from both ends.

    Attributes
    ----------
    setting
        The plan.
    exact
        Whether nothing is stated that ties entries of several contours together, or that seconds decide; where it is,
        no answer is given here.
    asked
        Hard statements that are about more of the order than which of two contours comes first.
    forbidden
        By candidate, what forbids it whatever the order.
    """

    def __init__(self, setting: PlanContext) -> None:
        self.setting = setting
        problem, order = setting.problem, setting.order
        self.exact = not problem.general and not any(lag.seconds for lag in problem.lags)
        kinds = by_kind(setting.stated.statements)
        others = {id(s) for s in (*kinds.precede, *kinds.forbid)}
        self.asked = tuple(s for s in setting.stated.statements if s.weight is None and id(s) not in others)
        self.forbidden: dict[int, list[About]] = defaultdict(list)
        for forbid in kinds.forbid:
            if forbid.weight is None:
                self.forbidden[forbid.candidate].append(forbid.about)
        self._home = problem.n
        contour = np.append(problem.site_contour, problem.n)
        keys = contour[problem.crossings.leave] * (problem.n + 1) + contour[problem.crossings.reach]
        self._sorted = np.argsort(keys, kind="stable")
        self._keys = keys[self._sorted]
        self._order = (*order, self._home)
        self._place = np.append(np.argsort(order), self._home)
        self._extra = order_cost(problem, order)
        if self.exact:
            self._here = self._by_themselves()
            self._first, self._last = self._forward(), self._backward()

    def pinned(self, contour: int, site: int) -> int | None:
        """What the plan costs with this site of a contour, the others' chosen anew, µm; None where there is no way."""
        k = int(self._place[contour])
        s = site - int(self.setting.problem.first[contour])
        cost = self._first[k][s] + self._last[k][s]
        return int(cost) + self._extra if np.isfinite(cost) else None

    def moved(self, order: Sequence[int]) -> int | None:
        """What another order costs by the best entries along it, µm; None where no way along it is lawful."""
        changed = [k for k, (now, then) in enumerate(zip(self._order, order, strict=False)) if now != then]
        if not changed:
            cost = self._first[-1].min()
            return int(cost) + self._extra if np.isfinite(cost) else None
        low, high = changed[0], changed[-1]
        place = np.empty(len(order) + 1, dtype=np.int64)
        place[[*order, self._home]] = np.arange(len(order) + 1)
        before = self._order[low - 1] if low else self._home
        best = self._first[low - 1] if low else np.zeros(1)
        already = set(order[:low])
        problem = self.setting.problem
        for k in range(low, high + 1):
            contour = order[k]
            here = costs_here(self.setting, contour, problem.sites(contour), already)[0]
            best = (best[:, None] + self._step(before, contour, k, place)).min(axis=0) + here
            if not np.isfinite(best).any():
                return None
            already.add(contour)
            before = contour
        after = self._order[high + 1]
        last = best[:, None] + self._step(before, after, high + 1, place) + self._here[high + 1] + self._last[high + 1]
        cost = last.min()
        return int(cost) + order_cost(problem, order) if np.isfinite(cost) else None

    def _by_themselves(self) -> list[Floats]:
        """What the sites of every contour of the order cost by themselves, and home, which costs nothing."""
        found: list[Floats] = []
        already: set[int] = set()
        for contour in self.setting.order:
            found.append(costs_here(self.setting, contour, self._sites(contour), already)[0])
            already.add(contour)
        return [*found, np.zeros(1)]

    def _forward(self) -> list[Floats]:
        best, before, found = np.zeros(1), self._home, []
        for k, contour in enumerate(self._order):
            best = (best[:, None] + self._step(before, contour, k, self._place)).min(axis=0) + self._here[k]
            found.append(best)
            before = contour
        return found

    def _backward(self) -> list[Floats]:
        best, found = np.zeros(1), [np.zeros(1)]
        for k in range(len(self._order) - 1, 0, -1):
            step = self._step(self._order[k - 1], self._order[k], k, self._place)
            best = (step + (self._here[k] + best)[None, :]).min(axis=1)
            found.append(best)
        return found[::-1]

    def _step(self, leave: int, reach: int, k: int, place: Ints) -> Floats:
        """What the moves from the sites of one contour (or home) to those of another cost as step k of an order."""
        problem = self.setting.problem
        table = lawful_travel(problem, self._sites(leave), self._sites(reach))
        key = leave * (problem.n + 1) + reach
        low, high = np.searchsorted(self._keys, [key, key + 1]).tolist()
        if low < high:
            rows = problem.crossings
            mine = self._sorted[low:high]
            mine = mine[place[rows.over[mine]] < k]
            cost = np.where(rows.cost[mine] == FORBIDDEN, np.inf, rows.cost[mine].astype(np.float64))
            at = (rows.leave[mine] - self._sites(leave)[0], rows.reach[mine] - self._sites(reach)[0])
            np.add.at(table, at, cost)
        return table

    def _sites(self, contour: int) -> range:
        problem = self.setting.problem
        return range(problem.m, problem.m + 1) if contour == self._home else problem.sites(contour)


# Which hard statements a changed order breaks, and what it costs where it breaks none.


@dataclass(frozen=True, slots=True)
class TriedOrder:
    """A changed order: what it breaks or, if nothing, what its best route costs, µm."""

    breaks: tuple[About, ...]
    cost: int | None = None
    route: tuple[int, ...] = ()


def try_order(
    setting: PlanContext, order: Sequence[int], look: bool = True, liked: Mapping[int, int] | None = None
) -> TriedOrder:
    """Judge an order by all that is stated, with the best entries along it, or by contour with those `liked` (sites).

    Without a `look`, what only geometry finds in a whole order is left out: where a rule forbids such, that takes most
    of the time.
    """
    breaks = tuple(dict.fromkeys(_broken(setting, order)))
    if breaks:
        return TriedOrder(breaks)
    found = resite(setting, order, liked=liked)
    if isinstance(found, Stuck):
        return TriedOrder(found.abouts)
    breaks = broken(setting.problem, found.route)
    if look and not breaks and forbids_later(setting.facts, setting.profile):
        thoughts = lazy_statements(setting.facts, setting.profile)(order)
        breaks = tuple(s.about for s in thoughts if s.weight is None)
    return TriedOrder(breaks) if breaks else TriedOrder((), found.cost, found.route)


def try_order_fast(along: PositionCosts, order: Sequence[int]) -> TriedOrder:
    """The same without its route, by what is known of the plan's own order, where that tells all."""
    setting = along.setting
    if along.exact and not forbids_later(setting.facts, setting.profile):
        breaks = tuple(dict.fromkeys(_broken(setting, order, along.asked)))
        if breaks:
            return TriedOrder(breaks)
        if not broken_orders(setting.problem, order):
            cost = along.moved(order)
            if cost is not None:
                return TriedOrder((), cost)
    return try_order(setting, order)


def _broken(
    setting: PlanContext, order: Sequence[int], statements: Sequence[Statement] | None = None
) -> Iterator[About]:
    """The hard statements that the order breaks whatever the entries; `statements` are those that may be, if known."""
    place = np.empty(setting.problem.n, dtype=np.int64)
    place[list(order)] = np.arange(len(order))
    if len(setting.pairs):
        for k in np.flatnonzero(place[setting.pairs[:, 0]] > place[setting.pairs[:, 1]]).tolist():
            yield setting.orders[k].about
    known = _OrderAlone(place.tolist())
    for s in setting.stated.statements if statements is None else statements:
        if s.weight is None and holds(s, known) is False:
            yield s.about


@dataclass(frozen=True, slots=True)
class _OrderAlone:
    """What is known of an order whose entries are open."""

    place: Sequence[int]

    def picks(self, c: int) -> bool | None:
        return None

    def cuts_by(self, contour: int, some: frozenset[int]) -> bool | None:
        return None


@dataclass(frozen=True, slots=True)
class Relocation:
    """A contour, or the run of contours that it is cut with, moved to another place (from 1).

    `more_um` is what the plan would cost more, entries chosen anew along the order; None where it `breaks` something.
    """

    label: str
    moved: tuple[str, ...]
    place: int
    breaks: tuple[About, ...] = ()
    more_um: int | None = None


def explain_moves(along: PositionCosts, contour: int) -> tuple[Relocation, ...]:
    """One place earlier and later, and as early and as late as is lawful; what the contour cannot do is left out."""
    swaps = tuple(_swaps(along, contour))
    places = {(move.moved, move.place) for move in swaps}
    return (*swaps, *(move for move in _farthest(along, contour) if (move.moved, move.place) not in places))


def _swaps(along: PositionCosts, contour: int) -> Iterator[Relocation]:
    setting = along.setting
    order = list(setting.order)
    k = order.index(contour)
    for label, other in (("one place earlier", k - 1), ("one place later", k + 1)):
        if 0 <= other < len(order):
            changed = order.copy()
            changed[k], changed[other] = changed[other], changed[k]
            yield _tried(along, label, (contour,), changed, other + 1)


def _farthest(along: PositionCosts, contour: int) -> Iterator[Relocation]:
    """The whole run moves, for a contour that is cut with others."""
    setting = along.setting
    problem = setting.problem
    unit = [c for c in setting.order if problem.block[c] == problem.block[contour]]
    rest = [c for c in setting.order if problem.block[c] != problem.block[contour]]
    now = setting.order.index(unit[0])
    place = np.empty(problem.n, dtype=np.int64)
    place[rest] = np.arange(len(rest))
    before = np.flatnonzero(problem.before[:, unit].any(axis=1) & (problem.block != problem.block[contour]))
    after = np.flatnonzero(problem.before[unit].any(axis=0) & (problem.block != problem.block[contour]))
    low = int(place[before].max()) + 1 if len(before) else 0
    high = int(place[after].min()) if len(after) else len(rest)
    for label, slots in (("as early as can be", range(low, now)), ("as late as can be", range(high, now, -1))):
        for slot in slots:
            if 0 < slot < len(rest) and problem.block[rest[slot - 1]] == problem.block[rest[slot]]:
                continue
            changed = [*rest[:slot], *unit, *rest[slot:]]
            move = _tried(along, label, unit, changed, changed.index(contour) + 1)
            if not move.breaks:
                yield move
                break


def _tried(along: PositionCosts, label: str, moved: Sequence[int], order: Sequence[int], place: int) -> Relocation:
    setting = along.setting
    tried = try_order_fast(along, order)
    more = None if tried.cost is None else tried.cost - setting.cost
    return Relocation(label, tuple(setting.name(c) for c in moved), place + setting.made, tried.breaks, more)


# Why a contour is entered where it is and cut the way round it is: what the other candidates would be.


@dataclass(frozen=True, slots=True)
class OtherEntry:
    """One way to cut the contour; `more_um` is what the plan would cost more with it, entries elsewhere chosen anew.

    An unlawful one has `against` instead: what forbids it. One `from_edge` comes in from the sheet's edge, one
    `in_kerf` begins in a neighbour's, and nothing is pierced.
    """

    entry: Point
    direction: Direction
    pierce: Point
    more_um: int | None
    against: tuple[About, ...] = ()
    from_edge: bool = False
    in_kerf: bool = False


@dataclass(frozen=True, slots=True)
class Entry:
    """How the plan cuts the contour, and the other ways: the lawful ones cheapest first.

    `one_way_by` are the rules that leave one direction only.
    """

    used: OtherEntry
    lawful: tuple[OtherEntry, ...]
    unlawful: tuple[OtherEntry, ...]
    one_way_by: tuple[str, ...]


def explain_entry(along: PositionCosts, contour: int) -> Entry:
    """All candidates of the contour in the plan's order."""
    setting = along.setting
    facts, problem = setting.facts, setting.problem
    place = setting.order.index(contour)
    already = set(setting.order[:place])
    used = setting.candidates[place]
    costs: dict[int, int | tuple[About, ...]] = {}
    lawful, unlawful = [], []
    for c in facts.candidates_of(contour):
        site = int(problem.candidate_site[c])
        if c == used or site == setting.route[place]:
            continue
        if site < 0:
            answer: int | tuple[About, ...] = tuple(along.forbidden.get(c, ()))
        else:
            if site not in costs:
                costs[site] = _pinned(along, contour, site, already)
            answer = costs[site]
        if isinstance(answer, int):
            lawful.append(_way(setting, c, answer - setting.cost))
        else:
            unlawful.append(_way(setting, c, None, answer))
    one_way_by = setting.profile.rules_of_direction(facts.nest.contours[contour].kind)
    lawful.sort(key=lambda way: way.more_um or 0)
    return Entry(_way(setting, used, 0), tuple(lawful), tuple(unlawful), one_way_by)


def _pinned(along: PositionCosts, contour: int, site: int, already: set[int]) -> int | tuple[About, ...]:
    """What the plan costs with this site, µm, or what forbids it in this order."""
    setting = along.setting
    against = [
        condition.about
        for condition in setting.conditions.get(contour, ())
        if condition.cost is None and condition.when in (None, site) and not condition.met(already)
    ]
    if against:
        return tuple(dict.fromkeys(against))
    if along.exact and (cost := along.pinned(contour, site)) is not None:
        return cost
    found = resite(setting, setting.order, {contour: site})
    if isinstance(found, Stuck):
        return found.abouts
    return found.cost


def _way(setting: PlanContext, c: int, more_um: int | None, against: tuple[About, ...] = ()) -> OtherEntry:
    candidate = setting.facts.candidates[c]
    return OtherEntry(
        candidate.entry,
        candidate.direction,
        candidate.pierce,
        more_um,
        against,
        candidate.edge_start,
        candidate.span is not None,
    )


# What holds a contour in its place: the statements that keep it from coming earlier, and later, nearest first.


@dataclass(frozen=True, slots=True)
class Hold:
    """An order that holds: the other contour, its place in the plan (from 1), and the statement."""

    contour: str
    place: int
    about: About


def blocking_orders(setting: PlanContext, contour: int, earlier: bool) -> tuple[Hold, ...]:
    """The orders that keep a contour from coming earlier (else later), the nearest in the plan first."""
    mine, other = (1, 0) if earlier else (0, 1)
    rows, place = np.flatnonzero(setting.pairs[:, mine] == contour), _places(setting)
    away = np.abs(place[setting.pairs[rows, other]] - place[contour])
    return tuple(_hold(setting, row, other, place) for row in rows[np.argsort(away, kind="stable")].tolist())


def nearest_orders(setting: PlanContext, earlier: bool) -> dict[int, Hold]:
    """The first of these of each contour that has one."""
    mine, other = (1, 0) if earlier else (0, 1)
    place = _places(setting)
    away = np.abs(place[setting.pairs[:, other]] - place[setting.pairs[:, mine]])
    rows = np.lexsort((away, setting.pairs[:, mine]))
    contours = setting.pairs[rows, mine]
    first = np.flatnonzero(np.diff(contours, prepend=-1))
    held = zip(contours[first].tolist(), rows[first].tolist(), strict=True)
    return {contour: _hold(setting, row, other, place) for contour, row in held}


def _hold(setting: PlanContext, row: int, other: int, place: Ints) -> Hold:
    rival = int(setting.pairs[row, other])
    return Hold(setting.name(rival), int(place[rival]) + setting.made, setting.orders[row].about)


def _places(setting: PlanContext) -> Ints:
    """The place of each contour in the plan, (n,) from 1."""
    place = np.empty(setting.problem.n, dtype=np.int64)
    place[list(setting.order)] = np.arange(1, setting.problem.n + 1)
    return place


def chain(setting: PlanContext, contour: int, earlier: bool) -> tuple[Hold, ...]:
    """From the contour to an end of the plan: its nearest hold, the nearest hold of that, and so on."""
    found: list[Hold] = []
    mine, other = (1, 0) if earlier else (0, 1)
    place, at = _places(setting), contour
    while len(rows := np.flatnonzero(setting.pairs[:, mine] == at)):
        away = place[at] - place[setting.pairs[rows, other]]
        nearest = int(np.abs(away).argmin())
        if (away[nearest] > 0) != earlier:  # the plan does not keep the order, as an old one need not
            break
        at = int(setting.pairs[rows[nearest], other])
        found.append(_hold(setting, int(rows[nearest]), other, place))
    return tuple(found)


def other_statements(
    setting: PlanContext, contour: int, statements: Sequence[Statement] | None = None
) -> tuple[About, ...]:
    """What else is asked of a contour's place: hard statements that are not the order of two contours.

    `statements` are those that may be such, if known.
    """
    found = [
        s.about
        for s in (setting.stated.statements if statements is None else statements)
        if s.weight is None and contour in contours_named(s) and s.HOLDS_IN_PLACE
    ]
    site = setting.route[setting.order.index(contour)]
    found += [c.about for c in setting.conditions.get(contour, ()) if c.cost is None and c.when in (None, site)]
    return tuple(dict.fromkeys(found))
