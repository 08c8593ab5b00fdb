"""The profile's rules, each judged on the cuts by its own geometry, and what may stand although it breaks one."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from kerfwise.arrays import Ints
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.graphs import EXACT_LINKS, components, contract_pairs, path
from kerfwise.encoder.nest import Ids, Nest
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.active_rules import ActiveRules
from kerfwise.rules.rule import Rule

from .hard_orders import Forcing, HardOrders, ModelOfOrders, applies_to, beside_sums, torch_of_each
from .result import Excused, Judgement, RelaxedStatement, excuse_relaxed

if TYPE_CHECKING:
    from ortools.sat.python.cp_model import CpModel


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
# locks give a position no room for that, or hard sums of orders no way to hold, beside the orders that are kept.
# Which of several orders equally firm is given up is not judged, nor which rule gives way in a tangle of more orders
# than the planner resolves exactly.


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
    found |= _misplaced_orders(orders, pairs, asked, runs)
    return found | beside_sums(orders, pairs, asked, together, holding, found)


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


# Whether contours can be cut at the positions that locks give them: asked of all orders that are known, at once.
#
# What must come before a contour, or after it, is counted first. Where that says nothing, a small model of its own
# answers: every run of contours that are cut in one go is an interval of the order, and no two overlap.

OrderedPair = tuple[str, str]
Node = TypeVar("Node")


class Room(ModelOfOrders[OrderedPair]):
    """Answers whether there is room for contours at the positions `at` (from 1 on), among all `names`.

    `runs` are kept together.

    Examples
    --------
    >>> Room("abc", (), {"c": 2}).none([("a", "c"), ("b", "c")]), Room("abc", (), {"c": 2}).none([("a", "c")])
    (True, False)
    """

    def __init__(self, names: Sequence[str], runs: Sequence[Sequence[str]], at: Mapping[str, int]) -> None:
        super().__init__()
        self._names, self._at = names, at
        self._run_of = {name: (name,) for name in names} | {name: tuple(run) for run in runs for name in run}
        self._runs = list(dict.fromkeys(self._run_of.values()))

    def none(self, orders: Sequence[OrderedPair], more: Sequence[OrderedPair] = ()) -> bool:
        """Whether no order of the names keeps the runs together, all orders (before, after), and the positions.

        What is asked with `more` orders beside the same list as before is answered sooner.
        """
        return self._crowded([*orders, *more]) or self._refuted(orders, more)

    def _crowded(self, orders: Sequence[OrderedPair]) -> bool:
        """Whether more must come before a position, or after it, than there is room for."""
        turned = [(after, before) for before, after in orders]
        return any(
            self._ahead(name, orders) >= position or self._ahead(name, turned) > len(self._names) - position
            for name, position in self._at.items()
        )

    def _ahead(self, name: str, orders: Iterable[OrderedPair]) -> int:
        """How many names the orders put before one."""
        within: dict[str, set[str]] = defaultdict(set)
        between: dict[tuple[str, ...], set[tuple[str, ...]]] = defaultdict(set)
        for before, after in orders:
            one, other = self._run_of[before], self._run_of[after]
            if one == other:
                within[after].add(before)
            else:
                between[other].add(one)
        return len(_reached(within, name)) + sum(map(len, _reached(between, self._run_of[name])))

    def _model(self, orders: Sequence[OrderedPair]) -> CpModel:
        """Where each run begins, then where each name is within its run, from 0 on."""
        from ortools.sat.python.cp_model import CpModel

        model, last = CpModel(), len(self._names) + 1
        begin = {run: model.new_int_var(1, last - len(run), "") for run in self._runs}
        model.add_no_overlap(model.new_fixed_size_interval_var(first, len(run), "") for run, first in begin.items())
        for run, first in begin.items():
            within = {name: model.new_int_var(0, len(run) - 1, "") for name in run}
            model.add_all_different(within.values())
            for name in sorted(self._at.keys() & within.keys()):
                model.add(first + within[name] == self._at[name])
        self._ask(model, orders)
        return model

    def _ask(self, model: CpModel, orders: Sequence[OrderedPair]) -> None:
        """Put orders to a model: of names in one run, or of the runs that they are in."""
        begin = {run: model.get_int_var_from_proto_index(k) for k, run in enumerate(self._runs)}
        names = enumerate((name for run in self._runs for name in run), len(begin))
        within = {name: model.get_int_var_from_proto_index(k) for k, name in names}
        for before, after in orders:
            one, other = self._run_of[before], self._run_of[after]
            if one == other:
                model.add(within[before] < within[after])
            else:
                model.add(begin[one] + len(one) <= begin[other])


def _reached(straight: Mapping[Node, set[Node]], start: Node) -> set[Node]:
    """All that leads to a node, itself left out."""
    seen, waiting = {start}, [start]
    while waiting:
        new = straight.get(waiting.pop(), set()) - seen
        seen |= new
        waiting += new
    return seen - {start}
