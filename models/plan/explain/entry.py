"""Why a contour is entered where it is and cut the way round it is: what the other candidates would be."""

from __future__ import annotations

from dataclasses import dataclass

from kerfwise.encoder.cut import Direction
from kerfwise.encoder.geometry.segment import Point
from kerfwise.rules.statements import About

from .along import Along
from .resite import Stuck, resite
from .setting import Setting


@dataclass(frozen=True, slots=True)
class OtherEntry:
    """One way to cut the contour; `more_um` is what the plan would cost more with it, entries elsewhere chosen anew.

    An unlawful one has `against` instead: what forbids it. One `from_edge` comes in from the sheet's edge, one
    `in_kerf` begins in a neighbour's, and nothing is pierced.
    """

    entry: Point
    direction: Direction
    pierce: Point
    more_um: int | None
    against: tuple[About, ...] = ()
    from_edge: bool = False
    in_kerf: bool = False


@dataclass(frozen=True, slots=True)
class Entry:
    """How the plan cuts the contour, and the other ways: the lawful ones cheapest first.

    `one_way_by` are the rules that leave one direction only.
    """

    used: OtherEntry
    lawful: tuple[OtherEntry, ...]
    unlawful: tuple[OtherEntry, ...]
    one_way_by: tuple[str, ...]


def explain_entry(along: Along, contour: int) -> Entry:
    """All candidates of the contour in the plan's order."""
    setting = along.setting
    facts, problem = setting.facts, setting.problem
    place = setting.order.index(contour)
    already = set(setting.order[:place])
    used = setting.candidates[place]
    costs: dict[int, int | tuple[About, ...]] = {}
    lawful, unlawful = [], []
    for c in facts.candidates_of(contour):
        site = int(problem.candidate_site[c])
        if c == used or site == setting.route[place]:
            continue
        if site < 0:
            answer: int | tuple[About, ...] = tuple(along.forbidden.get(c, ()))
        else:
            if site not in costs:
                costs[site] = _pinned(along, contour, site, already)
            answer = costs[site]
        if isinstance(answer, int):
            lawful.append(_way(setting, c, answer - setting.cost))
        else:
            unlawful.append(_way(setting, c, None, answer))
    one_way_by = setting.profile.rules_of_direction(facts.nest.contours[contour].kind)
    lawful.sort(key=lambda way: way.more_um or 0)
    return Entry(_way(setting, used, 0), tuple(lawful), tuple(unlawful), one_way_by)


def _pinned(along: Along, contour: int, site: int, already: set[int]) -> int | tuple[About, ...]:
    """What the plan costs with this site, µm, or what forbids it in this order."""
    setting = along.setting
    against = [
        condition.about
        for condition in setting.conditions.get(contour, ())
        if condition.cost is None and condition.when in (None, site) and not condition.met(already)
    ]
    if against:
        return tuple(dict.fromkeys(against))
    if along.exact and (cost := along.pinned(contour, site)) is not None:
        return cost
    found = resite(setting, setting.order, {contour: site})
    if isinstance(found, Stuck):
        return found.abouts
    return found.cost


def _way(setting: Setting, c: int, more_um: int | None, against: tuple[About, ...] = ()) -> OtherEntry:
    candidate = setting.facts.candidates[c]
    return OtherEntry(
        candidate.entry,
        candidate.direction,
        candidate.pierce,
        more_um,
        against,
        candidate.edge_start,
        candidate.span is not None,
    )
