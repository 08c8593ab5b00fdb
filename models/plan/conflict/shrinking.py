"""Groups that cannot all hold made fewer, by asking again and again whether what is left still cannot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from .group import Group
from .solver import NotAnswered

Clash = Callable[[Sequence[Group]], list[int] | None]
"""Numbers of groups that cannot all hold, None if all can; raises NotAnswered where neither is shown."""


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
