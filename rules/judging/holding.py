"""Which parts hang together, and which on the frame of the sheet: the judging half of rule no-islands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set

import numpy as np

from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Nest

from .facing import EDGE, SOLID, facing, spots_along_each
from .placement import host_holes, places

FRAME = -1
STEP_MM, LEAST_SPOTS = 2.0, 160

Graph = Mapping[int, Set[int]]


@kept_with_nest(most=2)
def holding(nest: Nest, web_mm: float, edge_band_mm: float, frame_share: float) -> tuple[Graph, frozenset[int]]:
    """Part number → parts in the same place that it faces or that face it; and the parts that hang on the frame.

    Kept with the nest: a plan and its program ask for the same.
    """
    at = places(nest, host_holes(nest))
    place = [at[part.id] for part in nest.parts]
    around = [(k, part.outer.line, part.outer.line.length) for k, part in enumerate(nest.parts)]
    every = spots_along_each([(k, line, 0.0, mm, max(LEAST_SPOTS, int(mm / STEP_MM))) for k, line, mm in around])
    faced = facing(nest, web_mm, edge_band_mm).faced(every)
    joined: dict[int, set[int]] = {k: set() for k in range(len(nest.parts))}
    framed: set[int] = set()
    pairs = np.unique((every.part * len(nest.parts) + faced)[faced >= 0])
    for k, other in (divmod(pair, len(nest.parts)) for pair in pairs.tolist()):
        if place[k] == place[other]:
            joined[k].add(other)
            joined[other].add(k)
        else:
            framed.add(k)
    steady = np.bincount(every.part[(faced == EDGE) | (faced == SOLID)], minlength=len(nest.parts))
    count = np.bincount(every.part, minlength=len(nest.parts))
    framed.update(np.flatnonzero(steady >= frame_share * count).tolist())
    return joined, frozenset(framed)


def clusters(joined: Graph) -> Iterator[list[int]]:
    """The sets that hang together, each sorted, by their smallest member.

    Examples
    --------
    >>> list(clusters({0: {2}, 1: set(), 2: {0}}))
    [[0, 2], [1]]
    """
    seen: set[int] = set()
    for start in sorted(joined):
        if start in seen:
            continue
        seen.add(start)
        reached = [start]
        for k in reached:
            new = sorted(joined[k] - seen)
            seen.update(new)
            reached += new
        yield sorted(reached)


def cut_off(
    cluster: Sequence[int], joined: Graph, framed: Set[int], cut_at: Mapping[int, int]
) -> Iterator[tuple[int, list[int]]]:
    """Position of each cut that leaves parts of the cluster on an island, and these parts.

    The cluster is put together again from the last cut to the first: pieces that are apart before a part is put back,
    and together afterwards, are those that its cut sets apart. The one on the frame stays, where there is a frame,
    else the one that lasts longest; the others are islands. Parts without a position are never cut, and set none apart.
    """
    after_all = max(cut_at.values(), default=0) + 1
    order = sorted(cluster, key=lambda k: (-cut_at.get(k, after_all), k))
    piece: dict[int, int] = {}
    members: dict[int, list[int]] = {}
    if any(k in framed for k in cluster):
        piece[FRAME], members[FRAME] = FRAME, []
    for rank, k in enumerate(order):
        near = {piece[x] for x in joined[k] if x in piece} | ({FRAME} if k in framed else set())
        stays, *islands = sorted(near) or [rank]
        if k in cut_at:
            yield from ((cut_at[k], sorted(members[island])) for island in islands)
        one = members.setdefault(stays, [])
        for new in ([k], *(members.pop(island) for island in islands)):
            one += new
            piece.update(dict.fromkeys(new, stays))
