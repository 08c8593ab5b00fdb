"""The short form of why: the statements that hold a contour in its place, nearest first."""

from __future__ import annotations

from collections.abc import Sequence

from ..encoder.facts.facts import Facts
from ..rules.state import Stated
from ..rules.statements import Precede


def reasons(facts: Facts, stated: Stated, order: Sequence[int]) -> list[tuple[str, ...]]:
    """For every contour of `order`: what kept it from coming earlier, then what kept it from coming later.

    Of the orders that end (begin) at a contour only the nearest in the plan is told: the others hold by more.
    """
    place = {contour: k for k, contour in enumerate(order)}
    after: dict[int, Precede] = {}
    before: dict[int, Precede] = {}
    for s in stated.statements:
        if not isinstance(s, Precede) or place[s.before] > place[s.after]:
            continue
        if s.after not in after or place[s.before] > place[after[s.after].before]:
            after[s.after] = s
        if s.before not in before or place[s.after] < place[before[s.before].after]:
            before[s.before] = s
    told = []
    for contour in order:
        held = [near[contour].about.sentence for near in (after, before) if contour in near]
        name = facts.nest.contours[contour].id
        told.append(tuple(held) or (f"no order rule speaks of {name}: it is cut here for the shortest travel",))
    return told
