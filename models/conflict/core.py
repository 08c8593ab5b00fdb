"""A minimal set of statements that cannot all hold: without any one of them the others can."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ...encoder.facts.facts import Facts
from .group import Group
from .order_model import NotAnswered, clash


@dataclass(frozen=True, slots=True)
class Core:
    """Groups that contradict each other; `minimal` unless a question about them was too hard to answer."""

    groups: tuple[Group, ...]
    minimal: bool


def find_core(facts: Facts, groups: Sequence[Group], gives_way: Mapping[str, int]) -> Core | None:
    """A minimal contradiction among the groups; None if there is none.

    Found by CP-SAT, then by leaving out halves, quarters, …, and at last single groups, those of rules that give way
    first (`gives_way`, the highest first). Every question is about the contours of the groups in it only, so that it
    soon is a small one.

    Raises
    ------
    NotAnswered
        If it was not shown whether all can hold.
    """
    ranked = sorted(groups, key=lambda group: -gives_way.get(group.about.rule, 0))
    left = clash(facts, ranked)
    if left is None:
        return None
    core, minimal = [ranked[k] for k in left], True
    size = max(1, len(core) // 2)
    while True:
        k = 0
        while k < len(core):
            try:
                left = clash(facts, core[:k] + core[k + size :])
            except NotAnswered:
                left, minimal = None, minimal and size > 1
            if left is None:
                k += size
                continue
            kept = [m if m < k else m + size for m in left]
            k = sum(m < k for m in kept)
            core = [core[m] for m in kept]
        if size == 1:
            break
        size //= 2
    place = {group.about: k for k, group in enumerate(groups)}
    return Core(tuple(sorted(core, key=lambda group: place[group.about])), minimal)
