"""A minimal set of statements that cannot all hold: without any one of them the others can."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.budget import Budget

from .group import Group
from .order_model import clash, clash_at_once
from .solver import DEFAULT_WORK, NotAnswered

Clash = Callable[[Sequence[Group]], list[int] | None]
"""Numbers of groups that cannot all hold, None if all can; raises NotAnswered where neither is shown."""


@dataclass(frozen=True, slots=True)
class Core:
    """Groups that contradict each other; `minimal` unless a question about them was too hard to answer."""

    groups: tuple[Group, ...]
    minimal: bool


def find_core(
    facts: Facts, groups: Sequence[Group], gives_way: Mapping[str, int], budget: Budget | None = None
) -> Core | None:
    """A minimal contradiction among the groups; None if there is none.

    Whole rules are left out first, then halves, quarters, …, and at last single groups, those of rules that give way
    first (`gives_way`, the highest first): as far as answers come at once, and then with all the work they need. Every
    question is about the contours of the groups in it only, so that it soon is a small one.

    Raises
    ------
    NotAnswered
        If it was not shown whether all can hold.
    """
    budget = budget or Budget(DEFAULT_WORK)
    ranked = sorted(groups, key=lambda group: -gives_way.get(group.about.rule, 0))
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


def without_rules(core: list[Group], gives_way: Mapping[str, int], clash: Clash) -> list[Group]:
    """Groups that clash still, without those of every rule that has no part in it, as far as could be answered.

    Rules that give way are left out first, then those that come last among all: what is said of a conflict should be
    firm.
    """
    rules = dict.fromkeys(group.about.rule for group in reversed(core))
    for rule in sorted(rules, key=lambda rule: -gives_way.get(rule, 0)):
        without = [group for group in core if group.about.rule != rule]
        try:
            if clash(without) is not None:
                core = without
        except NotAnswered:
            continue  # shrinking asks again, of less at a time
    return core


def shrink(core: list[Group], clash: Clash) -> tuple[list[Group], bool]:
    """Groups out of `core` that clash still, and whether none of them can be left out, as far as could be answered."""
    minimal = True
    size = max(1, len(core) // 2)
    while True:
        k = 0
        while k < len(core):
            try:
                left = clash(core[:k] + core[k + size :])
            except NotAnswered:
                left, minimal = None, minimal and size > 1
            if left is None:
                k += size
                continue
            kept = [m if m < k else m + size for m in left]
            k = sum(m < k for m in kept)
            core = [core[m] for m in kept]
        if size == 1:
            return core, minimal
        size //= 2


def in_order(groups: Sequence[Group], core: Sequence[Group], minimal: bool) -> Core:
    """The core with its groups as they stand among all."""
    place = {group.about: k for k, group in enumerate(groups)}
    return Core(tuple(sorted(core, key=lambda group: place[group.about])), minimal)
