"""Whether what `explain` says of entries is true: each other way of a contour is put in the place of the plan's.

The judge's arithmetic prices it; what is said to forbid it must be broken then, and a rule that is said to leave one
way round must leave both where it is off.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator
from itertools import product

from kerfwise.models.plan.explain.alternatives import Entry, OtherEntry
from kerfwise.rule_kit import Crossing, Forbid

from .judge import NOTHING_MM, Judge, Verdict

OVER_PARTS = "would cross a part that is already out"
MOST_LAWFUL, MOST_UNLAWFUL = 4, 4
"""Ways of one contour that are judged, of each kind."""
_NEAR_MM = 1e-6


def entry_verdicts(
    judge: Judge, contour: int, entry: Entry, ways_round: Callable[[Collection[str]], Collection[str]]
) -> Iterator[Verdict]:
    """What is said of the entries of one contour, each with what is wrong with it.

    `ways_round` answers with the directions that the contour is offered where some rules are off.
    """
    name = judge.ids[contour]
    if entry.one_way_by:
        said = f"{' and '.join(entry.one_way_by)} leaves no other way round than {entry.used.direction}"
        free = set(ways_round(entry.one_way_by)) == {"cw", "ccw"}
        other = [way for way in entry.lawful if way.direction != entry.used.direction]
        wrong = "" if free and not other else "another is lawful" if other else "without it there is no other, either"
        yield Verdict(name, said, wrong)
    for way in entry.lawful[:MOST_LAWFUL]:
        yield Verdict(name, f"another entry: {way.more_um} um more", _mispriced(judge, contour, way))
    for way in entry.unlawful[:MOST_UNLAWFUL]:
        said = f"another entry is unlawful: {'; '.join(about.sentence for about in way.against)}"
        yield Verdict(name, said, _allowed_after_all(judge, contour, way))


def _candidates(judge: Judge, contour: int, way: OtherEntry) -> list[int]:
    """The candidates that a way may be: copies of it end otherwise."""
    return [
        c
        for c in judge.facts.candidates_of(contour)
        if judge.facts.candidates[c].direction == way.direction
        and math.dist(judge.facts.candidates[c].pierce, way.pierce) < _NEAR_MM
        and math.dist(judge.facts.candidates[c].entry, way.entry) < _NEAR_MM
    ]


def _instead(judge: Judge, contour: int, candidate: int) -> tuple[int, ...]:
    return tuple(candidate if judge.facts.candidates[c].contour == contour else c for c in judge.route)


def _mispriced(judge: Judge, contour: int, way: OtherEntry) -> str:
    """What is wrong with a price: with all else the same it is no less, and never less than the shortest travel."""
    found = []
    for candidate in _candidates(judge, contour, way):
        route = _instead(judge, contour, candidate)
        there = judge.costs(route)
        most = there.mm() - judge.now.mm() if there.broken <= judge.now.broken else math.inf
        found.append((_shortest_mm(judge, contour, candidate) - judge.now.mm(), most))
    said = (way.more_um or 0) / 1000
    if any(least - NOTHING_MM <= said <= most + NOTHING_MM for least, most in found):
        return ""
    return f"it is between {min(f[0] for f in found):.2f} and {max(f[1] for f in found):.2f} mm more"


def _shortest_mm(judge: Judge, contour: int, candidate: int) -> float:
    """The least travel along the plan's order with this candidate, all other entries free; soft rules cost nothing."""
    forbidden = {s.candidate for s in judge.statements if isinstance(s, Forbid) and s.weight is None}
    layers = [
        [candidate] if number == contour else [c for c in judge.facts.candidates_of(number) if c not in forbidden]
        for number in (judge.facts.candidates[c].contour for c in judge.route)
    ]
    best: dict[int | None, float] = {None: 0.0}
    for layer in layers:
        best = {c: min(mm + judge.leg_mm(before, c) for before, mm in best.items()) for c in layer}
    return min(mm + judge.leg_mm(c, None) for c, mm in best.items())


def _allowed_after_all(judge: Judge, contour: int, way: OtherEntry) -> str:
    """What is wrong with that hard statements forbid a way in the plan's order: none that is named is broken by it."""
    named = {about.sentence for about in way.against}
    for candidate in _candidates(judge, contour, way):
        broken = {judge.statements[k].about.sentence for k in judge.costs(_instead(judge, contour, candidate)).broken}
        if named & broken:
            return ""
        if any(OVER_PARTS in sentence for sentence in named) and _tips_anyhow(judge, contour, candidate):
            return ""
    return "nothing of it is broken"


def _tips_anyhow(judge: Judge, contour: int, candidate: int) -> bool:
    """Whether a move leads over parts that are out, whatever the entries of the cuts before and after."""
    order = [judge.facts.candidates[c].contour for c in judge.route]
    k = order.index(contour)
    first, last = max(0, k - 1), min(len(order), k + 2)
    near = [[candidate] if j == k else [*judge.facts.candidates_of(order[j])] for j in range(first, last)]
    tipping = {j for j, s in enumerate(judge.statements) if isinstance(s, Crossing) and s.weight is None}
    routes = ((*judge.route[:first], *ways, *judge.route[last:]) for ways in product(*near))
    return all(judge.costs(route).broken & tipping for route in routes)
