"""Whether statements can all hold: a small CP-SAT model of the order and the candidates, no travel in it.

Contours that no statement speaks of are left out: they can come last. Only a lag counts them, as what may lie between.
What moves cross, and seconds, are not asked here (`whole` asks them): a clash found without them is one all the same.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import assert_never

from ortools.sat.python.cp_model import FEASIBLE, INFEASIBLE, OPTIMAL, CpModel, IntVar, LiteralT

from kerfwise.encoder.facts.facts import Facts
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.statements import AtLeast, Before, Contiguous, Crossing, Forbid, Lag, NoGood, Precede

from .group import Asked, Group, contours_of
from .purse import WORK_A_STATEMENT, NotAnswered, Purse

WORK = 20.0
"""CP-SAT's deterministic seconds for one question; past them it counts as not answered."""
QUICK = 0.1
"""The same for a question whose answer is welcome only if it comes at once."""


@dataclass(frozen=True, eq=False, slots=True)
class OrderModel:
    """`position` of the contours that matter, `pick` of their candidates, `holds[k]`: all of group k holds."""

    facts: Facts
    model: CpModel = field(default_factory=CpModel)
    position: dict[int, IntVar] = field(default_factory=dict)
    pick: dict[int, IntVar] = field(default_factory=dict)
    order: dict[tuple[int, int], LiteralT] = field(default_factory=dict)
    holds: list[IntVar] = field(default_factory=list)

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


def build(facts: Facts, groups: Sequence[Group]) -> OrderModel:
    """The model in which each group may be switched on by its literal in `holds`."""
    contour_of = [c.contour for c in facts.candidates]
    mentioned = sorted({k for group in groups for k in contours_of(group, contour_of)})
    lags = bool(by_kind(s for group in groups for s in group.statements).lag)
    if not lags:
        loose = _loose(groups)
        mentioned = [k for k in mentioned if k not in loose]
    places = facts.n if lags else len(mentioned)
    built = OrderModel(facts)
    built.position.update((k, built.model.new_int_var(0, places - 1, "")) for k in mentioned)
    built.model.add_all_different(built.position.values())
    for group in groups:
        holds = built.model.new_bool_var("")
        built.holds.append(holds)
        for statement in group.statements:
            _ask(built, statement, holds)
    return built


def _loose(groups: Sequence[Group]) -> set[int]:
    """Contours only asked to come before or after one other: first or last of all, they are in no one's way."""
    partners: dict[int, set[int]] = defaultdict(set)
    firm: set[int] = set()
    for s in (s for group in groups for s in group.statements):
        match s:
            case AtLeast():
                for literal in s.literals:
                    if isinstance(literal, Before):
                        partners[literal.i].add(literal.j)
                        partners[literal.j].add(literal.i)
            case Precede(i, j) | Lag(i, j):
                firm |= {i, j}
            case Contiguous(contours):
                firm |= set(contours)
            case NoGood(out, left):
                firm |= out | left
            case Forbid() | Crossing():
                pass  # neither speaks of a contour's place
            case _:
                assert_never(s)
    loose = {k for k, of in partners.items() if k not in firm and len(of) == 1 and k not in of}
    return {k for k in loose if not partners[k] & loose}


def _ask(built: OrderModel, statement: Asked, holds: IntVar) -> None:
    """The statement, wherever its group is switched on."""
    model, at = built.model, built.position
    match statement:
        case Precede(i, j):
            model.add(at[i] < at[j]).only_enforce_if(holds)
        case Forbid(c):
            model.add_implication(holds, built.candidate(c).negated())
        case AtLeast():
            literals = [
                built.before(lit.i, lit.j) if isinstance(lit, Before) else built.candidate(lit.c)
                for lit in statement.literals
            ]
            total = sum(weight * literal for weight, literal in zip(statement.weights, literals, strict=True))
            given = [holds] if statement.when is None else [holds, built.candidate(statement.when)]
            if literals:
                model.add(total >= statement.bound).only_enforce_if(given)
            elif statement.bound > 0:
                model.add_bool_or(literal.negated() for literal in given)
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
        case Crossing():
            pass  # `whole` asks it
        case _:
            assert_never(statement)


def clash(facts: Facts, groups: Sequence[Group], purse: Purse) -> list[int] | None:
    """Numbers of groups that cannot all hold, not yet the fewest; None if all can.

    Raises
    ------
    NotAnswered
        If neither was shown within `WORK`, or nothing is left in the purse.
    """
    if not groups:
        return None
    built = _built(facts, groups, purse)
    built.model.add_assumptions(built.holds)
    solver = purse.solver(WORK)
    status = solver.solve(built.model)
    purse.spend(solver.response_proto.deterministic_time)
    if status in (OPTIMAL, FEASIBLE):
        return None
    if status != INFEASIBLE:
        raise NotAnswered
    named = set(solver.sufficient_assumptions_for_infeasibility())
    return [k for k, holds in enumerate(built.holds) if holds.index in named]


def clash_at_once(facts: Facts, groups: Sequence[Group], purse: Purse) -> list[int] | None:
    """All the groups by number if it takes next to nothing to see that they cannot all hold; else None.

    With every group fixed, presolve sees most contradictions, which is much faster than asking which groups they need.
    """
    if not groups:
        return None
    built = _built(facts, groups, purse)
    for holds in built.holds:
        built.model.add(holds == 1)
    solver = purse.solver(QUICK)
    status = solver.solve(built.model)
    purse.spend(solver.response_proto.deterministic_time)
    return list(range(len(groups))) if status == INFEASIBLE else None


def _built(facts: Facts, groups: Sequence[Group], purse: Purse) -> OrderModel:
    """The model, as long as anything is left to ask it with."""
    if purse.left <= 0:
        raise NotAnswered
    purse.spend(WORK_A_STATEMENT * sum(len(group.statements) for group in groups))
    return build(facts, groups)
