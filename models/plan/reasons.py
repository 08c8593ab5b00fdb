"""The short form of why: the statements that hold a contour in its place, nearest first, and its entry."""

from __future__ import annotations

import math
from collections.abc import Sequence, Set

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.segment import Point
from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.statements import Link, Precede
from kerfwise.rules.stating.state_rules import Stated

from .plan import LINKED

SAME_MM = 1e-6


def reasons(
    facts: Facts, stated: Stated, route: Sequence[int], home: Point, links: Sequence[Link | None] | None = None
) -> list[tuple[str, ...]]:
    """For every cut of `route` (candidates in order): what kept it from coming earlier, what from coming later, and
    the entry, where it is the shortest way on, or the link that leads to it.

    Of the orders that end (begin) at a contour only the nearest in the plan is told: the others hold by more.
    """
    order = [facts.candidates[c].contour for c in route]
    place = {contour: k for k, contour in enumerate(order)}
    after: dict[int, Precede] = {}
    before: dict[int, Precede] = {}
    kinds = by_kind(stated.statements)
    for s in kinds.precede:
        if place[s.before] > place[s.after]:
            continue
        if s.after not in after or place[s.before] > place[after[s.after].before]:
            after[s.after] = s
        if s.before not in before or place[s.after] < place[before[s.before].after]:
            before[s.before] = s
    links = [None] * len(route) if links is None else links
    forbidden = {s.candidate for s in kinds.forbid if s.weight is None}
    entered = _entered(facts, forbidden, route, home, links)
    told = []
    for contour, entry in zip(order, entered, strict=True):
        held = [near[contour].about.sentence for near in (after, before) if contour in near]
        name = facts.nest.contours[contour].id
        told.append((*(held or [f"no order rule is about {name}: it is cut here for the shortest travel"]), *entry))
    return told


def _entered(
    facts: Facts, forbidden: Set[int], route: Sequence[int], home: Point, links: Sequence[Link | None]
) -> list[tuple[str, ...]]:
    """For every cut, that no lawful candidate of its contour makes a shorter way between its neighbours, if so."""
    used = [facts.candidates[c] for c in route]
    names = ["home", *(facts.nest.contours[c.contour].id for c in used), "home"]
    told: list[tuple[str, ...]] = []
    for k, candidate in enumerate(used):
        if (link := links[k]) is not None:
            told.append((f"{LINKED}{link.about.sentence}, which takes less time than a pierce",))
            continue
        if k + 1 < len(used) and links[k + 1] is not None:
            told.append(())
            continue
        leave = used[k - 1].end if k else home
        reach = used[k + 1].pierce if k + 1 < len(used) else home
        rivals = [c for c in facts.candidates_of(candidate.contour) if c not in forbidden]
        ways = [_way_mm(leave, facts.candidates[c].pierce, facts.candidates[c].end, reach) for c in rivals]
        shortest = _way_mm(leave, candidate.pierce, candidate.end, reach) <= min(ways) + SAME_MM
        x, y = candidate.entry
        sentence = f"entered at ({x:.1f}, {y:.1f}): the shortest lawful way from {names[k]} to {names[k + 2]}"
        told.append((sentence,) if shortest and len(rivals) > 1 else ())
    return told


def _way_mm(leave: Point, pierce: Point, end: Point, reach: Point) -> float:
    return math.dist(leave, pierce) + math.dist(end, reach)
