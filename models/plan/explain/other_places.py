"""What a plan would cost with a contour in another place, and which statements that would break: every place, exactly.

The others keep their order, or a stretch of it is turned round, and all keep their entries. As a contour slides along
the order, one other is passed at a time, so that only what names the two is looked at again. Most places are told by
travel alone to be none that a reason could name: only what the plan pays today can be saved elsewhere, and that is
summed up beforehand.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, chain, groupby, pairwise

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.tolerances import cost_um
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.evaluate import general_holds, missing_ms, times_ms
from kerfwise.models.problem.moves import statements_by_leave
from kerfwise.rules.statements import About, Contiguous, Lag, by_kind

from .context import PlanContext
from .crossed_moves import CrossedMoves

MOST_CONTOURS, MOST_STEPS = 2000, 40_000
"""Contours beyond which no other places are tried; and how many contours are passed in all, at the most."""
MOST_WHOLE = 60
"""Contours up to which statements that look at whole orders are judged anew for every place."""
MOST_TURNED = 120
"""Contours up to which stretches are turned round."""
MATTERS_UM = 50
"""What is saved by less is no reason: moves are rounded, and many places are as good."""


@dataclass(frozen=True, slots=True)
class OtherPlace:
    """A plan with some contours moved: its order, and what it costs more, µm, soft statements included.

    `hard` are the hard statements that it breaks; `soft` those that it breaks and the plan does not, or not as much,
    each with what that costs more, µm.
    """

    order: tuple[int, ...]
    place: int
    more_um: int
    hard: tuple[About, ...] = ()
    soft: tuple[tuple[About, int], ...] = ()


class OtherPlaces:
    """All other places of each contour of a plan.

    Attributes
    ----------
    complete
        Whether everything that is stated can be judged here; where it cannot, no place is tried.
    reach
        How many contours away places are tried.
    """

    def __init__(self, setting: PlanContext) -> None:
        self.setting, problem = setting, setting.problem
        self.order, n = list(setting.order), problem.n
        whole = bool(problem.general) or any(lag.seconds for lag in problem.lags)
        self.complete = n <= (MOST_WHOLE if whole else MOST_CONTOURS) and not problem.left_out
        self.reach = max(20, MOST_STEPS // max(n, 1))
        if not self.complete:
            return
        self.home = n
        self.site = np.empty(n + 1, dtype=np.int64)
        self.site[self.order], self.site[n] = setting.route, problem.m
        self.leg = problem.travel(self.site, self.site) - problem.moves.price.between(self.site, self.site)
        self._line = np.array([n, *self.order, n])
        self.at = np.empty(n + 1, dtype=np.int64)
        self.at[self.order], self.at[n] = np.arange(n), n
        self._orders()
        self._conditions()
        self._neighbours()
        self._far = problem.lags
        self.whole_now = self._whole(self.order) if self._far or problem.general else {}
        self.crossed = CrossedMoves(problem, by_kind(setting.stated.statements).crossing, self.site, self.order)
        self._paid = _Paid(self)

    def of(self, contour: int, every: bool = False) -> Iterator[OtherPlace]:
        """The contour alone in other places within reach, and what it is cut in one run with as a whole.

        In those that would make the plan cheaper if what they break did not count, or in `every` one.
        """
        yield from self.slid((contour,), every)
        block = self.setting.problem.block
        unit = tuple(np.array(self.order)[block[self.order] == block[contour]].tolist())
        if 1 < len(unit) < len(self.order) and max(self.at[list(unit)]) - min(self.at[list(unit)]) == len(unit) - 1:
            yield from self.slid(unit, every)

    def slid(self, moved: tuple[int, ...], every: bool) -> Iterator[OtherPlace]:
        """Contours that follow each other, moved as one to other places within reach."""
        start, slots = int(self.at[moved[0]]), len(self.order) - len(moved) + 1
        slots_near = range(max(0, start - self.reach), min(slots, start + self.reach + 1))
        more = self._travel(moved, slots_near)
        saved = more - self._paid.by_slot(moved, slots_near) < -MATTERS_UM
        saved[start - slots_near.start] = False
        if not every and not saved.any():
            return
        first, rest = slots_near.start, [*self.order[:start], *self.order[start + len(moved) :]]
        for there in (range(start - 1, first - 1, -1), range(start + 1, slots_near.stop)):
            state, passed = _Slide(self), start
            for slot in there:
                if not every and not saved[slot - first]:
                    continue
                for k in range(passed, slot, there.step):
                    state.passes(moved, rest[k - 1 if there.step < 0 else k], earlier=there.step < 0)
                passed = slot
                order = (*rest[:slot], *moved, *rest[slot:])
                changes = [*self._near_changes(moved, rest, slot, start), *self._whole_changes(order)]
                split = self._runs_split(moved, rest, slot)
                yield self._judged(order, slot, int(more[slot - first]), state, split, changes)

    def turned(self) -> Iterator[tuple[frozenset[int], OtherPlace]]:
        """Stretches of the order turned round: what is in them, and the new order.

        Runs within them stay as they are, or are turned round, too. Only those that would make the plan cheaper if
        what they break did not count.
        """
        if len(self.order) > MOST_TURNED:
            return
        block = self.setting.problem.block
        units = [tuple(unit) for _, unit in groupby(self.order, key=lambda c: int(block[c]))]
        yield from self._turned_of(units)
        if len(units) < len(self.order):
            yield from self._turned_of([(contour,) for contour in self.order])

    def _turned_of(self, units: Sequence[tuple[int, ...]]) -> Iterator[tuple[frozenset[int], OtherPlace]]:
        leg: list[list[int]] = self.leg.tolist()
        ends = [(self.home, self.home), *((unit[0], unit[-1]) for unit in units), (self.home, self.home)]
        starts = [0, *accumulate(map(len, units))]
        for first in range(len(units) - 1):
            state, passed = _Slide(self), first
            back = 0  # what travel within the stretch costs more, turned round
            saved = self._paid.by_turned(units, first)
            for last in range(first + 1, len(units)):
                (a, b), (c, d) = ends[last], ends[last + 1]  # the two units that meet at its end
                back += leg[d][a] - leg[b][c]
                (_, before), (after, _) = ends[first], ends[last + 2]
                (f0, f1), (l0, l1) = ends[first + 1], ends[last + 1]
                more = back + leg[before][l0] + leg[f1][after] - leg[before][f0] - leg[l1][after]
                if more >= saved[last]:
                    continue
                for unit in range(passed + 1, last + 1):
                    for other in self.order[starts[first] : starts[unit]]:
                        state.passes(units[unit], other, earlier=True)
                passed = last
                turned = [c for unit in reversed(units[first : last + 1]) for c in unit]
                start = starts[first]
                order = (*self.order[:start], *turned, *self.order[start + len(turned) :])
                changes = [*self._turned_near(order, start, len(turned)), *self._whole_changes(order)]
                split = self._split(order, chain.from_iterable(self.runs.values())) if len(units) == len(order) else ()
                place = self._judged(order, start, more, state, split, changes)
                if place.more_um - sum(um for _, um in place.soft) < 0:
                    yield frozenset(turned), place

    def _turned_near(self, order: Sequence[int], start: int, length: int) -> Iterator[tuple[About, int | None]]:
        """What follows what at once along a stretch, before and after it was turned round."""
        if not self.moves and not self.groups:
            return
        for along, way in ((self.order, -1), (order, 1)):
            stretch = [self.home, *along, self.home][start : start + length + 2]
            for a, b in pairwise(stretch):
                for about, um in self.near(a, b):
                    if um is not None:
                        yield about, um * way
                    elif way > 0:
                        yield about, None

    def _judged(
        self,
        order: tuple[int, ...],
        at: int,
        more_um: int,
        state: _Slide,
        split: Iterable[About],
        changes: Iterable[tuple[About, int | None]],
    ) -> OtherPlace:
        """An order that a state has come to, with all that it changes beside the state."""
        hard = [*state.hard.values(), *split]
        soft = dict(state.soft)
        cost = more_um + sum(um for _, um in soft.values())
        crossed = self.crossed.more(order)
        for about, um in (*changes, (self.crossed.tipped, crossed)):
            if um is None:
                hard.append(about)
            elif um:
                cost += um
                add_to(soft, about, um)
        broken = {id(about): about for about in hard}
        newly = tuple((about, um) for about, um in soft.values() if um > 0)
        return OtherPlace(order, at + 1 + self.setting.made, cost, tuple(broken.values()), newly)

    # What hangs on which of two contours comes first.

    def _orders(self) -> None:
        self.first: dict[tuple[int, int], list[About]] = defaultdict(list)
        for order in self.setting.orders:
            self.first[order.before, order.after].append(order.about)

    def _conditions(self) -> None:
        """Conditions, and for each contour those that some statement names with it."""
        problem = self.setting.problem
        used = {None, *self.setting.route}
        self.asked = [c for c in problem.conditions if c.when in used]
        self.of_contour: dict[int, list[int]] = defaultdict(list)
        self.weight: list[dict[int, int]] = []
        self.named_with: dict[int, set[int]] = defaultdict(set)
        for a, b in self.first:
            self.named_with[a].add(b)
            self.named_with[b].add(a)
        self.sums: list[int] = []
        for k, condition in enumerate(self.asked):
            self.of_contour[condition.contour].append(k)
            weight: dict[int, int] = defaultdict(int)
            for member, value in zip(condition.members, condition.weights, strict=True):
                weight[member] += value
            self.weight.append(weight)
            self.named_with[condition.contour].update(weight)
            for member in weight:
                self.named_with[member].add(condition.contour)
            here = self.at[condition.contour]
            self.sums.append(sum(value for member, value in weight.items() if self.at[member] < here))

    # What hangs on which contour follows which at once: runs, and cuts next to each other.

    def _neighbours(self) -> None:
        problem = self.setting.problem
        kinds = by_kind(self.setting.stated.statements)
        self.runs: dict[int, list[Contiguous]] = defaultdict(list)
        for s in kinds.contiguous:
            if s.weight is None:
                self.runs[int(problem.block[s.contours[0]])].append(s)
        self.groups: dict[int, list[tuple[frozenset[int], int, About]]] = defaultdict(list)
        for group in problem.soft_groups:
            members = frozenset(group.contours)
            for contour in members:
                self.groups[contour].append((members, group.cost, group.about))
        self.moves = statements_by_leave(problem.moves.statements)
        self._asked_of: dict[tuple[int, int], list[tuple[About, int | None]]] = {}
        self.way = np.append(problem.site_candidate[self.site[:-1]], -1).tolist()

    def near(self, a: int, b: int) -> Iterator[tuple[About, int | None]]:
        """What it costs, or breaks, that b is cut right after a; either may be home."""
        if (a, b) not in self._asked_of:
            broken = (s for s in self.moves.get(a, ()) if s.covers(a, b, self.way[a], self.way[b]))
            self._asked_of[a, b] = [(s.about, None if s.weight is None else cost_um(s.weight)) for s in broken]
        yield from self._asked_of[a, b]
        for members, cost, about in self.groups.get(b, ()):
            if a not in members:
                yield about, cost

    def _near_changes(
        self, moved: tuple[int, ...], rest: Sequence[int], slot: int, start: int
    ) -> Iterator[tuple[About, int | None]]:
        if not self.moves and not self.groups:
            return
        now, then = (self._ends(moved, rest, k) for k in (start, slot))
        for (a, b, c, d), sign in ((now, -1), (then, 1)):
            for pair, way in (((a, b), sign), ((c, d), sign), ((a, d), -sign)):
                for about, um in self.near(*pair):
                    if um is not None:
                        yield about, um * way
                    elif way > 0:
                        yield about, None

    def _ends(self, moved: tuple[int, ...], rest: Sequence[int], slot: int) -> tuple[int, int, int, int]:
        before = rest[slot - 1] if slot else self.home
        after = rest[slot] if slot < len(rest) else self.home
        return before, moved[0], moved[-1], after

    def _travel(self, moved: tuple[int, ...], slots: range) -> Ints:
        """What travel costs more in some slots among the others, with their own among these."""
        start, size = int(self.at[moved[0]]), len(moved)
        a = self._line[slots.start : slots.stop].copy()
        b = self._line[slots.start + size + 1 : slots.stop + size + 1].copy()
        here = start - slots.start
        a[here + 1 :] = self._line[start + size + 1 : slots.stop + size]
        b[:here] = self._line[slots.start + 1 : start + 1]
        put = self.leg[a, moved[0]] + self.leg[moved[-1], b] - self.leg[a, b]
        return np.asarray(put - put[here], dtype=np.int64)

    def _runs_split(self, moved: tuple[int, ...], rest: Sequence[int], slot: int) -> Iterator[About]:
        """Hard runs that are not in one piece there."""
        block = self.setting.problem.block
        blocks = {int(block[c]) for c in moved}
        if 0 < slot < len(rest) and block[rest[slot - 1]] == block[rest[slot]]:
            blocks.add(int(block[rest[slot]]))
        runs = [run for number in blocks for run in self.runs.get(number, ())]
        if runs:
            yield from self._split((*rest[:slot], *moved, *rest[slot:]), runs)

    def _split(self, order: Sequence[int], runs: Iterable[Contiguous]) -> Iterator[About]:
        """The runs that are not in one piece in an order."""
        among = {c: k for k, c in enumerate(order)}
        for run in runs:
            places = [among[c] for c in run.contours]
            if max(places) - min(places) >= len(places):
                yield run.about

    # What hangs on the whole order.

    def _whole_changes(self, order: Sequence[int]) -> Iterator[tuple[About, int | None]]:
        if not self._far and not self.setting.problem.general:
            return
        there = self._whole(order)
        for key, (about, um) in there.items():
            now = self.whole_now[key][1]
            if um is None:
                if now is not None:
                    yield about, None
            elif um != now:
                yield about, um - (now or 0)

    def _whole(self, order: Sequence[int]) -> dict[int, tuple[About, int | None]]:
        """What each statement that looks further back costs, µm; None where a hard one is broken."""
        problem = self.setting.problem
        place = {c: k for k, c in enumerate(order)}
        route = [int(self.site[c]) for c in order]
        times = times_ms(problem, route) if any(lag.seconds for lag in self._far) else {}
        found: dict[int, tuple[About, int | None]] = {}
        for lag in self._far:
            missing, late = _missing(lag, place), missing_ms(lag, times) if lag.seconds else 0
            if lag.weight is None:
                found[id(lag)] = lag.about, None if missing or late else 0
            else:
                found[id(lag)] = lag.about, missing * cost_um(lag.weight) + late * round(lag.weight)
        picked = set(route)
        for s in problem.general:
            holds = general_holds(problem, s, place, picked)
            found[id(s)] = s.about, 0 if holds else None if s.weight is None else cost_um(s.weight)
        return found


class _Paid:
    """What a plan pays for soft statements, µm: no other place can save more of it than hangs on what changes there.

    By place: what the move there costs beside travel; by contour: what moves over it cost, and what conditions that are
    not met cost that name it.
    """

    def __init__(self, places: OtherPlaces) -> None:
        self._places, order = places, places.order
        n = len(order)
        self.near, self.crossed = np.zeros((2, n + 1), dtype=np.int64)
        self.of_contour = np.zeros(n + 1, dtype=np.int64)
        self.whole = sum(um or 0 for _, um in places.whole_now.values())
        for k, over, cost in places.crossed.over(order):
            if (over < 0 or places.at[over] < k) and cost != FORBIDDEN:
                self.crossed[k] += cost
                self.of_contour[over] += cost * (over >= 0)
        for k, (a, b) in enumerate(pairwise((places.home, *order, places.home))):
            self.near[k] = sum(um or 0 for _, um in places.near(a, b))
        self._moves = self.near + self.crossed
        self._unmet: list[tuple[int, int, int]] = []
        for k, condition in enumerate(places.asked):
            if condition.cost and places.sums[k] < condition.bound:
                members = [c for c, weight in places.weight[k].items() if weight]
                self.of_contour[[condition.contour, *members]] += condition.cost
                self._unmet += self._turned_by(k, condition.cost)

    def by_slot(self, moved: tuple[int, ...], slots: range) -> Ints:
        """What can be saved at the most with contours that follow each other moved to some slots among the others."""
        start, paid = int(self._places.at[moved[0]]), self._moves
        end = start + len(moved)
        fixed = self.whole + paid[start] + paid[end] + self.crossed[start + 1 : end].sum()
        fixed += self.of_contour[list(moved)].sum()
        later = paid[end + 1 : slots.stop + len(moved)]
        return np.asarray(fixed + np.concatenate([paid[slots.start : start], [0], later]), dtype=np.int64)

    def by_turned(self, units: Sequence[tuple[int, ...]], first: int) -> list[int]:
        """What can be saved at the most with the units from one to each later one turned round."""
        places = self._places
        if first == 0:
            self._by_end(units)
        start = int(places.at[units[first][0]])
        saved, total = [0] * len(units), self.whole + int(self.near[start] + self.crossed[start])
        for k in range(first, len(units)):
            total += self._within[k] if k > first else int(self.crossed[start + 1 : start + len(units[k])].sum())
            total += sum(cost for from_place, cost in self._ending[k] if from_place >= start)
            after = int(places.at[units[k][-1]]) + 1
            saved[k] = total + int(self.near[after] + self.crossed[after])
        return saved

    def _by_end(self, units: Sequence[tuple[int, ...]]) -> None:
        """By unit: what is paid within a stretch for it, and what the conditions cost that can be met once it is in."""
        places, unit_at = self._places, [k for k, unit in enumerate(units) for _ in unit]
        self._within = [0] * len(units)
        for k in range(1, len(units)):
            changes: dict[int, tuple[About, int]] = {}
            for pair, way in (((units[k - 1][-1], units[k][0]), -1), ((units[k][-1], units[k - 1][0]), 1)):
                for about, um in places.near(*pair):
                    add_to(changes, about, way * (um or 0))
            self._within[k] = sum(max(-um, 0) for _, um in changes.values())
            first = int(places.at[units[k][0]])
            self._within[k] += int(self.crossed[first : first + len(units[k])].sum())
        self._ending: list[list[tuple[int, int]]] = [[] for _ in units]
        for from_place, to_place, cost in self._unmet:
            self._ending[unit_at[to_place]].append((from_place, cost))

    def _turned_by(self, k: int, cost: int) -> Iterator[tuple[int, int, int]]:
        """The shortest stretches of the order which turned round can meet a condition, and what that saves."""
        places = self._places
        condition, here = places.asked[k], int(places.at[places.asked[k].contour])
        missing = condition.bound - places.sums[k]
        later = sorted((int(places.at[c]), w) for c, w in places.weight[k].items() if w > 0 and places.at[c] > here)
        earlier = [int(places.at[c]) for c, w in places.weight[k].items() if w < 0 and places.at[c] < here]
        if earlier:
            yield max(earlier), here, cost
            missing = 1
        for (there, _), so_far in zip(later, accumulate(w for _, w in later), strict=True):
            if so_far >= missing:
                yield here, there, cost
                break


def add_to(soft: dict[int, tuple[About, int]], about: About, um: int) -> None:
    soft[id(about)] = about, soft.get(id(about), (about, 0))[1] + um


class _Slide:
    """What is broken as contours slide along the order, one other contour passed after the other."""

    def __init__(self, places: OtherPlaces) -> None:
        self._places = places
        self._sums: dict[int, int] = {}
        self.hard: dict[object, About] = {}
        self.soft: dict[int, tuple[About, int]] = {}

    def passes(self, moved: tuple[int, ...], other: int, *, earlier: bool) -> None:
        """The moved contours come before another one that they came after, or the other way round."""
        places, sign = self._places, 1 if earlier else -1
        for mine in moved:
            if other not in places.named_with[mine]:
                continue
            pair = (other, mine) if earlier else (mine, other)
            for about in places.first.get(pair, ()):
                self.hard[id(about), pair] = about
            for k in places.of_contour.get(mine, ()):
                if (weight := places.weight[k].get(other, 0)) != 0:
                    self._changed(k, -sign * weight)
            for k in places.of_contour.get(other, ()):
                if (weight := places.weight[k].get(mine, 0)) != 0:
                    self._changed(k, sign * weight)

    def _changed(self, k: int, by: int) -> None:
        condition, base = self._places.asked[k], self._places.sums[k]
        before = self._sums.get(k, base)
        self._sums[k] = after = before + by
        was, met, now = (value >= condition.bound for value in (before, base, after))
        if was == now:
            return
        if condition.cost is None:
            if now:
                self.hard.pop(k, None)
            elif met:
                self.hard[k] = condition.about
        else:
            add_to(self.soft, condition.about, condition.cost * (was - now))


def _missing(lag: Lag, place: dict[int, int]) -> int:
    return max(0, lag.cuts - (abs(place[lag.first] - place[lag.second]) - 1))
