"""A cycle of the fewest orders in the graph of all orders, contours cut in one go being one knot of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from kerfwise.rules.stating.cycles import Link, components, contracted, path


def shortest_cycle(n: int, links: Sequence[Link], runs: Sequence[Sequence[int]]) -> tuple[list[int], list[int]] | None:
    """Numbers of links on a cycle, as few as there are on any, and of runs that tie them together; None if none is.

    Of two cycles of two links the one is taken whose links stand first. Every cycle goes through a knot that is looked
    at: those with the most links come first, and are taken out of the graph then, until it has no cycle.

    Examples
    --------
    >>> shortest_cycle(4, [(0, 1), (1, 2), (3, 0), (1, 3)], [])
    ([0, 3, 2], [])
    >>> shortest_cycle(4, [(0, 1), (1, 2)], [(0, 2), (2, 3)])
    ([0, 1], [0, 1])
    """
    nodes = contracted(n, links, runs)
    best: list[int] | None = None
    for component in components(nodes):
        found = _pair(nodes, component) or _through_knots(nodes, component, None if best is None else len(best))
        if found and (best is None or len(found) < len(best)):
            best = found
    return None if best is None else (best, sorted(_tying(links, runs, best)))


def _pair(nodes: Sequence[Link], component: Sequence[int]) -> list[int] | None:
    """The first link from a knot to itself, or the first two that lead to and fro; None where there are none."""
    first: dict[Link, int] = {}
    found: list[tuple[int, int]] = []
    for k in component:
        a, b = nodes[k]
        if a == b:
            return [k]
        if (b, a) in first:
            found.append((first[b, a], k))
        first.setdefault((a, b), k)
    return list(min(found)) if found else None


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
