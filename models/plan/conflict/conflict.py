"""Why the hard rules cannot all hold, what must give way at the least cost, and the statements once it does."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.plan.plan import RELAXED
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import About, Statement, by_kind
from kerfwise.rules.stating.state_rules import (
    HOPELESS,
    DroppedStatement,
    Stated,
    every_statement,
    hopeless,
    resolve,
    rules_of_sums,
)
from kerfwise.rules.stating.statement_costs import COMMON

from .core import Core, Engines, find_core, find_whole_core
from .groups import DEFAULT_WORK, Group, NotAnswered, hard_groups, moves_or_seconds, order_groups
from .order_conflicts import opposites, orders_of
from .order_model import fewest_out
from .ways_out import AT_ONCE, cheapest, find_relaxation, soften

MOST, MOST_NAMED = 20, 8
CORE = 0.6
"""Share of what may be spent that goes into what contradicts what; the rest goes into the way out of it."""
PLANS = 4.0
"""Where seconds are counted, plans are compared only if so many times as many are left as the last look took."""
NO_HELP = "no rule that may give way helps: change the locks or the nest"


@dataclass(frozen=True, slots=True)
class Conflict:
    """Statements that contradict each other, and those that should give way.

    Without any one of `clash` the others of it could hold (unless `minimal` is False); with `alone` none of them can be
    met by any plan, whatever the others ask. `relax` is what must give way
    so that *all* rules can hold: None where nothing that may give way helps or none was found, and then `stuck` says
    which. `notes` are what no statement says. Unless `fewest`, fewer may do; unless `compared`, other statements, as
    few, may leave a cheaper plan.
    """

    clash: tuple[About, ...]
    minimal: bool
    relax: tuple[About, ...] | None
    stuck: str = ""
    notes: tuple[str, ...] = ()
    alone: bool = False
    compared: bool = True
    fewest: bool = True

    @property
    def contours(self) -> tuple[str, ...]:
        """The ids of the contours in conflict, each once."""
        return tuple(dict.fromkeys(name for about in self.clash for name in about.contours))

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def for_operator(self, made: int) -> Iterator[str]:
        """The same at the machine, where work has stopped after so many cuts: what cannot be together, and what helps.

        Who stands there knows contours and cuts, not the names of rules.
        """
        yield f"what is left after cut {made} cannot be cut as the plant asks; these do not go together:"
        sentences = list(dict.fromkeys(about.sentence for about in self.clash))
        yield from (f"  - {sentence}" for sentence in sentences[:MOST_NAMED])
        if len(sentences) > MOST_NAMED:
            yield f"  … and {len(sentences) - MOST_NAMED} more"
        yield from (f"  note: {note}" for note in self.notes)
        if self.relax is None:
            yield "nothing that may give way helps: cut the rest by hand, or ask whoever planned it"
            return
        gives = list(dict.fromkeys(about.sentence for about in self.relax))
        yield "it can be cut if this is not kept:"
        yield from (f"  - {sentence}" for sentence in gives[:MOST_NAMED])
        if len(gives) > MOST_NAMED:
            yield f"  … and {len(gives) - MOST_NAMED} more"

    def lines(self) -> Iterator[str]:
        """The conflict in a planner's words."""
        if self.alone:
            yield f"{HOPELESS}: {_times(self.clash)}:"
            yield from _listed(self.clash, len(self.clash))
        elif len(self.clash) == 1 and self.minimal:
            yield "this hard rule cannot hold, whichever of the offered ways to cut is taken:"
            yield from _listed(self.clash)
        else:
            yield "these hard rules cannot all hold; " + (
                "without any one of them the others can:"
                if self.minimal
                else "within the limit it was not shown that each of them has a part in it, so some may have none:"
            )
            yield from _listed(self.clash)
        yield from (f"  note: {note}" for note in self.notes)
        if self.relax is None:
            yield self.stuck
            return
        unknown = "which one costs least was not compared" if self.fewest else "fewer may do"
        yield "the cheapest way out:" if self.compared and self.fewest else f"a way out ({unknown}):"
        by_rule: dict[str, list[About]] = {}
        for about in self.relax:
            by_rule.setdefault(about.rule, []).append(about)
        for rule, abouts in by_rule.items():
            count = f"{len(abouts)} statement" + ("s" if len(abouts) > 1 else "")
            names = tuple(dict.fromkeys(name for about in abouts for name in about.contours))
            yield f"  relax {rule}: {count}" + (f" about {join_names(names, MOST_NAMED)}" if names else "")


def find_conflict(facts: Facts, profile: Profile, deadline: Deadline | None = None) -> Conflict | None:
    """Why no plan of this nest can hold every hard rule of the profile; None if no contradiction is shown.

    Looked for among statements on order and entries first; where these can hold, among all, what moves cross and
    seconds included, by the engines. No more is spent than the deadline allows: what is told then was shown before.

    Raises NotAnswered if it was not shown whether there is a contradiction.
    """
    deadline = deadline or Deadline(DEFAULT_WORK)
    statements, _ = every_statement(facts, profile)
    finder = _Finder(facts, profile, deadline)
    if alone := hopeless(statements):
        stuck, relax = _way_out_or_why_none(facts, profile, statements, finder)
        return Conflict(alone, True, relax, stuck, (), True, finder.compared, finder.fewest)
    core = finder.core(hard_groups(without_cycles(facts, profile, statements)), deadline.part(CORE))
    if core is None:
        return None
    clash, book = tuple(group.about for group in core.groups), profile.rulebook()
    stuck, relax = _way_out_or_why_none(facts, profile, statements, finder)
    clashing = by_kind(s for group in core.groups for s in group.statements)
    forbidden = {s.candidate for s in clashing.forbid}
    rules = dict.fromkeys(about.rule for about in clash)
    softer = [r for r in rules if r in book and book[r].may_be_relaxed and "soft" in book[r].strengths]
    if stuck == NOT_FOUND and softer:
        stuck += f", or make {' or '.join(softer)} soft or off"
    notes = (*_only_ways(facts, profile, forbidden), *_without_common_cuts(clash))
    return Conflict(clash, core.minimal, relax, stuck, notes, False, finder.compared, finder.fewest)


def state_relaxed(facts: Facts, profile: Profile, *, deadline: Deadline | None = None) -> Stated:
    """As `state_rules`, but where hard rules contradict each other the cheapest way out is taken.

    What gives way costs more than any plan travels and is among `dropped`, each with a reason that begins with
    `models.plan.RELAXED`. Raises InputError as `state_rules` does; RulesConflict if nothing that may give way helps, or
    nothing was found within the work allowed.
    """
    statements, exempt = every_statement(facts, profile)
    finder = _Finder(facts, profile, deadline or Deadline(DEFAULT_WORK), trusting=True)
    out = _way_out(facts, profile, statements, finder)
    relaxed = set(out)
    never_met = set(hopeless(statements))
    left = [s for s in soften(statements, relaxed) if s.about not in never_met]  # they would only add to every cost
    resolved = resolve(left, facts.n, _gives_way(profile), rules_of_sums(profile.rulebook()))
    given_up = {s.about: s for s in statements if s.weight is None and s.about in relaxed}
    dropped = tuple(DroppedStatement(s, f"{RELAXED}{about.sentence}") for about, s in given_up.items())
    return replace(resolved, dropped=(*resolved.dropped, *dropped), exempt=exempt)


class _Finder:
    """Finds contradictions, with so much work of the engines in all, and no more than the deadline allows.

    With `trusting`, what the engines show nothing of counts as none: whoever solves will see. `compared` says whether
    plans were made for every way out that is as short as the one found, `fewest` whether none is shorter.
    """

    def __init__(self, facts: Facts, profile: Profile, deadline: Deadline, trusting: bool = False) -> None:
        self.facts, self.gives_way, self.trusting, self.deadline = facts, _gives_way(profile), trusting, deadline
        self.engines = Engines(facts, profile.home_on(facts.nest), feeds_of(profile), deadline=deadline)
        self.compared = self.fewest = True

    def core(self, groups: Sequence[Group], part: Deadline | None = None) -> Core | None:
        """A contradiction, on order and entries alone where there is one, within a part of the deadline.

        Raises NotAnswered if it was not shown whether there is one.
        """
        left = part.left if part else 0.0
        try:
            found = find_core(self.facts, order_groups(groups), self.gives_way, part or self.deadline)
        finally:
            if part is not None:
                self.deadline.spend(left - part.left)
        if found is not None or not moves_or_seconds(groups):
            return found
        try:
            return find_whole_core(self.engines, groups, self.gives_way)
        except NotAnswered:
            if self.trusting:
                return None
            raise

    def at_once(self, groups: Sequence[Group], weights: Sequence[int | None]) -> tuple[list[int], bool] | None:
        """Groups to give up, and whether no others weigh less, by one model of orders and entries; see `fewest_out`."""
        asked = order_groups(groups)
        number = {group.about: k for k, group in enumerate(groups)}
        of = [number[group.about] for group in asked]
        found = fewest_out(self.facts, asked, [weights[k] for k in of], self.deadline, AT_ONCE)
        return None if found is None else ([of[k] for k in found[0]], found[1])


NOT_FOUND = (
    "no way out was found within the limit (none is proven impossible): rules were relaxed one after the other; try a "
    "longer limit, such as --work 60 (in Python work=60)"
)


def _way_out_or_why_none(
    facts: Facts, profile: Profile, statements: Sequence[Statement], finder: _Finder
) -> tuple[str, tuple[About, ...] | None]:
    """Why nothing helps, "" where something does, and what must give way."""
    try:
        return "", _way_out(facts, profile, statements, finder)
    except RulesConflict as error:
        return error.message, None


def _way_out(facts: Facts, profile: Profile, statements: Sequence[Statement], finder: _Finder) -> tuple[About, ...]:
    """What must give way: first where even rules that give way do not help."""
    book = profile.rulebook()
    out = list(hopeless(statements))
    if not all(about.rule in book and book[about.rule].may_be_relaxed for about in out):
        raise RulesConflict(NO_HELP)
    clashes: list[frozenset[About]] = []
    more, whole = 0, True
    while True:
        began = finder.deadline.left
        left = soften(statements, out)
        try:
            groups = hard_groups(without_cycles(facts, profile, left))
            known = opposites(orders_of(facts, groups))
            found = find_relaxation(groups, book, finder.core, finder.deadline, known, finder.at_once)
        except NotAnswered:
            if finder.trusting and more:  # what was found so far may do, or nothing was left to ask
                return tuple(out)
            raise RulesConflict(NOT_FOUND) from None
        if found is None:
            raise RulesConflict(NO_HELP)
        finder.fewest = finder.fewest and found.fewest
        if not found.groups:
            first = out[: len(out) - more]
            late = finder.deadline.timed and finder.deadline.left < PLANS * (began - finder.deadline.left)
            if late or not whole:
                finder.compared = not more
                return tuple(out)
            left = soften(statements, first)
            best, finder.compared = cheapest(
                finder.engines, left, out[len(first) :], clashes, _gives_way(profile), rules_of_sums(book)
            )
            return (*first, *best)
        whole = whole and found.whole
        more += len(found.groups)
        clashes += found.clashes
        out += [group.about for group in found.groups]


def without_cycles(facts: Facts, profile: Profile, statements: Sequence[Statement]) -> Sequence[Statement]:
    """The statements once cycles are resolved; where that is impossible, without the orders that give way."""
    gives_way = _gives_way(profile)
    try:
        return resolve(statements, facts.n, gives_way, rules_of_sums(profile.rulebook())).statements
    except RulesConflict:
        without = {s for s in by_kind(statements).precede if gives_way[s.about.rule]}
        return [s for s in statements if s not in without]


def _gives_way(profile: Profile) -> dict[str, int]:
    return {name: rule.gives_way for name, rule in profile.rulebook().items()}


def _only_ways(facts: Facts, profile: Profile, forbidden: set[int]) -> Iterator[str]:
    """Contours in conflict over their entry that a hard rule lets be cut one way round only."""
    directions = profile.lead_options().directions
    for k in sorted({facts.candidates[c].contour for c in forbidden}):
        contour = facts.nest.contours[k]
        ways = directions[contour.kind]
        if len(ways) == 1:
            rules = " and ".join(profile.rules_of_direction(contour.kind))
            yield f"{rules} offers no other way round {contour.id} than {ways[0]}"


def _without_common_cuts(clash: Iterable[About]) -> Iterator[str]:
    """Common cuts are a wish of the profile, which no rule asks for: without them their part of a conflict is gone."""
    if any(about.rule == COMMON for about in clash):
        yield "cuts.common asks for common cuts; without them (cuts: {common: {shortest: off}}) each part is cut whole"


def _listed(abouts: Sequence[About], most: int = MOST) -> Iterator[str]:
    yield from (f"  - {about.rule}: {about.sentence}" for about in abouts[:most])
    if len(abouts) > most:
        yield f"  … and {len(abouts) - most} more; in all {_times(abouts)}"


def _times(abouts: Sequence[About]) -> str:
    counts = Counter(about.rule for about in abouts)
    return ", ".join(f"{count} of {rule}" for rule, count in sorted(counts.items()))
