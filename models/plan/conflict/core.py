"""A minimal set of statements that cannot all hold: without any one of them the others can."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.budget import Budget

from .at_once import clash_of_orders, exactly
from .group import Group
from .order_model import clash, clash_at_once
from .orders import orders_of
from .shrinking import shrink, without_rules
from .solver import DEFAULT_WORK, NotAnswered
from .suspects import suspects
from .whole_order import whole_order

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
    facts: Facts, groups: Sequence[Group], gives_way: Mapping[str, int], budget: Budget | None = None
) -> Core | None:
    """A minimal contradiction among the groups; None if there is none.

    Orders that contradict each other are seen without a solver and without work, and so is, mostly, that all can hold.
    Else whole rules are left out first, then halves, quarters, …, and at last single groups, those of rules that give
    way first (`gives_way`, the highest first): as far as answers come at once, and then with all the work they need.
    Every question is about the contours of the groups in it only, so that it soon is a small one.

    Raises
    ------
    NotAnswered
        If it was not shown whether all can hold.
    """
    budget = budget or Budget(DEFAULT_WORK)
    said = orders_of(facts, groups)
    if of_orders := clash_of_orders(facts.n, groups, said, gives_way):
        return _firmest(facts, groups, _of_orders(facts, groups, of_orders, budget), gives_way, budget)
    if whole_order(facts, groups, said) is not None:
        return None
    ranked = sorted(groups, key=lambda group: -gives_way.get(group.about.rule, 0))
    if locked := _among(facts, [ranked[k] for k in suspects(facts, ranked)], budget):
        return _firmest(facts, groups, in_order(groups, *locked, soon=True), gives_way, budget)
    at_once = partial(clash_at_once, facts, budget=budget)
    try:
        if at_once(ranked) is None:
            return None
    except NotAnswered:
        shown = False
    else:
        shown = True
        ranked, _ = shrink(without_rules(ranked, gives_way, at_once), at_once)
    try:
        left = clash(facts, ranked, budget)
    except NotAnswered:
        if not shown:
            raise
        return in_order(groups, ranked, minimal=False)
    if left is None:
        return None
    core, minimal = shrink([ranked[k] for k in left], partial(clash, facts, budget=budget))
    return in_order(groups, core, minimal)


def _of_orders(facts: Facts, groups: Sequence[Group], clashing: list[Group], budget: Budget) -> Core:
    """The core among groups whose orders clash, none of which the orders can do without."""
    minimal = True
    if not exactly(orders_of(facts, clashing)):
        clashing, minimal = shrink(clashing, partial(clash, facts, budget=budget))
    return in_order(groups, clashing, minimal, soon=True)


def _firmest(facts: Facts, groups: Sequence[Group], core: Core, gives_way: Mapping[str, int], budget: Budget) -> Core:
    """The core, or one without what gives way first in it, where little work shows one that is minimal."""
    most = max(gives_way.get(group.about.rule, 0) for group in core.groups)
    had = budget.left
    if not most or had <= 0:
        return core
    firmer = [group for group in groups if gives_way.get(group.about.rule, 0) < most]
    part = budget.part(min(1.0, FIRM / had))
    left = part.left
    try:
        found = find_core(facts, firmer, gives_way, part)
    except NotAnswered:
        return core
    finally:
        budget.spend(left - part.left)
    return found if found is not None and found.minimal else core


def _among(facts: Facts, suspected: list[Group], budget: Budget) -> tuple[list[Group], bool] | None:
    """A contradiction among a few groups, and whether it is minimal; None where none is shown."""
    try:
        left = clash(facts, suspected, budget)
    except NotAnswered:
        return None
    return None if left is None else shrink([suspected[k] for k in left], partial(clash, facts, budget=budget))


def in_order(groups: Sequence[Group], core: Sequence[Group], minimal: bool, soon: bool = False) -> Core:
    """The core with its groups as they stand among all."""
    place = {group.about: k for k, group in enumerate(groups)}
    return Core(tuple(sorted(core, key=lambda group: place[group.about])), minimal, soon)
