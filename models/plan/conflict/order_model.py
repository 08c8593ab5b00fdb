"""Whether statements can all hold: a small CP-SAT model of the order and the candidates, no travel in it.

Contours that no statement is about are left out: they can come last. Only a lag counts them, as what may lie between,
and steps and a place in the order.
What moves cross, and seconds, are not asked here (`whole` asks them): a clash found without them is one all the same.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import assert_never

from ortools.sat.python.cp_model import (
    FEASIBLE,
    INFEASIBLE,
    OPTIMAL,
    UNKNOWN,
    CpModel,
    CpSolverStatus,
    IntVar,
    LiteralT,
)

from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.cpsat.variables import in_domain
from kerfwise.models.engines.deadline import Deadline
from kerfwise.rules.statements import (
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Enough,
    Forbid,
    Lag,
    Literal,
    Move,
    NoGood,
    Pick,
    Precede,
    Steps,
    by_kind,
    contours_named,
    plain,
)
from kerfwise.rules.stating.feasible_order import ends_of, likely_order

from .groups import WORK_PER_STATEMENT, CanClash, Group, NotAnswered, NothingLeft, contours_of, solver_within

WORK = 20.0
"""CP-SAT's deterministic seconds for one question; past them it counts as not answered."""
QUICK = 0.1
"""The same for a question whose answer is welcome only if it comes at once."""


@dataclass(frozen=True, eq=False, slots=True)
class OrderModel:
    """`position` of the contours that matter, `pick` of their candidates, `holds[k]`: all of group k holds.

    `ends` are statements about a place, as `_ends` finds them.
    """

    facts: Facts
    model: CpModel = field(default_factory=CpModel)
    position: dict[int, IntVar] = field(default_factory=dict)
    pick: dict[int, IntVar] = field(default_factory=dict)
    order: dict[tuple[int, int], LiteralT] = field(default_factory=dict)
    steps: dict[tuple[int, int, int, int], LiteralT] = field(default_factory=dict)
    holds: list[IntVar] = field(default_factory=list)
    ends: dict[int, tuple[int, bool]] = field(default_factory=dict)

    def before(self, i: int, j: int) -> LiteralT:
        """Literal: contour i is cut before contour j."""
        if i == j:
            return False
        if (i, j) not in self.order:
            literal = self.model.new_bool_var("")
            if not (i in self.position and j in self.position):
                self.order[i, j], self.order[j, i] = literal, literal.negated()
                return literal
            self.model.add(self.position[i] < self.position[j]).only_enforce_if(literal)
            self.model.add(self.position[j] < self.position[i]).only_enforce_if(literal.negated())
            self.order[i, j], self.order[j, i] = literal, literal.negated()
        return self.order[i, j]

    def candidate(self, c: int) -> IntVar:
        """Literal: candidate c is used."""
        if c not in self.pick:
            span = self.facts.candidates_of(self.facts.candidates[c].contour)
            self.pick.update((k, self.model.new_bool_var("")) for k in span)
            self.model.add_exactly_one(self.pick[k] for k in span)
        return self.pick[c]

    def cut_by(self, contour: int, some: frozenset[int] | None) -> list[IntVar] | None:
        """Literal: some of these candidates is used for the contour; none where all are, None where it has none."""
        if some is None:
            return []
        own = [self.candidate(c) for c in self.facts.candidates_of(contour) if c in some]
        if not own:
            return None
        literal = self.model.new_bool_var("")
        self.model.add(sum(own) == literal)
        return [literal]


def build_order_model(facts: Facts, groups: Sequence[Group]) -> OrderModel:
    """The model in which each group may be switched on by its literal in `holds`."""
    contour_of = [c.contour for c in facts.candidates]
    ends = _ends(groups, facts.n)
    rest = [replace(group, statements=tuple(s for s in group.statements if id(s) not in ends)) for group in groups]
    mentioned = {k for group in rest for k in contours_of(group, contour_of)} | {k for k, _ in ends.values()}
    kinds = by_kind(s for group in groups for s in group.statements)
    steps = any(isinstance(literal, Steps) for s in kinds.at_least for literal in plain(s.literals))
    counts_all = bool(ends or kinds.lag or kinds.move or steps)
    if not counts_all:
        mentioned -= _loose(groups)
    places = facts.n if counts_all else len(mentioned)
    built = OrderModel(facts, ends=ends)
    built.position.update((k, built.model.new_int_var(0, places - 1, "")) for k in sorted(mentioned))
    built.model.add_all_different(built.position.values())
    for group in groups:
        holds = built.model.new_bool_var("")
        built.holds.append(holds)
        for statement in group.statements:
            _ask(built, statement, holds)
    return built


def _ends(groups: Sequence[Group], n: int) -> dict[int, tuple[int, bool]]:
    """Of statements (by `id`) that say how many come before or after one contour, this contour, and whether before."""
    ends = {id(s): ends_of(s, n) for s in by_kind(s for group in groups for s in group.statements).at_least}
    return {key: found[0] for key, found in ends.items() if found}


def _loose(groups: Sequence[Group]) -> set[int]:
    """Contours only asked to come before or after one other: first or last of all, they are in no one's way."""
    partners: dict[int, set[int]] = defaultdict(set)
    firm: set[int] = set()
    kinds = by_kind(s for group in groups for s in group.statements)
    for s in kinds.at_least:
        for literal in s.literals:
            if isinstance(literal, Enough):
                firm |= {k for lit in plain([literal]) if not isinstance(lit, Pick) for k in (lit.i, lit.j)}
            elif isinstance(literal, Before):
                partners[literal.i].add(literal.j)
                partners[literal.j].add(literal.i)
    aside = {id(s) for s in (*kinds.at_least, *kinds.crossing)}  # a move over a part is not about its place
    for group in groups:
        for statement in group.statements:
            firm |= set() if id(statement) in aside else set(contours_named(statement))
    loose = {k for k, of in partners.items() if k not in firm and len(of) == 1 and k not in of}
    return {k for k in loose if not partners[k] & loose}


def _literal(built: OrderModel, literal: Literal) -> LiteralT:
    """The literal in the model; of a condition in another, a variable that holds if and only if that does."""
    match literal:
        case Before(i, j):
            return built.before(i, j)
        case Steps(i, j, least, most):
            key = (i, j, least, most)
            if key not in built.steps:
                built.steps[key] = in_domain(built.model, built.position[j] - built.position[i], least, most)
            return built.steps[key]
        case Pick(c):
            return built.candidate(c)
        case Enough(within, weights, bound):
            holds = built.model.new_bool_var("")
            total = sum(w * _literal(built, lit) for w, lit in zip(weights, within, strict=True))
            built.model.add(total >= bound).only_enforce_if(holds)
            built.model.add(total < bound).only_enforce_if(holds.negated())
            return holds
        case _:
            assert_never(literal)


def _ask(built: OrderModel, statement: CanClash, holds: IntVar) -> None:
    """The statement, wherever its group is switched on."""
    model, at = built.model, built.position
    match statement:
        case Precede(i, j):
            model.add(at[i] < at[j]).only_enforce_if(holds)
        case Forbid(c):
            model.add_implication(holds, built.candidate(c).negated())
        case AtLeast() if id(statement) in built.ends:  # a place is one variable, however many contours there are
            contour, early = built.ends[id(statement)]
            if early:
                model.add(at[contour] >= statement.bound).only_enforce_if(holds)
            else:
                model.add(at[contour] <= built.facts.n - 1 - statement.bound).only_enforce_if(holds)
        case AtLeast():
            literals = [_literal(built, lit) for lit in statement.literals]
            total = sum(weight * literal for weight, literal in zip(statement.weights, literals, strict=True))
            premise = [holds] if statement.when is None else [holds, built.candidate(statement.when)]
            if literals:
                model.add(total >= statement.bound).only_enforce_if(premise)
            elif statement.bound > 0:
                model.add_bool_or(literal.negated() for literal in premise)
        case Contiguous(contours):
            for i in contours:
                for j in contours:
                    if i != j:
                        model.add(at[i] - at[j] < len(contours)).only_enforce_if(holds)
        case Lag(i, j):
            first = built.before(i, j)
            for literal, one, other in ((first, i, j), (built.before(j, i), j, i)):
                model.add(at[other] - at[one] > statement.cuts).only_enforce_if(holds, literal)
        case NoGood(out, left):
            model.add_bool_or(*(built.before(b, a) for a in sorted(out) for b in sorted(left)), holds.negated())
        case Move():
            for i, j in product(statement.leave, statement.reach):
                ways = built.cut_by(i, statement.leaving), built.cut_by(j, statement.reaching)
                if i != j and ways[0] is not None and ways[1] is not None:
                    model.add(at[j] != at[i] + 1).only_enforce_if([holds, *ways[0], *ways[1]])
        case Crossing():
            pass  # `whole` asks it
        case _:
            assert_never(statement)


def clash(facts: Facts, groups: Sequence[Group], deadline: Deadline) -> list[int] | None:
    """Numbers of groups that cannot all hold, not yet the fewest; None if all can.

    Raises NotAnswered if neither was shown within `WORK`, or the deadline is reached.
    """
    if not groups:
        return None
    built = _built(facts, groups, deadline)
    built.model.add_assumptions(built.holds)
    solver = solver_within(deadline, WORK)
    status = solver.solve(built.model)
    deadline.spend(solver.response_proto.deterministic_time)
    if status in (OPTIMAL, FEASIBLE):
        return None
    if status != INFEASIBLE:
        raise NotAnswered
    named = set(solver.sufficient_assumptions_for_infeasibility())
    return [k for k, holds in enumerate(built.holds) if holds.index in named]


def clash_at_once(facts: Facts, groups: Sequence[Group], deadline: Deadline) -> list[int] | None:
    """All the groups by number if they cannot all hold, None if they can, where it takes next to nothing to see which.

    With every group fixed, presolve sees most contradictions, which is much faster than asking which groups they need.
    Where there is none, an order that keeps everything is mostly found without it, before presolve would have ended.
    Raises NotAnswered if neither is seen at once, or the deadline is reached.
    """
    if not groups:
        return None
    for presolve in (False, True):
        answer = _answer(facts, groups, deadline, presolve)
        if answer != UNKNOWN:
            return list(range(len(groups))) if answer == INFEASIBLE else None
    raise NotAnswered


def fewest_out(
    facts: Facts, groups: Sequence[Group], weights: Sequence[int | None], deadline: Deadline, share: float = 1.0
) -> tuple[list[int], bool] | None:
    """Groups, by number, without which the others can hold, of little weight, and whether none weigh less.

    None if there are none; a group without a weight stays. It takes no more than a share of what is left. Raises
    NotAnswered where nothing was shown.
    """
    built = _built(facts, groups, deadline)
    built.model.add_bool_and(holds for holds, weight in zip(built.holds, weights, strict=True) if weight is None)
    _hint(built, groups)
    built.model.minimize(sum((weight or 0) * (1 - holds) for holds, weight in zip(built.holds, weights, strict=True)))
    solver = solver_within(deadline.part(share), WORK)
    status = solver.solve(built.model)
    deadline.spend(solver.response_proto.deterministic_time)
    if status == INFEASIBLE:
        return None
    if status not in (OPTIMAL, FEASIBLE):
        raise NotAnswered
    return [k for k, holds in enumerate(built.holds) if not solver.boolean_value(holds)], status == OPTIMAL


def _answer(facts: Facts, groups: Sequence[Group], deadline: Deadline, presolve: bool) -> CpSolverStatus:
    """Whether all can hold, as far as next to no work tells."""
    built = _built(facts, groups, deadline)
    for holds in built.holds:
        built.model.add(holds == 1)
    _hint(built, groups)
    solver = solver_within(deadline, QUICK)
    solver.parameters.cp_model_presolve = presolve
    status = solver.solve(built.model)
    deadline.spend(solver.response_proto.deterministic_time)
    return status


def _hint(built: OrderModel, groups: Sequence[Group]) -> None:
    """Has an order tried first that keeps what is asked of places and of what comes before what."""
    whole = range(built.facts.n) if built.ends else sorted(built.position)
    number = {contour: k for k, contour in enumerate(whole)}
    kinds = by_kind(s for group in groups for s in group.statements)
    orders = [(number[s.before], number[s.after]) for s in kinds.precede]
    earliest: dict[int, int] = {}
    latest: dict[int, int] = {}
    for s in kinds.at_least:
        if id(s) in built.ends:
            contour, early = built.ends[id(s)]
            k = number[contour]
            if early:
                earliest[k] = max(earliest.get(k, 0), s.bound)
            else:
                latest[k] = min(latest.get(k, built.facts.n - 1), built.facts.n - 1 - s.bound)
    if places := likely_order(len(number), orders, earliest, latest):
        for contour, position in built.position.items():
            built.model.add_hint(position, places[number[contour]])


def _built(facts: Facts, groups: Sequence[Group], deadline: Deadline) -> OrderModel:
    """The model, as long as anything is left to ask it with."""
    if deadline.left <= 0:
        raise NothingLeft
    deadline.spend(WORK_PER_STATEMENT * sum(len(group.statements) for group in groups))
    return build_order_model(facts, groups)
