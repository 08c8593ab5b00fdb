"""What must give way so that the rest can hold, at the least cost."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ortools.sat.python.cp_model import OPTIMAL, CpModel

from kerfwise.models.engines.budget import Budget
from kerfwise.rules.rule import Rule
from kerfwise.rules.statements import RELAXED_MM, About, Statement

from .core import Core
from .group import Group
from .solver import DEFAULT_WORK, NotAnswered, solver_within
from .suspects import LAST

WORK = 20.0
"""CP-SAT's deterministic seconds for one choice of the lightest groups."""
MOST_ASKED = 12_000
"""How many groups are asked about in all: each contradiction that is looked for asks about every group once."""
SOON = 0.01
"""What asking about a group counts for where a contradiction was found soon."""


@dataclass(frozen=True, slots=True)
class Relaxation:
    """Groups that give way; no fewer would do. `clashes` are what of every contradiction found may give way."""

    groups: tuple[Group, ...]
    clashes: tuple[frozenset[About], ...] = ()


def find_relaxation(
    groups: Sequence[Group],
    book: Mapping[str, Rule[Any]],
    core_of: Callable[[Sequence[Group]], Core | None],
    budget: Budget | None = None,
    known: Iterable[Sequence[int]] = (),
) -> Relaxation | None:
    """The fewest groups without which the others can hold; None if no rule that may be soft helps.

    `core_of` finds a contradiction among groups, None where there is none; `known` are some, by numbers of groups.

    Each counts the same, as in the objective of the plan that is made then; what is relaxed last, such as locks, weighs
    more than everything else together. Found by implicit hitting sets (Davies and Bacchus 2011): contradictions are
    gathered, the fewest groups that hit each of them taken out, until no contradiction is left.

    Raises
    ------
    NotAnswered
        If no answer was found within the work, or the time, allowed.
    """
    budget = budget or Budget(DEFAULT_WORK)
    weights = _weights(groups, book)
    clashes = [[k for k in clash if weights[k] is not None] for clash in known]
    if not all(clashes):
        return None
    asked = 0.0
    while True:
        out = _lightest(clashes, weights, budget)
        left = [k for k in range(len(groups)) if k not in out]
        whole = True
        if asked > MOST_ASKED:
            raise NotAnswered
        while (core := core_of([groups[k] for k in left])) is not None:
            named = {group.about for group in core.groups}
            soft = [k for k in left if groups[k].about in named and weights[k] is not None]
            if not soft:
                return None
            if budget.timed and budget.left <= 0:
                raise NotAnswered  # a contradiction that is shown without a solver takes time as well
            clashes.append(soft)
            asked += len(groups) * (SOON if core.soon else 1.0)
            left = [k for k in left if k not in soft]
            whole = False
        if whole:
            hit = tuple(frozenset(groups[k].about for k in clash) for clash in clashes)
            return Relaxation(tuple(groups[k] for k in sorted(out)), hit)


def may_give_way(rule: Rule[Any]) -> bool:
    """Whether single statements of a rule, hard as they are, may be relaxed."""
    return not rule.of_fallen_metal and ("soft" in rule.strengths or rule.relaxable)


def _lightest(clashes: Sequence[Sequence[int]], weights: Sequence[int | None], budget: Budget) -> set[int]:
    """The groups of least total weight that hit every clash."""
    model = CpModel()
    taken = {k: model.new_bool_var("") for clash in clashes for k in clash}
    for clash in clashes:
        model.add_bool_or(taken[k] for k in clash)
    model.minimize(sum((weights[k] or 0) * literal for k, literal in taken.items()))
    solver = solver_within(budget, WORK)
    status = solver.solve(model)
    budget.spend(solver.response_proto.deterministic_time)
    if status != OPTIMAL:
        raise NotAnswered
    return {k for k, literal in taken.items() if solver.boolean_value(literal)}


def _weights(groups: Sequence[Group], book: Mapping[str, Rule[Any]]) -> list[int | None]:
    """What relaxing each group costs; None where it may not be."""
    weights: list[int | None] = []
    for group in groups:
        rule = book.get(group.about.rule)  # what is of no rule, such as which ways common cuts leave, stays
        weights.append(1 if rule is not None and may_give_way(rule) else None)
    heavy = 1 + sum(w for w in weights if w is not None)
    return [heavy if group.about.rule in LAST else w for group, w in zip(groups, weights, strict=True)]


def soften(statements: Iterable[Statement], relaxed: Iterable[About]) -> list[Statement]:
    """The statements, those about which `relaxed` speaks at a price that no plan pays without need."""
    abouts = set(relaxed)
    return [replace(s, weight=RELAXED_MM) if s.weight is None and s.about in abouts else s for s in statements]
