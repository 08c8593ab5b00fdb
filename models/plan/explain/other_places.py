"""What a plan would cost with a contour in another place, and which statements that would break: every place, exactly.

The others keep their order, or a stretch of it is turned round, and all keep their entries. As a contour slides along
the order, one other is passed at a time, so that only what names the two is looked at again.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, groupby, pairwise

import numpy as np
import shapely

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.tolerances import GRAZE_UM, UM_PER_MM, cost_um
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.evaluate import general_holds, missing_ms, times_ms
from kerfwise.rules.statements import About, Contiguous, Lag, by_kind

from .context import PlanContext

MOST_CONTOURS, MOST_STEPS = 2000, 40_000
"""Contours beyond which no other places are tried; and how many contours are passed in all, at the most."""
MOST_WHOLE = 60
"""Contours up to which statements that look at whole orders are judged anew for every place."""
MOST_TURNED = 120
"""Contours up to which stretches are turned round."""
MOST_CROSSED = 400
"""Contours up to which every move is looked at that leads over parts."""
TIPPED = "no idle travel leads over parts that are out"


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
        crossed = by_kind(setting.stated.statements).crossing
        most = MOST_WHOLE if whole else MOST_CROSSED if crossed else MOST_CONTOURS
        self.complete = n <= most and not problem.left_out
        self.reach = max(20, MOST_STEPS // max(n, 1))
        if not self.complete:
            return
        self.home = n
        self.site = np.empty(n + 1, dtype=np.int64)
        self.site[self.order], self.site[n] = setting.route, problem.m
        self.leg = problem.travel(self.site, self.site)
        self.at = np.empty(n + 1, dtype=np.int64)
        self.at[self.order], self.at[n] = np.arange(n), n
        self._orders()
        self._conditions()
        self._neighbours()
        self._far = [lag for lag in problem.lags if lag.cuts > 1 or lag.seconds > 0]
        self._whole_now = self._whole(self.order) if self._far or problem.general else {}
        self._crossings()

    def of(self, contour: int) -> Iterator[OtherPlace]:
        """The contour alone in every other place within reach, and what it is cut in one run with as a whole."""
        yield from self.slid((contour,))
        block = self.setting.problem.block
        unit = tuple(c for c in self.order if block[c] == block[contour])
        if 1 < len(unit) < len(self.order) and max(self.at[list(unit)]) - min(self.at[list(unit)]) == len(unit) - 1:
            yield from self.slid(unit)

    def slid(self, moved: tuple[int, ...]) -> Iterator[OtherPlace]:
        """Contours that follow each other, moved as one to every other place within reach."""
        start = int(self.at[moved[0]])
        rest = [c for c in self.order if c not in set(moved)]
        more = self._travel_and_neighbours(moved, rest, start)
        for there in (range(start - 1, -1, -1), range(start + 1, len(rest) + 1)):
            state = _Slide(self)
            for slot in there:
                if abs(slot - start) > self.reach:
                    break
                state.passes(moved, rest[slot if there.step < 0 else slot - 1], earlier=there.step < 0)
                order = (*rest[:slot], *moved, *rest[slot:])
                changes = [*self._near_changes(moved, rest, slot, start), *self._whole_changes(order)]
                split = self._runs_split(moved, rest, slot)
                yield self._judged(order, slot, int(more[slot]), state, split, changes)

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
        ends = [(self.home, self.home), *((unit[0], unit[-1]) for unit in units), (self.home, self.home)]
        for first in range(len(units) - 1):
            state, inside = _Slide(self), list(units[first])
            back = 0  # what travel and neighbours within the stretch cost more, turned round
            for last in range(first + 1, len(units)):
                for other in inside:
                    state.passes(units[last], other, earlier=True)
                inside += units[last]
                (a, b), (c, d) = ends[last], ends[last + 1]  # the two units that meet at its end
                back += int(self.leg[d, a] - self.leg[b, c])
                (_, before), (after, _) = ends[first], ends[last + 2]
                (f0, f1), (l0, l1) = ends[first + 1], ends[last + 1]
                more = back + int(self.leg[before, l0] + self.leg[f1, after])
                more -= int(self.leg[before, f0] + self.leg[l1, after])
                worth = sum(min(um, 0) for _, um in state.soft.values())
                if more + worth >= 0 and not self.groups and not self.lags and not self.over and not self._far:
                    continue
                turned = [c for unit in reversed(units[first : last + 1]) for c in unit]
                start = sum(map(len, units[:first]))
                order = (*self.order[:start], *turned, *self.order[start + len(turned) :])
                changes = [*self._turned_near(order, start, len(turned)), *self._whole_changes(order)]
                split = self._split(order, chain.from_iterable(self.runs.values())) if len(units) == len(order) else ()
                place = self._judged(order, start, more, state, split, changes)
                if place.more_um - sum(um for _, um in place.soft) < 0:
                    yield frozenset(turned), place

    def _turned_near(self, order: Sequence[int], start: int, length: int) -> Iterator[tuple[About, int | None]]:
        """What follows what at once along a stretch, before and after it was turned round."""
        if not self.lags and not self.groups:
            return
        for along, way in ((self.order, -1), (order, 1)):
            stretch = [self.home, *along, self.home][start : start + length + 2]
            for a, b in pairwise(stretch):
                for about, um in self._near(a, b):
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
        crossed = self._crossed_more(order)
        for about, um in (*changes, (self.tipped, crossed)):
            if um is None:
                hard.append(about)
            elif um:
                cost += um
                _add(soft, about, um)
        broken = {id(about): about for about in hard}
        newly = tuple((about, um) for about, um in soft.values() if um > 0)
        return OtherPlace(order, at + 1 + self.setting.made, cost, tuple(broken.values()), newly)

    # What hangs on which of two contours comes first.

    def _orders(self) -> None:
        self.first: dict[tuple[int, int], list[About]] = defaultdict(list)
        for order in self.setting.orders:
            self.first[order.before, order.after].append(order.about)

    def _conditions(self) -> None:
        problem = self.setting.problem
        used = {None, *self.setting.route}
        self.asked = [c for c in problem.conditions if c.when in used]
        self.of_contour: dict[int, list[int]] = defaultdict(list)
        self.weight: list[dict[int, int]] = []
        self.naming: dict[int, list[int]] = defaultdict(list)
        self.sums: list[int] = []
        for k, condition in enumerate(self.asked):
            self.of_contour[condition.contour].append(k)
            weight: dict[int, int] = defaultdict(int)
            for member, value in zip(condition.members, condition.weights, strict=True):
                weight[member] += value
            self.weight.append(weight)
            for member in weight:
                self.naming[member].append(k)
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
        self.lags: dict[tuple[int, int], list[tuple[About, int | None]]] = defaultdict(list)
        for lag in problem.lags:
            if lag.cuts == 1 and not lag.seconds:
                price = None if lag.weight is None else cost_um(lag.weight)
                for pair in ((lag.first, lag.second), (lag.second, lag.first)):
                    self.lags[pair].append((lag.about, price))

    def _near(self, a: int, b: int) -> Iterator[tuple[About, int | None]]:
        """What it costs, or breaks, that b is cut right after a; either may be home."""
        yield from self.lags.get((a, b), ())
        for members, cost, about in self.groups.get(b, ()):
            if a not in members:
                yield about, cost

    def _near_changes(
        self, moved: tuple[int, ...], rest: Sequence[int], slot: int, start: int
    ) -> Iterator[tuple[About, int | None]]:
        if not self.lags and not self.groups:
            return
        now, then = (self._ends(moved, rest, k) for k in (start, slot))
        for (a, b, c, d), sign in ((now, -1), (then, 1)):
            for pair, way in (((a, b), sign), ((c, d), sign), ((a, d), -sign)):
                for about, um in self._near(*pair):
                    if um is not None:
                        yield about, um * way
                    elif way > 0:
                        yield about, None

    def _ends(self, moved: tuple[int, ...], rest: Sequence[int], slot: int) -> tuple[int, int, int, int]:
        before = rest[slot - 1] if slot else self.home
        after = rest[slot] if slot < len(rest) else self.home
        return before, moved[0], moved[-1], after

    def _travel_and_neighbours(self, moved: tuple[int, ...], rest: Sequence[int], start: int) -> Ints:
        """What travel costs more, by slot."""
        a, b = np.array([self.home, *rest]), np.array([*rest, self.home])
        put = self.leg[a, moved[0]] + self.leg[moved[-1], b] - self.leg[a, b]
        return np.asarray(put - put[start], dtype=np.int64)

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
            now = self._whole_now[key][1]
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

    # Idle travel over parts that are out.

    def _crossings(self) -> None:
        """Moves over parts, hard orders or not: a problem has only those that can occur."""
        problem, kinds = self.setting.problem, by_kind(self.setting.stated.statements)
        self.over: dict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
        self._crossed_now: int | None = 0
        self.tipped = About(kinds.crossing[0].about.rule if kinds.crossing else "", (), TIPPED)
        if not kinds.crossing:
            return
        ends, pierces = problem.ends()[self.site], problem.pierces()[self.site]
        leave, reach = (of.ravel() for of in np.meshgrid(np.arange(problem.n + 1), np.arange(problem.n + 1)))
        if len(problem.links):
            idle = problem.links.rows_of(self.site[leave], self.site[reach]) < 0
            leave, reach = leave[idle], reach[idle]
        lines = shapely.linestrings(np.stack([ends[leave], pierces[reach]], axis=1) / UM_PER_MM)
        areas = shapely.buffer([s.area for s in kinds.crossing], -GRAZE_UM / UM_PER_MM)
        for line, area in shapely.STRtree(areas).query(lines, predicate="intersects").T.tolist():
            s = kinds.crossing[area]
            over, cost = -1 if s.over is None else s.over, FORBIDDEN if s.weight is None else cost_um(s.weight)
            self.over[int(leave[line]), int(reach[line])].append((over, cost))
        self._crossed_now = self._crossed(self.order)

    def _crossed_more(self, order: Sequence[int]) -> int | None:
        """What is crossed more, µm; None where it may not be."""
        there = self._crossed(order) if self.over else 0
        return None if there is None else there - (self._crossed_now or 0)

    def _crossed(self, order: Sequence[int]) -> int | None:
        place = {c: k for k, c in enumerate(order)}
        total, leave = 0, self.home
        for k, reach in enumerate((*order, self.home)):
            for over, cost in self.over.get((leave, reach), ()):
                if over < 0 or place[over] < k:
                    if cost == FORBIDDEN:
                        return None
                    total += cost
            leave = reach
        return total


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
            _add(self.soft, condition.about, condition.cost * (was - now))


def _add(soft: dict[int, tuple[About, int]], about: About, um: int) -> None:
    soft[id(about)] = about, soft.get(id(about), (about, 0))[1] + um


def _missing(lag: Lag, place: dict[int, int]) -> int:
    return max(0, lag.cuts - (abs(place[lag.first] - place[lag.second]) - 1))
