"""Contradictions of orders alone, named without a solver.

What groups say of an order is a graph: a link for each "this before that", a knot for each run. A cycle in it is a
contradiction, and a shortest one is told. Places are asked of a schedule that finds an order wherever there is one.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import assert_never

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.graphs import Link, components, contracted, path
from kerfwise.rules.statements import AtLeast, Before, Contiguous, Crossing, Forbid, Lag, Move, NoGood, Precede
from kerfwise.rules.stating.feasible_order import ends_of, likely_order

from .groups import Group, drop_unneeded_rules, shrink


def clash_of_orders(
    n: int, groups: Sequence[Group], orders: Sequence[Orders], gives_way: Mapping[str, int]
) -> list[Group] | None:
    """Groups that cannot all hold for what they say (`orders`) of the order of n contours; None if none are seen.

    Without any one of them the others can, as far as orders go. As long as groups of rules that give way late
    contradict each other no other is told (`gives_way`, the highest first). A shortest cycle is told before a place
    that no order leaves; of several cycles of two what one rule says by itself, and then what stands first among all.
    """
    says = {group.about: of for group, of in zip(groups, orders, strict=True)}
    ranks = [gives_way.get(group.about.rule, 0) for group in groups]

    def clash(core: Sequence[Group]) -> list[int] | None:
        return None if can_hold(n, [says[group.about] for group in core]) else list(range(len(core)))

    for rank in sorted(set(ranks)):
        if cycle := _cycle(n, groups, orders, [k for k, of in enumerate(ranks) if of <= rank]):
            return shrink([groups[k] for k in sorted(cycle, reverse=True)], clash)[0]
    if not any(of.earliest or of.latest for of in orders):
        return None
    says = {about: replace(of, runs=()) for about, of in says.items()}  # a schedule knows of no runs
    ordered = [group for group in groups if (of := says[group.about]).links or of.earliest or of.latest]
    if clash(ordered) is None:
        return None
    ranked = sorted(ordered, key=lambda group: -gives_way.get(group.about.rule, 0))
    return shrink(drop_unneeded_rules(ranked, gives_way, clash), clash)[0]


def opposites(orders: Sequence[Orders]) -> list[tuple[int, int]]:
    """Every two groups of which one wants a contour before another, and the other the other way round.

    Examples
    --------
    >>> opposites([Orders(((0, 1),)), Orders(((1, 2),)), Orders(((1, 0), (2, 1)))])
    [(0, 2), (1, 2)]
    """
    asking: dict[Link, list[int]] = defaultdict(list)
    for k, of in enumerate(orders):
        for link in of.links:
            asking[link].append(k)
    found = ((k, m) for (i, j), one in asking.items() if i < j for k in one for m in asking.get((j, i), ()))
    return sorted({(min(pair), max(pair)) for pair in found if pair[0] != pair[1]})


def is_exact(orders: Iterable[Orders]) -> bool:
    """Whether `can_hold` tells all there is of these groups: they say nothing else, and no two runs share a contour."""
    known = list(orders)
    of_runs = [k for of in known for run in of.runs for k in set(run)]
    places = any(of.earliest or of.latest for of in known)
    return all(of.whole for of in known) and len(set(of_runs)) == len(of_runs) and not (of_runs and places)


def can_hold(n: int, orders: Iterable[Orders]) -> bool:
    """Whether an order of n contours keeps all links and runs, and one all links and places.

    Where there are runs and places, one that keeps both may be missing all the same.
    """
    known = list(orders)
    links = [link for of in known for link in of.links]
    if components(contracted(n, links, [run for of in known for run in of.runs])):
        return False
    earliest, latest = bounds(known)
    if not earliest and not latest:
        return True
    places = likely_order(n, links, earliest, latest)
    return places is not None and places_hold(places, earliest, latest)


def bounds(orders: Iterable[Orders]) -> tuple[dict[int, int], dict[int, int]]:
    """The earliest and the latest place, from 0 on, of contours that have one."""
    earliest: dict[int, int] = {}
    latest: dict[int, int] = {}
    for of in orders:
        for k, place in of.earliest:
            earliest[k] = max(place, earliest.get(k, place))
        for k, place in of.latest:
            latest[k] = min(place, latest.get(k, place))
    return earliest, latest


def places_hold(places: Sequence[int], earliest: Mapping[int, int], latest: Mapping[int, int]) -> bool:
    """Whether no contour is too early or too late."""
    soon = all(places[k] >= of for k, of in earliest.items())
    return soon and all(places[k] <= of for k, of in latest.items())


def _cycle(n: int, groups: Sequence[Group], orders: Sequence[Orders], among: Sequence[int]) -> list[int] | None:
    """The groups, by number, of a shortest cycle of those that are asked."""
    asking: dict[Link, int] = {}
    for k in among:
        for link in orders[k].links:
            asking.setdefault(link, k)
    runs = [(run, k) for k in among for run in orders[k].runs]
    links = list(asking)
    found = shortest_cycle(n, links, [run for run, _ in runs], [groups[asking[link]].about.rule for link in links])
    if found is None:
        return None
    cycle, tying = found
    return list(dict.fromkeys([*(asking[links[k]] for k in cycle), *(runs[k][1] for k in tying)]))


# What groups say of the order alone: links, runs and places, which a graph can answer for without a solver.


@dataclass(frozen=True, slots=True)
class Orders:
    """What holds of every order that keeps a group; `whole` where the group says no more than that.

    `links` are (before, after), `runs` contours without another between them, `earliest` and `latest` places, from 0
    on, that a contour may not pass.
    """

    links: tuple[Link, ...] = ()
    runs: tuple[tuple[int, ...], ...] = ()
    earliest: tuple[tuple[int, int], ...] = ()
    latest: tuple[tuple[int, int], ...] = ()
    whole: bool = True


def orders_of(facts: Facts, groups: Sequence[Group]) -> list[Orders]:
    """What each group says of the order."""
    contour_of = [c.contour for c in facts.candidates]
    return [_of_group(facts, group, contour_of) for group in groups]


def _of_group(facts: Facts, group: Group, contour_of: Sequence[int]) -> Orders:
    links: list[Link] = []
    runs: list[tuple[int, ...]] = []
    earliest: list[tuple[int, int]] = []
    latest: list[tuple[int, int]] = []
    asking: dict[Link, set[int]] = defaultdict(set)
    whole = True
    for s in group.statements:
        match s:
            case Precede(i, j):
                links.append((i, j))
            case Contiguous(contours):
                runs.append(contours)
            case AtLeast() if ends := ends_of(s, facts.n):
                if s.bound >= facts.n - 1:  # first or last of all: an order of every two
                    links += [link for link, _ in forced(s)]
                    whole = whole and s.bound == facts.n - 1
                    continue
                for contour, early in ends if s.bound > 0 else ():
                    if early:
                        earliest.append((contour, s.bound))
                    else:
                        latest.append((contour, facts.n - 1 - s.bound))
            case AtLeast():
                must = list(forced(s))
                whole = whole and _all_said(s, must)
                if s.when is None:
                    links += [link for link, _ in must]
                else:
                    for link, _ in must:
                        asking[link].add(s.when)
            case Forbid() | Lag() | NoGood() | Crossing() | Move():
                whole = False
            case _:
                assert_never(s)
    for link, entries in asking.items():  # what every entry of a contour asks for is asked whatever the entry
        always = [entries.issuperset(facts.candidates_of(k)) for k in {contour_of[c] for c in entries}]
        whole = whole and all(always)
        links += [link] * any(always)
    return Orders(tuple(dict.fromkeys(links)), tuple(runs), tuple(earliest), tuple(latest), whole)


def forced(s: AtLeast) -> Iterator[tuple[Link, int]]:
    """The orders that must hold where the statement does, each with its literal's number.

    A literal that has a contour before itself is never true, and asks for no order.
    """
    most = sum(w for w in s.weights if w > 0)
    if most < s.bound:
        return
    for k, (literal, weight) in enumerate(zip(s.literals, s.weights, strict=True)):
        if isinstance(literal, Before) and literal.i != literal.j and most - abs(weight) < s.bound:
            yield ((literal.i, literal.j) if weight > 0 else (literal.j, literal.i)), k


def _all_said(s: AtLeast, must: Sequence[tuple[Link, int]]) -> bool:
    """Whether the statement holds wherever the orders that it forces do."""
    known = {k for _, k in must}
    least = sum(w for k, w in enumerate(s.weights) if (k in known and w > 0) or (k not in known and w < 0))
    return least >= s.bound


# A cycle of the fewest orders in the graph of all orders, contours cut in one go being one knot of it.


def shortest_cycle(
    n: int, links: Sequence[Link], runs: Sequence[Sequence[int]], rules: Sequence[str] = ()
) -> tuple[list[int], list[int]] | None:
    """Numbers of links on a cycle, as few as there are on any, and of runs that tie them together; None if none is.

    Of cycles of two links one is taken that needs no run, then one that is of one rule only (`rules`, of each link),
    and then the one whose links stand first. Every cycle goes through a knot that is looked at: those with the most
    links come first, and are taken out of the graph then, until it has no cycle.

    Examples
    --------
    >>> shortest_cycle(4, [(0, 1), (1, 2), (3, 0), (1, 3)], [])
    ([0, 3, 2], [])
    >>> shortest_cycle(4, [(0, 1), (1, 2)], [(0, 2), (2, 3)])
    ([0, 1], [0, 1])
    """
    nodes = contracted(n, links, runs)

    def key(cycle: Sequence[int]) -> tuple[int, int, Sequence[int]]:
        return len(cycle), len({rules[k] for k in cycle if rules}), cycle

    best: list[int] | None = min(_pairs(links, range(len(links))), key=key, default=None)
    for component in components(nodes) if best is None else ():
        pairs = _pairs(nodes, component)
        found = min(pairs, key=key) if pairs else _through_knots(nodes, component, None if best is None else len(best))
        if found and (best is None or key(found) < key(best)):
            best = found
    return None if best is None else (best, sorted(_tying(links, runs, best)))


def _pairs(nodes: Sequence[Link], component: Iterable[int]) -> list[list[int]]:
    """Each link from a knot to itself, and every two that lead to and fro."""
    first: dict[Link, int] = {}
    found: list[list[int]] = []
    for k in component:
        a, b = nodes[k]
        if a == b:
            found.append([k])
        elif (b, a) in first:
            found.append([first[b, a], k])
        first.setdefault((a, b), k)
    return found


def _through_knots(nodes: Sequence[Link], component: Sequence[int], known: int | None) -> list[int] | None:
    """A shortest cycle of a strongly connected component, if it has fewer links than are `known`."""
    best: list[int] | None = None
    waiting = [list(component)]
    while waiting:
        links = waiting.pop()
        busiest = _busiest(nodes, links)
        found = path(nodes, links, busiest, busiest) or []
        if known is None or len(found) < known:
            best, known = found, len(found)
        left = [k for k in links if busiest not in nodes[k]]
        waiting += [[left[m] for m in part] for part in components([nodes[k] for k in left])]
    return best


def _busiest(nodes: Sequence[Link], links: Sequence[int]) -> int:
    """The knot with the most links that lead to it, or away from it, whichever are fewer."""
    leaving: dict[int, int] = {}
    reaching: dict[int, int] = {}
    for k in links:
        a, b = nodes[k]
        leaving[a] = leaving.get(a, 0) + 1
        reaching[b] = reaching.get(b, 0) + 1
    return min(leaving, key=lambda node: (-min(leaving[node], reaching[node]), node))


def _tying(links: Sequence[Link], runs: Sequence[Sequence[int]], cycle: Sequence[int]) -> Iterator[int]:
    """The runs that lead from where a link of the cycle ends to where the next begins, over others that they share."""
    met = {links[k][1] for k, then in zip(cycle, [*cycle[1:], cycle[0]], strict=True) if links[k][1] != links[then][0]}
    left = dict(enumerate(map(set, runs)))
    while found := [k for k, of in left.items() if met & of]:
        for k in found:
            met |= left.pop(k)
            yield k
