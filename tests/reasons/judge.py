"""Whether a reason is true: what it names is taken away, and the plan looked at again, by plain arithmetic.

Nothing of the problem, the engines or the explanations is used: statements, and where candidates begin and end.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise, product
from typing import assert_never

import shapely

from kerfwise.rule_kit import (
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Enough,
    Facts,
    Forbid,
    Lag,
    NoGood,
    Pick,
    Precede,
    Statement,
    Steps,
)
from kerfwise.rules.statements import IdleTravel, Link, Literal

GRAZE_MM = 0.1
NOTHING_MM, SOMETHING_MM = 0.06, 0.04
"""Engines count whole micrometres, moves are rounded: so much is no difference, and so much is one."""
TRAVEL = re.compile(r"it is cut here for the shortest travel$")
NONE = re.compile(r"^no rule decides where ")
BETTER = re.compile(r"^no rule keeps .* as number (\d+) the plan would cost ([\d.]+) mm less")
TIPPED = "no idle travel leads over parts that are out"
MORE = re.compile(r"^(.*), and (\d+) more of (\S+)$")
TOGETHER = re.compile(r"^decided by (\d+) rules together: (.*)$")
ENTERED = re.compile(r"^entered at \((-?[\d.]+), (-?[\d.]+)\): the shortest lawful way from (.+) to (.+)$")


@dataclass(frozen=True)
class Verdict:
    """What a sentence of a plan says of a cut, and what is wrong with it: "" where it is true."""

    contour: str
    sentence: str
    wrong: str


@dataclass(frozen=True)
class Costs:
    """What a route costs without what statements add, and what each statement adds or whether it is broken."""

    travel_mm: float
    broken: frozenset[int]
    paid_mm: dict[int, float]

    def mm(self, without: Collection[int] = ()) -> float:
        return self.travel_mm + sum(mm for k, mm in self.paid_mm.items() if k not in without)


class Judge:
    """One plan: the candidates that it uses in cutting order, and what is stated of it.

    `later` answers with what only geometry finds in other orders, which no statement says: rules and sentences.
    """

    def __init__(
        self,
        facts: Facts,
        statements: Sequence[Statement],
        route: Sequence[int],
        home: tuple[float, float],
        later: Callable[[], Collection[tuple[str, str]]] = frozenset,
    ) -> None:
        self.facts, self.statements, self.route, self.home = facts, tuple(statements), tuple(route), home
        self.links = [s for s in self.statements if isinstance(s, Link)]
        self.price = sum(s.weight for s in self.statements if isinstance(s, IdleTravel))
        self.areas = {k: s.area.buffer(-GRAZE_MM) for k, s in enumerate(self.statements) if isinstance(s, Crossing)}
        self.timed = any(isinstance(s, Lag) and s.seconds for s in self.statements)
        self.ids = [contour.id for contour in facts.nest.contours]
        self._later = later
        self.now = self.costs(self.route)

    @cached_property
    def later(self) -> frozenset[tuple[str, str]]:
        """What only geometry finds in other orders."""
        return frozenset(self._later())

    def verdicts(self, contour: int, because: Sequence[str]) -> Iterator[Verdict]:
        """Each sentence that is about the place of a contour."""
        for sentence in because:
            wrong = self._wrong(contour, sentence)
            if wrong is not None:
                yield Verdict(self.ids[contour], sentence, wrong)

    def _wrong(self, contour: int, sentence: str) -> str | None:
        """What is wrong with a sentence; "" if nothing is, None where it is not about the place."""
        if TRAVEL.search(sentence):
            return self._not_for_travel(contour)
        if NONE.search(sentence):
            return self._decided_after_all(contour)
        if found := BETTER.search(sentence):
            return self._not_better(contour, int(found[1]), float(found[2]))
        if sentence.startswith("kept: "):
            mine = self._said(sentence.removeprefix("kept: "))
            return "" if mine and not mine & self.now.broken else "the plan does not keep it"
        if sentence.endswith(" is the only cut"):
            return "" if len(self.route) == 1 else "there are others"
        if sentence.startswith("what decides where "):
            return ""
        if found := TOGETHER.search(sentence):
            named = [rule for rule in re.split(", | and ", found[2]) if not re.fullmatch(r"\d+ more", rule)]
            return self._held_by_all(contour, frozenset(named), int(found[1]) - len(named))
        if found := ENTERED.search(sentence):
            return self._not_shortest(contour, (found[1], found[2]), (found[3], found[4]))
        named = self._named(sentence)
        if named is None:
            return "no statement says so" if sentence.startswith("together: ") else None
        return self._holds_without(contour, *named)

    def _said(self, sentence: str) -> set[int]:
        return {k for k, s in enumerate(self.statements) if s.about.sentence == sentence}

    def _named(self, sentence: str) -> tuple[set[int], set[str]] | None:
        """The statements that a sentence names, and the rules of which it says that there are more."""
        rest, gone, rules = sentence, set[int](), set[str]()
        if rest.startswith("together: "):
            rest = rest.removeprefix("together: ")
        while rest:
            parts = rest.split("; ")
            for many in range(len(parts), 0, -1):
                head = "; ".join(parts[:many])
                more = MORE.search(head)
                if head == TIPPED:
                    gone |= {k for k, s in enumerate(self.statements) if isinstance(s, Crossing)}
                elif found := self._said(head):
                    gone |= found
                elif more and (found := self._said(more[1])):
                    gone |= found
                    rules.add(more[3])
                elif not {head, more[1] if more else head} & {said for _, said in self.later}:
                    continue
                rest = "; ".join(parts[many:])
                break
            else:
                return None
        return gone, rules

    # The claims.

    def _holds_without(self, contour: int, gone: set[int], rules: set[str]) -> str:
        """What is wrong with that the plan costs less without some statements, and what more of rules is broken."""
        for route in self._elsewhere(contour):
            there = self.costs(route)
            newly = there.broken | {k for k, mm in there.paid_mm.items() if mm > self.now.paid_mm.get(k, 0.0)}
            without = gone | {k for k in newly if self.statements[k].about.rule in rules}
            lawful = there.broken <= (self.now.broken | without)
            if lawful and there.mm(without) < self.now.mm(without) - SOMETHING_MM:
                return ""
        return "no other place costs less without it"

    def _held_by_all(self, contour: int, named: frozenset[str], further: int) -> str:
        """What is wrong with that the plan costs less without some rules and so many further ones."""
        for route in self._elsewhere(contour):
            there = self.costs(route)
            newly = there.broken - self.now.broken
            newly |= {k for k, mm in there.paid_mm.items() if mm > self.now.paid_mm.get(k, 0.0)}
            rules = {self.statements[k].about.rule for k in newly}
            others = rules - named
            for some in combinations(sorted(others), min(further, len(others))):
                without = {k for k in newly if self.statements[k].about.rule in named.union(some)}
                lawful = there.broken <= self.now.broken | without
                if lawful and there.mm(without) < self.now.mm(without) - SOMETHING_MM:
                    return ""
        return "in no other place the plan costs less without these rules"

    def _not_shortest(self, contour: int, at: tuple[str, str], between: tuple[str, str]) -> str:
        """What is wrong with that no lawful entry makes a shorter way between the cuts before and after."""
        order = [self.facts.candidates[c].contour for c in self.route]
        k = order.index(contour)
        used, names = self.facts.candidates[self.route[k]], ["home", *(self.ids[c] for c in order), "home"]
        if (names[k], names[k + 2]) != between:
            return f"it is cut between {names[k]} and {names[k + 2]}"
        if any(abs(float(said) - mm) > 0.051 for said, mm in zip(at, used.entry, strict=True)):
            return f"it is entered at {used.entry}"
        before = self.home if k == 0 else self.facts.candidates[self.route[k - 1]].end
        after = self.home if k + 1 == len(order) else self.facts.candidates[self.route[k + 1]].pierce
        forbidden = {s.candidate for s in self.statements if isinstance(s, Forbid) and s.weight is None}

        def way_mm(c: int) -> float:
            way = self.facts.candidates[c]
            return math.dist(before, way.pierce) + math.dist(way.end, after)

        rivals = [c for c in self.facts.candidates_of(contour) if c not in forbidden]
        best = min(rivals, key=way_mm)
        if way_mm(self.route[k]) > way_mm(best) + SOMETHING_MM:
            return f"entered at {self.facts.candidates[best].entry} the way is shorter"
        return "" if len(rivals) > 1 else "there is no other lawful entry"

    def _not_for_travel(self, contour: int) -> str:
        for route in self._elsewhere(contour, alone=True, entries=True):
            there = self.costs(route)
            place = [self.facts.candidates[c].contour for c in route].index(contour) + 1
            if there.broken:
                return f"place {place} is forbidden: {self.statements[min(there.broken)].about.sentence}"
            if there.mm() <= self.now.mm() - NOTHING_MM:
                return f"place {place} is not longer"
        return ""

    def _decided_after_all(self, contour: int) -> str:
        for route in self._elsewhere(contour):
            there = self.costs(route)
            before, after = self._by_sentence(self.now), self._by_sentence(there)
            newly = sum(max(0.0, mm - before.get(said, 0.0)) for said, mm in after.items())
            if there.mm() - newly < self.now.mm() - NOTHING_MM:
                place = [self.facts.candidates[c].contour for c in route].index(contour) + 1
                return f"without any rule place {place} costs less"
        return ""

    def _by_sentence(self, costs: Costs) -> dict[tuple[str, str], float]:
        """What is paid for each sentence: several statements may share one."""
        paid: dict[tuple[str, str], float] = {}
        for k, mm in costs.paid_mm.items():
            about = self.statements[k].about
            paid[about.rule, about.sentence] = paid.get((about.rule, about.sentence), 0.0) + mm
        return paid

    def _not_better(self, contour: int, place: int, saved_mm: float) -> str:
        for route in self._elsewhere(contour):
            there = self.costs(route)
            if there.broken <= self.now.broken and there.mm() < self.now.mm() - saved_mm / 2:
                return ""
        return "no place is cheaper"

    # Other places, and what they cost.

    def _elsewhere(self, contour: int, *, alone: bool = False, entries: bool = False) -> Iterator[tuple[int, ...]]:
        """Every other place of a contour, and of every run about it that the plan cuts as one."""
        order = [self.facts.candidates[c].contour for c in self.route]
        units = [(order.index(contour), order.index(contour) + 1)]
        if not alone:
            runs = [set(s.contours) for s in self.statements if isinstance(s, Contiguous) and s.weight is None]
            unit = {contour}
            while grown := [run for run in runs if run & unit and not run <= unit]:
                unit = unit.union(*grown)
            places = sorted(order.index(c) for c in unit)
            if len(unit) > 1 and places[-1] - places[0] == len(places) - 1:
                units.append((places[0], places[-1] + 1))
        if not alone:
            yield from self._turned(order, contour)
        for first, last in units:
            moved, rest = self.route[first:last], self.route[:first] + self.route[last:]
            for slot in range(len(rest) + 1):
                if slot == first:
                    continue
                route = (*rest[:slot], *moved, *rest[slot:])
                if not entries:
                    yield route
                    continue
                ways = [[c] for c in route]
                for k in {slot - 1, slot, slot + 1} & set(range(len(route))):
                    ways[k] = [*self.facts.candidates_of(self.facts.candidates[route[k]].contour)]
                forbidden = {s.candidate for s in self.statements if isinstance(s, Forbid) and s.weight is None}
                yield from product(*([c for c in way if c not in forbidden] for way in ways))

    def _turned(self, order: Sequence[int], contour: int) -> Iterator[tuple[int, ...]]:
        """Every stretch about a contour turned round; contours that must follow each other stay as they are."""
        runs = [set(s.contours) for s in self.statements if isinstance(s, Contiguous) and s.weight is None]
        tied = [any({a, b} <= run for run in runs) for a, b in pairwise(order)]
        for starts in ([0, *(k + 1 for k, one in enumerate(tied) if not one), len(order)], list(range(len(order) + 1))):
            units = [self.route[a:b] for a, b in pairwise(starts)]
            mine = next(k for k, (a, b) in enumerate(pairwise(starts)) if a <= order.index(contour) < b)
            for first in range(mine + 1):
                for last in range(mine, len(units)):
                    turned = [*units[:first], *reversed(units[first : last + 1]), *units[last + 1 :]]
                    yield tuple(c for unit in turned for c in unit)

    def costs(self, route: Sequence[int]) -> Costs:
        """Travel, what is broken, and what each statement costs on a route."""
        at = {self.facts.candidates[c].contour: k for k, c in enumerate(route)}
        used = set(route)
        legs = list(pairwise([None, *route, None]))
        travel = sum(self.leg_mm(a, b) for a, b in legs)
        broken, paid = set[int](), dict[int, float]()
        for k, s in enumerate(self.statements):
            missing = self._missing(s, k, at, used, legs)
            if missing and s.weight is None:
                broken.add(k)
            elif missing:
                paid[k] = missing * s.weight
        return Costs(travel, frozenset(broken), paid)

    def _ends(self, a: int | None, b: int | None) -> tuple[tuple[float, float], tuple[float, float]]:
        leave = self.home if a is None else self.facts.candidates[a].end
        reach = self.home if b is None else self.facts.candidates[b].pierce
        return leave, reach

    def leg_mm(self, a: int | None, b: int | None) -> float:
        """What a move from a candidate (None: home) to another costs."""
        idle = self.price * math.dist(*self._ends(a, b))
        offers = [s.weight for s in self.links if a in s.leave and b in s.reach]
        return min([idle, *offers]) if offers else idle

    def _missing(
        self,
        s: Statement,
        number: int,
        at: dict[int, int],
        used: set[int],
        legs: Sequence[tuple[int | None, int | None]],
    ) -> float:
        """How often, or by how much, a route breaks a statement."""
        match s:
            case Precede():
                return at[s.before] > at[s.after]
            case Forbid():
                return s.candidate in used
            case AtLeast():
                if s.when is not None and s.when not in used:
                    return False
                return not self._enough(s.literals, s.weights, s.bound, at, used)
            case Contiguous():
                places = sorted(at[c] for c in s.contours)
                return sum(b != a + 1 for a, b in pairwise(places))
            case Lag():
                return max(0, s.cuts - (abs(at[s.first] - at[s.second]) - 1))
            case NoGood():
                return max(at[c] for c in s.out) < min(at[c] for c in s.left)
            case Crossing():
                over = -1 if s.over is None else at[s.over]
                crossed = 0
                for k, (a, b) in enumerate(legs):
                    on = any(a in link.leave and b in link.reach for link in self.links)
                    line = shapely.LineString(self._ends(a, b))
                    crossed += over < k and not on and bool(self.areas[number].intersects(line))
                return crossed
            case IdleTravel() | Link():
                return 0
            case _:
                assert_never(s)

    def _enough(
        self,
        literals: Sequence[Literal],
        weights: Sequence[int],
        bound: int,
        at: dict[int, int],
        used: set[int],
    ) -> bool:
        total = 0
        for literal, weight in zip(literals, weights, strict=True):
            match literal:
                case Before(i, j):
                    total += weight * (at[i] < at[j])
                case Steps(i, j, least, most):
                    total += weight * (least <= at[j] - at[i] <= most)
                case Pick(c):
                    total += weight * (c in used)
                case Enough():
                    total += weight * self._enough(literal.literals, literal.weights, literal.bound, at, used)
        return total >= bound


def kind(sentence: str) -> str:
    """What a sentence about a place claims."""
    if TRAVEL.search(sentence):
        return "for the travel"
    if NONE.search(sentence):
        return "no rule decides"
    if BETTER.search(sentence):
        return "not found within the limit"
    if ENTERED.search(sentence):
        return "shortest entry"
    if sentence.startswith("another entry"):
        return "other entries"
    if " leaves no other way round than " in sentence:
        return "one way round"
    if sentence.startswith("kept: "):
        return "kept"
    if sentence.startswith("what decides where "):
        return "not worked out"
    if sentence.endswith(" is the only cut"):
        return "the only cut"
    return "several statements" if re.search(r"\btogether: ", sentence) or MORE.search(sentence) else "one statement"
