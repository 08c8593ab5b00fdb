"""From facts and a profile to statements: what must hold of a plan of this nest in this plant."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.graphs import (
    Link,
    Unbreakable,
    components,
    contract_pairs,
    contracted,
    lightest_cut,
    path,
    some_cycles,
)
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import EXEMPTION_MM, About, AtLeast, Contiguous, IdleTravel, Precede, Statement, by_kind

from .feasible_order import links_to_drop, position_clashes, positions
from .feasible_sums import links_to_drop_for_sums, sums_of_orders
from .lazy_statements import asked_of_torches, in_held_metal
from .reduced_statements import GantryStatements, rest_of, stated_by
from .statement_costs import begun_first, late_parts, link_offers, open_ways, slower_ways, soften

if TYPE_CHECKING:
    from kerfwise.encoder.facts.facts import Facts
    from kerfwise.rules.profile.technique import Technique


HOPELESS = "these hard rules cannot hold in any order"

NOT_SHOWN = "; whether others would be fewer was not shown"

MOST_ROUNDS = 40
"""Rounds in which cycles are gathered; after them it is not shown which orders are the lightest."""

CONTRADICT = "these hard rules contradict each other; one must give way"

LOOSE = next(name for name, rule in RULES.items() if rule.of_fallen_metal)
"""The rule that a contour breaks which is left in metal that has fallen out."""


@dataclass(frozen=True, slots=True)
class DroppedStatement:
    """A statement that was left out because hard ones contradict each other, and why: mostly an order on a cycle."""

    statement: Statement
    why: str

    @property
    def rule(self) -> str:
        """Id of the rule that gave way."""
        return self.statement.about.rule

    @property
    def contours(self) -> tuple[str, ...]:
        """The ids of its contours; of an order, the first was to be cut before the second."""
        return self.statement.about.contours


@dataclass(frozen=True, slots=True)
class Stated:
    """What is asked of a plan, free of cycles, and what was dropped to make it so.

    `exempt` names contours of which a hard rule asks nothing in any order, because nothing can make them keep it.
    """

    statements: tuple[Statement, ...]
    dropped: tuple[DroppedStatement, ...]
    exempt: tuple[About, ...] = ()


def state_rules(facts: Facts, profile: Technique, by_other_zones: Stated | None = None) -> Stated:
    """Ask every rule that is on for its statements, and resolve the cycles among the hard orders.

    What is stated `by_other_zones` of facts that are else the same, nothing relaxed, is taken over of rules that do not
    mind zones: large nests have hundreds of thousands of such statements. Raises InputError if a lock names something
    that the nest does not have, or a rule's model file cannot be compiled; RulesConflict if orders that may not be
    dropped contradict each other, or no plan can meet a statement; the reasons are their sentences.

    Examples
    --------
    >>> from kerfwise.encoder.facts import compute_facts
    >>> from kerfwise.rules.profile.load import load_profile
    >>> from kerfwise.rules.case import nest, part, rect
    >>> profile = load_profile()
    >>> plate = nest(400, 100, part("P1", rect(10, 10, 80, 80), [rect(30, 30, 20, 20)]))
    >>> stated = state_rules(compute_facts(plate, profile.fact_options(), ()), profile)
    >>> stated.statements[0].about.sentence
    'P1.hole1 is cut before P1.outer: it lies inside it, and cutting P1.outer frees the metal it is in'
    """
    known = {} if by_other_zones is None else _kept(by_other_zones, profile)
    statements, exempt = every_statement(facts, profile, known)
    if alone := hopeless(statements):
        raise RulesConflict(HOPELESS, tuple(about.sentence for about in alone))
    book = profile.rulebook()
    resolved = resolve(statements, facts.n, {name: rule.gives_way for name, rule in book.items()}, rules_of_sums(book))
    return replace(resolved, exempt=exempt)


def every_statement(
    facts: Facts, profile: Technique, known: Mapping[str, Sequence[Statement]] = MappingProxyType({})
) -> tuple[list[Statement], tuple[About, ...]]:
    """What the rules that are on state, cycles and all, and the contours they exempt; some of it may be known."""
    book = profile.rulebook()
    statements: list[Statement] = []
    exempt: list[About] = []
    for name, setting in profile.settings().items():
        stated: Iterable[Statement] = ()
        if name in known:
            statements += known[name]
        else:
            stated = stated_by(book[name], facts, setting.options)
        if setting.weight is None:
            statements += soften(stated, EXEMPTION_MM) if book[name].excusable else stated
            exempt += book[name].exempt(facts if facts.copies is None else facts.copies.whole, setting.options)
        else:
            statements += soften(stated, setting.weight)
    statements += begun_first(facts)
    statements += in_held_metal(facts, rest_of(facts), statements)
    statements += _objective(facts, profile)
    return statements, tuple(exempt)


def _kept(stated: Stated, profile: Technique) -> dict[str, list[Statement]]:
    """What rules that do not mind zones have stated, by rule, in order; none of rules whose statements were dropped."""
    book, gave_way = profile.rulebook(), {dropped.rule for dropped in stated.dropped}
    blind = [name for name in profile.settings() if name not in gave_way and not book[name].minds_zones]
    kept: dict[str, list[Statement]] = {name: [] for name in blind}
    for s in stated.statements:
        if s.about.rule in kept:
            kept[s.about.rule].append(s)
    return kept


def hopeless_anyway(facts: Facts, profile: Technique) -> tuple[About, ...]:
    """As `hopeless`, of the rules that look at contours alone: for nests that have no candidates."""
    book = profile.rulebook()
    on = {name: setting for name, setting in profile.settings().items() if book[name].relaxable}
    return hopeless([s for name, setting in on.items() for s in book[name].statements(facts, setting.options)])


def hopeless(statements: Sequence[Statement]) -> tuple[About, ...]:
    """Where the hard statements come from that no plan can meet, whatever the others ask."""
    found = (s.about for s in by_kind(statements).at_least if s.weight is None and s.hopeless)
    return tuple(dict.fromkeys(found))


def loose_orders(facts: Facts) -> tuple[Precede, ...]:
    """Orders that are broken for good: contours that cannot be cut any more, for what is around them is out.

    Contours are numbered as in the whole nest.
    """
    if facts.past is None:
        return ()
    index = facts.whole_nest.index
    return tuple(
        Precede(index[inner], index[outer], About(LOOSE, (inner, outer), _loose_text(inner, outer)))
        for inner, outer in facts.past.loose
    )


def _loose_text(inner: str, outer: str) -> str:
    return f"{inner} cannot be cut any more: {outer}, which lies around it, is out, and the metal between is loose"


def too_much_at_once(facts: Facts, profile: Technique) -> dict[int, About]:
    """Contours of the first torch that cannot be cut together with others by the hard rules, and one reason of each.

    What is asked of them asks for an order of what is cut at one time, or leaves them no way to be cut.
    """
    if facts.copies is None:
        return {}
    book, found = profile.rulebook(), dict[int, About]()
    shut: dict[int, About] = {}
    for name, setting in profile.settings().items():
        if setting.weight is None:
            at_once = GantryStatements(facts.copies)
            stated = at_once.of_first(
                book[name].statements(facts.copies.whole, setting.options), book[name].of_each_torch
            )
            shut |= {s.candidate: s.about for s in by_kind(stated).forbid if s.weight is None}
            found |= dict(at_once.impossible)
    of_metal = GantryStatements(facts.copies)
    list(of_metal.of_first(asked_of_torches(facts)))
    found |= dict(of_metal.impossible)
    for group in facts.copies.groups:
        first = int(facts.copies.number[group.contours[0]])
        ways = facts.candidates_of(first)
        if ways and all(c in shut for c in ways):
            found.setdefault(first, shut[ways[0]])
    return found


def _objective(facts: Facts, profile: Technique) -> list[Statement]:
    """Idle travel at its price by the millimetre and the second, slower or open ways, parts that wait, and links."""
    price = profile.objective.idle + profile.objective.time / profile.machine.travel_mm_s
    return [
        IdleTravel(About("objective", (), f"a millimetre of idle travel costs {price:g}"), price),
        *slower_ways(facts, profile),
        *open_ways(facts),
        *late_parts(facts, profile),
        *link_offers(facts, profile),
    ]


def rules_of_sums(book: Mapping[str, Rule[Any]]) -> frozenset[str]:
    """The rules whose sums of orders the check sees, so that it lets orders give way to them."""
    return frozenset(name for name, rule in book.items() if type(rule).sums is not Rule.sums)


def resolve(
    statements: Sequence[Statement], n: int, gives_way: Mapping[str, int], of_sums: Collection[str] = ()
) -> Stated:
    """The statements without those that must be dropped to leave the hard orders over n contours free of cycles.

    Where a contour has a firm position, orders that leave it no such position are dropped as well, and so are those
    beside which hard sums of orders of rules `of_sums` cannot hold.

    The weakest rules give way first (`gives_way`, the highest first; 0 never), and as few of their orders as can be.
    """
    kinds = by_kind(statements)
    if abouts := position_clashes(kinds.at_least, n):
        raise RulesConflict(CONTRADICT, tuple(about.sentence for about in abouts))
    orders = [s for s in kinds.precede if s.weight is None]
    runs = [s for s in kinds.contiguous if s.weight is None]
    ends = np.array([[s.before for s in orders], [s.after for s in orders]], dtype=np.int64).T
    links = contract_pairs(n, ends, [s.contours for s in runs])
    asking: dict[Link, list[Precede]] = {}
    for component in components(links):
        for (before, after), k in zip(links[component].tolist(), component, strict=True):
            asking.setdefault((before, after), []).append(orders[k])
    distinct = list(asking)
    try:
        out = lightest_cut(distinct, _weights(list(asking.values()), gives_way))
    except Unbreakable as error:
        raise _conflict([_firmest(asking[distinct[k]], gives_way) for k in error.cycle], runs) from None
    kept = sorted(set(range(len(distinct))) - set(out))
    dropped = []
    for k in out:
        against = path(distinct, kept, distinct[k][1], distinct[k][0]) or []
        why = _round_by([asking[distinct[m]] for m in against], gives_way)
        dropped += [DroppedStatement(order, why) for order in asking[distinct[k]]]
    left = _without(statements, dropped)
    late = _links_to_drop_for_positions(left, n, gives_way)
    if late and dropped:  # chosen one after the other they may be more than need be
        jointly = _jointly(statements, n, gives_way)
        if jointly is not None:
            dropped, late = jointly, []
        else:
            dropped = [replace(d, why=f"{d.why}{NOT_SHOWN}") for d in dropped]
    left = _without(statements, [*dropped, *late])
    for_sums = _links_to_drop_for_sums(left, n, gives_way, of_sums)
    return Stated(tuple(_without(left, for_sums)), (*dropped, *late, *for_sums))


def _without(statements: Sequence[Statement], dropped: Sequence[DroppedStatement]) -> Sequence[Statement]:
    if not dropped:
        return statements
    gone = {id(d.statement) for d in dropped}
    return [s for s in statements if id(s) not in gone]


def _jointly(statements: Sequence[Statement], n: int, gives_way: Mapping[str, int]) -> list[DroppedStatement] | None:
    """The lightest orders without which there is no cycle and all firm positions can hold; None if none were found.

    Cycles are looked for in what the positions leave, and hit as well from then on, until none is left.
    """
    at, kinds = positions(statements, n), by_kind(statements)
    asking = _asking(statements)
    links, runs = list(asking), [s.contours for s in kinds.contiguous if s.weight is None]
    weights = _weights(list(asking.values()), gives_way)
    nodes = contracted(n, links, runs)
    cycles: dict[frozenset[int], None] = {}
    for _ in range(MOST_ROUNDS):
        found_out = links_to_drop(n, links, weights, runs, at, cycles)
        if found_out is None:
            return None
        out, shown = found_out
        kept = sorted(set(range(len(links))) - set(out))
        found = [frozenset(cycle) for cycle in some_cycles(nodes, kept)]
        if not found:
            break
        cycles |= dict.fromkeys(found)
    else:
        return None
    place, dropped = _place_because(kinds.at_least, n), []
    for k in out:
        against = path(nodes, kept, nodes[k][1], nodes[k][0])
        where = place if against is None else _round_by([asking[links[m]] for m in against], gives_way)
        dropped += [DroppedStatement(order, where if shown else f"{where}{NOT_SHOWN}") for order in asking[links[k]]]
    return dropped


def _asking(statements: Sequence[Statement]) -> dict[Link, list[Precede]]:
    """The hard orders by their two contours."""
    asking: dict[Link, list[Precede]] = {}
    for s in by_kind(statements).precede:
        if s.weight is None:
            asking.setdefault((s.before, s.after), []).append(s)
    return asking


def _place_because(at_least: Sequence[AtLeast], n: int) -> str:
    firm = [s.about for s in at_least if s.weight is None and len(s.literals) == n - 1]
    return "place: " + "; ".join(dict.fromkeys(about.sentence for about in firm))


def _round_by(against: Sequence[Sequence[Precede]], gives_way: Mapping[str, int]) -> str:
    return "cycle: " + ", ".join(_spoken(_firmest(orders, gives_way)) for orders in against)


def _links_to_drop_for_positions(
    statements: Sequence[Statement], n: int, gives_way: Mapping[str, int]
) -> list[DroppedStatement]:
    """The orders that must go so that contours can be cut at positions that are firm, such as those of locks."""
    kinds = by_kind(statements)
    at = positions(kinds.at_least, n)
    if not at:
        return []
    asking = _asking(statements)
    runs = [s.contours for s in kinds.contiguous if s.weight is None]
    links = list(asking)
    out, shown = links_to_drop(n, links, _weights(list(asking.values()), gives_way), runs, at) or ([], True)
    place = _place_because(kinds.at_least, n) + ("" if shown else NOT_SHOWN)
    return [DroppedStatement(order, place) for k in out for order in asking[links[k]]]


def _links_to_drop_for_sums(
    statements: Sequence[Statement], n: int, gives_way: Mapping[str, int], of_sums: Collection[str]
) -> list[DroppedStatement]:
    """The orders that must go so that sums of orders can hold; those of zones do not count where zones must yield."""
    sums = [s for s in sums_of_orders(statements) if s.about.rule in of_sums] if of_sums else []
    if not sums:
        return []
    asking = _asking(statements)
    runs = [s.contours for s in by_kind(statements).contiguous if s.weight is None]
    of_zones = {name for name, rule in RULES.items() if rule.makes_zones}
    unzoned = _asking([s for s in statements if s.about.rule not in of_zones])
    for some in (asking, unzoned):
        links = list(some)
        found = links_to_drop_for_sums(n, links, _weights(list(some.values()), gives_way), runs, sums)
        if found is not None:
            out, shown = found
            why = f"sum: {', '.join(dict.fromkeys(s.about.rule for s in sums))}{'' if shown else NOT_SHOWN}"
            return [DroppedStatement(order, why) for k in out for order in some[links[k]]]
    return []


def _weights(asking: Sequence[Sequence[Precede]], gives_way: Mapping[str, int]) -> list[int | None]:
    """What each link weighs, by the orders that ask for it: one order more than all orders of weaker rules together.

    None for a link that a rule asks for which never gives way.
    """
    ranks = [[gives_way.get(order.about.rule, 0) for order in orders] for orders in asking]
    counts = Counter(rank for of_link in ranks for rank in of_link)
    price, total = {}, 0
    for rank in sorted(counts, reverse=True):
        price[rank] = total + 1
        total += counts[rank] * price[rank]
    return [None if 0 in of_link else sum(price[rank] for rank in of_link) for of_link in ranks]


def _firmest(orders: Sequence[Precede], gives_way: Mapping[str, int]) -> Precede:
    """Of the orders that ask for one link, the one that gives way last."""
    return min(orders, key=lambda order: gives_way.get(order.about.rule, 0))


def _spoken(order: Precede) -> str:
    first, then = order.about.contours
    return f"{first} before {then} ({order.about.rule})"


def _conflict(cycle: Sequence[Precede], runs: Sequence[Contiguous]) -> RulesConflict:
    """The error for a cycle of orders that must all hold, a sentence each, with the runs that tie them together."""
    sentences = []
    for order, following in zip(cycle, [*cycle[1:], cycle[0]], strict=True):
        sentences.append(order.about.sentence)
        if order.after != following.before:
            sentences += [r.about.sentence for r in runs if {order.after, following.before} <= set(r.contours)]
    return RulesConflict(CONTRADICT, tuple(dict.fromkeys(sentences)))
