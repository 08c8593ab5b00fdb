"""Which hard rules a route could not keep where: what the plan lists as its excuses."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from ..encoder.facts.facts import Facts
from ..rules.state import Stated
from ..rules.statements import EXEMPTION_MM, AtLeast
from .conditions import of_at_least


def excused(facts: Facts, stated: Stated, route: Sequence[int]) -> dict[str, tuple[str, ...]]:
    """Contour id → ids of the rules that are excused there; `route` are candidates in cutting order.

    That is where the route breaks a statement that weighs EXEMPTION_MM, and where a rule is exempt in any order.
    """
    rules: dict[str, set[str]] = defaultdict(set)
    for about in stated.exempt:
        for name in about.contours:
            rules[name].add(about.rule)
    contour_of = [c.contour for c in facts.candidates]
    excusable: dict[int, list[AtLeast]] = defaultdict(list)
    for s in stated.statements:
        if isinstance(s, AtLeast) and s.weight == EXEMPTION_MM and s.when is not None:
            excusable[s.when].append(s)
    already: set[int] = set()
    for c in route:
        for s in excusable[c]:
            condition = of_at_least(s, contour_of, None)
            if condition is not None and not condition.met(already):
                rules[facts.nest.contours[contour_of[c]].id].add(s.about.rule)
        already.add(contour_of[c])
    return {name: tuple(sorted(of)) for name, of in rules.items()}
