"""A minimal set of statements that cannot all hold: without any one of them the others can."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.graphs import Link
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.physics.motion import Feeds
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.simplify import simplify
from kerfwise.rules.statements import (
    by_kind,
    candidates_named,
    holds,
)
from kerfwise.rules.stating.feasible_order import order_in_runs

from .groups import (
    DEFAULT_WORK,
    CanClash,
    Group,
    NotAnswered,
    NothingLeft,
    drop_unneeded_rules,
    in_time,
    shrink,
    suspects,
)
from .order_conflicts import Orders, bounds, clash_of_orders, forced, is_exact, orders_of
from .order_model import clash, clash_at_once

FIRM = 1.0
"""Work, or seconds where they count, for a look whether rules that do not give way contradict each other as well."""


@dataclass(frozen=True, slots=True)
class Core:
    """Groups that contradict each other; `minimal` unless a question about them was too hard to answer.

    It was found `soon` where what all say of the order, or a few groups about locks alone, were enough to see it: a
    solver was at most asked about a few.
    """

    groups: tuple[Group, ...]
    minimal: bool
    soon: bool = False


def find_core(
    facts: Facts, groups: Sequence[Group], gives_way: Mapping[str, int], deadline: Deadline | None = None
) -> Core | None:
    """A minimal contradiction among the groups; None if there is none.

    Orders that contradict each other are seen without a solver and without work, and so is, mostly, that all can hold.
    Else whole rules are left out first, then halves, quarters, …, and at last single groups, those of rules that give
    way first (`gives_way`, the highest first): as far as answers come at once, and then with all the work they need.
    Every question is about the contours of the groups in it only, so that it soon is a small one. Raises NotAnswered if
    it was not shown whether all can hold.
    """
    deadline = deadline or Deadline(DEFAULT_WORK)
    orders = orders_of(facts, groups)
    if of_orders := clash_of_orders(facts.n, groups, orders, gives_way):
        return _firmest(facts, groups, _of_orders(facts, groups, of_orders, deadline), gives_way, deadline)
    if whole_order(facts, groups, orders) is not None:
        return None
    ranked = sorted(groups, key=lambda group: -gives_way.get(group.about.rule, 0))
    if locked := _among(facts, [ranked[k] for k in suspects(facts, ranked)], deadline):
        return _firmest(facts, groups, in_order(groups, *locked, soon=True), gives_way, deadline)
    paces_s: list[float] = []
    at_once = in_time(partial(clash_at_once, facts, deadline=deadline), deadline, paces_s)
    at_length = in_time(partial(clash, facts, deadline=deadline), deadline, paces_s)
    try:
        if at_once(ranked) is None:
            return None
    except NotAnswered:
        shown = False
    else:
        shown = True
        ranked, _ = shrink(drop_unneeded_rules(ranked, gives_way, at_once), at_once)
    try:
        left = at_length(ranked)
    except NotAnswered:
        if not shown:
            raise
        return in_order(groups, ranked, minimal=False)
    if left is None:
        return None
    core, minimal = shrink([ranked[k] for k in left], at_length)
    return in_order(groups, core, minimal)


def _of_orders(facts: Facts, groups: Sequence[Group], clashing: list[Group], deadline: Deadline) -> Core:
    """The core among groups whose orders clash, none of which the orders can do without."""
    minimal = True
    if not is_exact(orders_of(facts, clashing)):
        clashing, minimal = shrink(clashing, partial(clash, facts, deadline=deadline))
    return in_order(groups, clashing, minimal, soon=True)


def _firmest(
    facts: Facts, groups: Sequence[Group], core: Core, gives_way: Mapping[str, int], deadline: Deadline
) -> Core:
    """The core, or one without what gives way first in it, where little work shows one that is minimal."""
    most = max(gives_way.get(group.about.rule, 0) for group in core.groups)
    had = deadline.left
    if not most or had <= 0:
        return core
    firmer = [group for group in groups if gives_way.get(group.about.rule, 0) < most]
    part = deadline.part(min(1.0, FIRM / had))
    left = part.left
    try:
        found = find_core(facts, firmer, gives_way, part)
    except NotAnswered:
        return core
    finally:
        deadline.spend(left - part.left)
    return found if found is not None and found.minimal else core


def _among(facts: Facts, suspected: list[Group], deadline: Deadline) -> tuple[list[Group], bool] | None:
    """A contradiction among a few groups, and whether it is minimal; None where none is shown."""
    try:
        left = clash(facts, suspected, deadline)
    except NotAnswered:
        return None
    return None if left is None else shrink([suspected[k] for k in left], partial(clash, facts, deadline=deadline))


def in_order(groups: Sequence[Group], core: Sequence[Group], minimal: bool, soon: bool = False) -> Core:
    """The core with its groups as they stand among all."""
    place = {group.about: k for k, group in enumerate(groups)}
    return Core(tuple(sorted(core, key=lambda group: place[group.about])), minimal, soon)


# Contradictions over moves and seconds: the engines themselves are asked whether statements can all hold.
#
# Every question is a plan of the whole nest to be found or proven impossible, so that this is for small nests.

QUESTION = 3.0
"""Work, as `SolveOptions` counts it, for one question; past it the question counts as not answered."""
ALL_QUESTIONS = 45.0
"""Work for all questions together; past it a contradiction is told as far as it has been shrunk."""


class Engines:
    """What the engines answer, as long as their work and the deadline last."""

    def __init__(
        self, facts: Facts, home_mm: Point, feeds: Feeds, work: float = ALL_QUESTIONS, deadline: Deadline | None = None
    ) -> None:
        self.facts, self.home_mm, self.feeds, self.left = facts, home_mm, feeds, work
        self.deadline = deadline or Deadline(DEFAULT_WORK)

    def clash(self, groups: Sequence[Group]) -> list[int] | None:
        """All the groups by number if they cannot all hold, None if they can.

        Raises NotAnswered if neither was shown, or all work is done.
        """
        if self.left <= 0 or self.deadline.left <= 0:
            raise NothingLeft
        statements = tuple(s for group in groups for s in group.statements)
        try:
            problem = simplify(make_problem(self.facts, statements, self.home_mm, self.feeds, going=self._going))
        except RulesConflict:
            return list(range(len(groups)))
        options = SolveOptions(work=QUESTION, time_s=min(QUESTION, self.deadline.left) if self.deadline.timed else None)
        known = run_portfolio(problem, options, lambda engine, cost_um, bound_um: cost_um is None)
        self.left -= known.work
        self.deadline.spend(known.work)
        if known.incumbent is not None:
            return None
        if not known.infeasible:
            raise NotAnswered
        return list(range(len(groups)))

    def _going(self, share: float) -> bool:
        """Asked while moves are looked at, as many as there are; there is no answer once nothing is left."""
        if self.deadline.timed and self.deadline.left <= 0:
            raise NotAnswered
        return True


def find_whole_core(engines: Engines, groups: Sequence[Group], gives_way: Mapping[str, int]) -> Core | None:
    """A contradiction among the groups, minimal unless the work runs out before; None if there is none.

    Whole rules are left out first, then halves, quarters, … and at last single groups. Raises NotAnswered if it was not
    shown whether all can hold.
    """
    core = sorted(groups, key=lambda group: -gives_way.get(group.about.rule, 0))
    if engines.clash(core) is None:
        return None
    core, minimal = shrink(drop_unneeded_rules(core, gives_way, engines.clash), engines.clash)
    return in_order(groups, core, minimal)


# An order and entries that keep all groups, put together step by step: where one is found, nothing contradicts.
#
# It need not be found where there is one. What is found is held against every statement before it counts.

TRIES = 20
"""So often an order is made anew, with what the entries that were left had asked for."""


@dataclass(frozen=True, slots=True)
class Way:
    """Places of contours, from 0 on, and the candidates that are used; all but those of `entered` contours are open."""

    place: Sequence[int]
    contour_of: Sequence[int]
    picked: set[int] = field(default_factory=set)
    entered: set[int] = field(default_factory=set)

    def keeps(self, s: CanClash) -> bool:
        """Whether the statement holds, or may hold still where entries are open; moves and seconds are not asked."""
        return holds(s, self) is not False

    def picks(self, c: int) -> bool | None:
        """As `KnownPlan` says."""
        return True if c in self.picked else False if self.contour_of[c] in self.entered else None

    def cuts_by(self, contour: int, some: frozenset[int]) -> bool | None:
        """As `KnownPlan` says."""
        if any(self.contour_of[c] == contour for c in self.picked & some):
            return True
        return False if contour in self.entered else None


def whole_order(facts: Facts, groups: Sequence[Group], orders: Sequence[Orders]) -> Way | None:
    """An order of all contours, and entries, that keep every group; None if none was found.

    `orders` is what each group says of orders. Moves and seconds are not asked.
    """
    runs = [run for of in orders for run in of.runs]
    links = [link for of in orders for link in of.links]
    earliest, latest = bounds(orders)
    contour_of = [c.contour for c in facts.candidates]
    by_contour: dict[int, list[CanClash]] = defaultdict(list)
    for group, of in zip(groups, orders, strict=True):
        for s in () if of.whole else group.statements:
            for contour in dict.fromkeys(contour_of[c] for c in candidates_named(s)):
                by_contour[contour].append(s)
    for _ in range(TRIES):
        place = order_in_runs(facts.n, links, runs, earliest, latest)
        if place is None:
            return None
        way = Way(place, contour_of)
        wanted: list[Link] = []
        for contour, statements in by_contour.items():
            wants = _enter(way, facts.candidates_of(contour), statements)
            if wants is None:
                return None
            wanted += wants
            way.entered.add(contour)
        if not wanted:
            return way if all(way.keeps(s) for group in groups for s in group.statements) else None
        links = [*links, *wanted]
    return None


def _enter(way: Way, candidates: Iterable[int], statements: Sequence[CanClash]) -> list[Link] | None:
    """Use one of the candidates; the orders that it still needs, as few as can be. None if no order would help it."""
    found: tuple[list[Link], int] | None = None
    for c in candidates:
        way.picked.add(c)
        needs = [_needs(s) for s in statements if not way.keeps(s)]
        way.picked.discard(c)
        wants = [link for links in needs for link in links]
        if all(needs) and (found is None or len(wants) < len(found[0])):
            found = wants, c
            if not wants:
                break
    if found is None:
        return None
    way.picked.add(found[1])
    return found[0]


def _needs(s: CanClash) -> list[Link]:
    """The orders that a statement forces."""
    return [link for s in by_kind([s]).at_least for link, _ in forced(s)]
