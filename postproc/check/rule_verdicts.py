"""The profile's rules, each judged on the cuts by its own geometry, and what may stand although it breaks one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from kerfwise.arrays import Ints
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.graphs import EXACT_LINKS, components, contract_pairs, path
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.active_rules import ActiveRules
from kerfwise.rules.rule import Rule

from .order_rules import Forcing, HardOrders, Room, applies_to, torch_of_each
from .result import Excused, Judgement, RelaxedStatement, excuse_relaxed


def judge(
    nest: Nest, cuts: CutSequence, profile: ActiveRules, relaxed: Sequence[RelaxedStatement] = ()
) -> list[Judgement]:
    """A judgement on every rule, the hard ones first; those that the profile switches off are listed last, unjudged.

    `relaxed` are statements that the plan or program says are relaxed. Cuts that were made before a stop are facts,
    and not judged.
    """
    settings, book, torches = profile.settings(), profile.rulebook(), torch_of_each(cuts)
    judged = [
        Judgement(
            name,
            setting.strength,
            book[name].sentence,
            tuple(
                v
                for v in book[name].violations(nest, cuts, setting.options)
                if book[name].still_counts(v, cuts.made) and applies_to(book[name], v.contours, torches)
            ),
            unjudged=book[name].unjudged(nest, cuts, setting.options),
            must_be_judged=book[name].must_be_judged and setting.strength == "hard",
        )
        for name, setting in sorted(settings.items(), key=lambda item: (item[1].strength != "hard", item[0]))
    ]
    off = [Judgement(name, "off", rule.sentence) for name, rule in sorted(book.items()) if name not in settings]
    return [*excuse_relaxed(nest, cuts, profile, excuse(nest, cuts, profile, judged), relaxed), *off]


def about_nothing(nest: Nest, cuts: CutSequence, profile: ActiveRules) -> list[str]:
    """A warning for each rule that is on and selects nothing of this nest: a layer may be called otherwise here."""
    book = profile.rulebook()
    found = (
        (name, book[name].selects_nothing(nest, cuts, setting.options)) for name, setting in profile.settings().items()
    )
    return [f"rule {name} has nothing to say here: {why}" for name, why in found if why is not None]


# What may stand although it breaks a hard rule: where the rule itself says so, and where order rules contradict.
#
# Level-ahead and hull-before can ask for cycles (two hooks that interlock), so that some of their orders must be
# broken. An order "a before b" is excused only if the orders that the plan does keep, of rules that give way no
# sooner, lead from b to a: then keeping it as well would have broken another of them; or if it leaves contours that
# locks give a position no room for that, beside the orders that are kept. Which of several orders equally firm is
# given up is not judged, nor which rule gives way in a tangle of more orders than the planner resolves exactly.


def excuse(nest: Nest, cuts: CutSequence, profile: ActiveRules, judged: Sequence[Judgement]) -> list[Judgement]:
    """The judgements, with violations moved to the excused where their rule, or the others, leave no choice."""
    book = profile.rulebook()
    orders = HardOrders(nest, cuts, profile)
    forced = Forcing(orders)
    judged = [_by_itself(nest, cuts, profile, judgement, forced) for judgement in judged]
    if not any(_yields(judgement, book) for judgement in judged):
        return list(judged)
    why = _contradictions(orders, {j.id for j in judged if j.strength == "hard" and j.holds})
    return [_excused(judgement, why) if _yields(judgement, book) else judgement for judgement in judged]


def _by_itself(nest: Nest, cuts: CutSequence, profile: ActiveRules, judgement: Judgement, forced: Forcing) -> Judgement:
    """The judgement of a hard rule, with what the rule itself excuses."""
    if judgement.strength != "hard" or not judgement.violations:
        return judgement
    rule, options = profile.rulebook()[judgement.id], profile.settings()[judgement.id].options
    why = [(violation, rule.excuse(nest, cuts, options, violation, forced)) for violation in judgement.violations]
    return replace(
        judgement,
        violations=tuple(violation for violation, reason in why if reason is None),
        excused=(*judgement.excused, *(Excused(violation, reason) for violation, reason in why if reason is not None)),
    )


def _yields(judgement: Judgement, book: Mapping[str, Rule[Any]]) -> bool:
    return judgement.strength == "hard" and bool(judgement.violations) and book[judgement.id].gives_way > 0


def _excused(judgement: Judgement, why: dict[Ids, str]) -> Judgement:
    violations: list[Violation] = []
    excused = list(judgement.excused)
    for violation in judgement.violations:
        reason = _reason(violation, why)
        if reason is not None:
            excused.append(Excused(violation, reason, "dropped"))
        else:
            violations.append(violation)
    return replace(judgement, violations=tuple(violations), excused=tuple(excused))


def _reason(violation: Violation, why: Mapping[Ids, str]) -> str | None:
    """Why an order may be broken; of what is no order of two contours, nothing is known."""
    if len(violation.contours) != 2:
        return None
    first, then = violation.contours
    return why.get((first, then))


def _contradictions(orders: HardOrders, holding: set[str]) -> dict[Ids, str]:
    """Every broken order that the kept ones contradict, with the kept orders that do so."""
    names, hard, book = orders.names, orders.hard, orders.profile.rulebook()
    pairs, asked = orders.of_cut()
    runs = [
        run for name in sorted(hard.keys() & holding) for run in book[name].together(orders.nest, hard[name].options)
    ]
    number = {name: k for k, name in enumerate(orders.cuts.positions())}
    together = [[number[name] for name in run if name in number] for run in runs]
    links = contract_pairs(len(number), pairs, together)
    kept_orders = orders.at[pairs[:, 0]] < orders.at[pairs[:, 1]]
    found: dict[Ids, str] = {}
    for component in components(links):
        around = links[component].tolist()
        kept = [k for k, in_turn in enumerate(kept_orders[component].tolist()) if in_turn]
        told = [(names[a], names[b]) for a, b in pairs[component].tolist()]
        for k in sorted(set(range(len(component))) - set(kept)):
            softest = book[asked[component[k]]].gives_way if len(component) <= EXACT_LINKS else math.inf
            firm = [m for m in kept if book[asked[component[m]]].gives_way <= softest]
            before, after = around[k]
            against = path(around, firm, after, before)
            if against:
                round_by = ", ".join(f"{' before '.join(told[m])} ({asked[component[m]]})" for m in against)
                found[told[k]] = f"the order rules contradict each other here: {round_by}"
    return found | _misplaced_orders(orders, pairs, asked, runs)


def _misplaced_orders(
    orders: HardOrders, pairs: Ints, asked_by: Sequence[str], runs: Sequence[Sequence[str]]
) -> dict[Ids, str]:
    """Every broken order that leaves locks no room for the positions they give, beside the orders that are kept."""
    at, profile = orders.cuts.positions(), orders.profile
    book, names = profile.rulebook(), orders.names
    ends = {"first": 1, "last": len(at)}
    places = {
        lock.contour: lock.position if isinstance(lock.position, int) else ends[lock.position]
        for lock in profile.locks
        if lock.contour in at and lock.position is not None
    }
    if not places or any(at[name] != place for name, place in places.items()):
        return {}
    rule_of_pair = {(names[a], names[b]): rule for (a, b), rule in zip(pairs.tolist(), asked_by, strict=True)}
    kept = [pair for pair in rule_of_pair if at[pair[0]] < at[pair[1]]]
    places_text = ", ".join(f"{name} at position {place}" for name, place in sorted(places.items(), key=lambda p: p[1]))
    found, room = {}, Room(list(at), runs, places)
    firm_by: dict[int, list[Ids]] = {}
    for pair, rule in rule_of_pair.items():
        softest = book[rule].gives_way
        if softest and at[pair[0]] > at[pair[1]]:
            if softest not in firm_by:
                firm_by[softest] = [k for k in kept if book[rule_of_pair[k]].gives_way <= softest]
            if room.none(firm_by[softest], [pair]):
                found[pair] = f"locks leave no room for this order: {places_text}"
    return found
