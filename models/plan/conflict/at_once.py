"""Contradictions of orders alone, named without a solver.

What groups say of an order is a graph: a link for each "this before that", a knot for each run. A cycle in it is a
contradiction, and a shortest one is told. Places are asked of a schedule that finds an order wherever there is one.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from kerfwise.rules.stating.cycles import Link, components, contracted
from kerfwise.rules.stating.likely_order import likely_order

from .group import Group
from .orders import Orders
from .shortest_cycle import shortest_cycle
from .shrinking import shrink, without_rules


def clash_of_orders(
    n: int, groups: Sequence[Group], said: Sequence[Orders], gives_way: Mapping[str, int]
) -> list[Group] | None:
    """Groups that cannot all hold for what they say (`said`) of the order of n contours; None if none are seen.

    Without any one of them the others can, as far as orders go. As long as groups of rules that give way late
    contradict each other no other is told (`gives_way`, the highest first). A shortest cycle is told before a place
    that no order leaves; of several cycles of two what one rule says by itself, and then what stands first among all.
    """
    says = {group.about: of for group, of in zip(groups, said, strict=True)}
    ranks = [gives_way.get(group.about.rule, 0) for group in groups]

    def clash(core: Sequence[Group]) -> list[int] | None:
        return None if can_hold(n, [says[group.about] for group in core]) else list(range(len(core)))

    for rank in sorted(set(ranks)):
        if cycle := _cycle(n, groups, said, [k for k, of in enumerate(ranks) if of <= rank]):
            return shrink([groups[k] for k in sorted(cycle, reverse=True)], clash)[0]
    if not any(of.earliest or of.latest for of in said):
        return None
    says = {about: replace(of, runs=()) for about, of in says.items()}  # a schedule knows of no runs
    ordered = [group for group in groups if (of := says[group.about]).links or of.earliest or of.latest]
    if clash(ordered) is None:
        return None
    ranked = sorted(ordered, key=lambda group: -gives_way.get(group.about.rule, 0))
    return shrink(without_rules(ranked, gives_way, clash), clash)[0]


def opposites(said: Sequence[Orders]) -> list[tuple[int, int]]:
    """Every two groups of which one wants a contour before another, and the other the other way round.

    Examples
    --------
    >>> opposites([Orders(((0, 1),)), Orders(((1, 2),)), Orders(((1, 0), (2, 1)))])
    [(0, 2), (1, 2)]
    """
    asking: dict[Link, list[int]] = defaultdict(list)
    for k, of in enumerate(said):
        for link in of.links:
            asking[link].append(k)
    found = ((k, m) for (i, j), one in asking.items() if i < j for k in one for m in asking.get((j, i), ()))
    return sorted({(min(pair), max(pair)) for pair in found if pair[0] != pair[1]})


def exactly(said: Iterable[Orders]) -> bool:
    """Whether `can_hold` tells all there is of these groups: they say nothing else, and no two runs share a contour."""
    known = list(said)
    of_runs = [k for of in known for run in of.runs for k in set(run)]
    places = any(of.earliest or of.latest for of in known)
    return all(of.whole for of in known) and len(set(of_runs)) == len(of_runs) and not (of_runs and places)


def can_hold(n: int, said: Iterable[Orders]) -> bool:
    """Whether an order of n contours keeps all links and runs, and one all links and places.

    Where there are runs and places, one that keeps both may be missing all the same.
    """
    known = list(said)
    links = [link for of in known for link in of.links]
    if components(contracted(n, links, [run for of in known for run in of.runs])):
        return False
    earliest, latest = bounds(known)
    if not earliest and not latest:
        return True
    places = likely_order(n, links, earliest, latest)
    return places is not None and kept(places, earliest, latest)


def bounds(said: Iterable[Orders]) -> tuple[dict[int, int], dict[int, int]]:
    """The earliest and the latest place, from 0 on, of contours that have one."""
    earliest: dict[int, int] = {}
    latest: dict[int, int] = {}
    for of in said:
        for k, place in of.earliest:
            earliest[k] = max(place, earliest.get(k, place))
        for k, place in of.latest:
            latest[k] = min(place, latest.get(k, place))
    return earliest, latest


def kept(places: Sequence[int], earliest: Mapping[int, int], latest: Mapping[int, int]) -> bool:
    """Whether no contour is too early or too late."""
    soon = all(places[k] >= of for k, of in earliest.items())
    return soon and all(places[k] <= of for k, of in latest.items())


def _cycle(n: int, groups: Sequence[Group], said: Sequence[Orders], among: Sequence[int]) -> list[int] | None:
    """The groups, by number, of a shortest cycle of those that are asked."""
    asking: dict[Link, int] = {}
    for k in among:
        for link in said[k].links:
            asking.setdefault(link, k)
    runs = [(run, k) for k in among for run in said[k].runs]
    links = list(asking)
    found = shortest_cycle(n, links, [run for run, _ in runs], [groups[asking[link]].about.rule for link in links])
    if found is None:
        return None
    cycle, tying = found
    return list(dict.fromkeys([*(asking[links[k]] for k in cycle), *(runs[k][1] for k in tying)]))
