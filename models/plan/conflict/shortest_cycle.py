"""A cycle of the fewest orders in the graph of all orders, contours cut in one go being one knot of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from kerfwise.rules.stating.cycles import Link, components, contracted, path


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
