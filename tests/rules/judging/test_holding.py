"""Islands that cuts leave, told from the last cut to the first, are those that a look at every cut finds."""

from __future__ import annotations

import math

from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise.rules.judging.holding import Graph, island_cuts

FRAME = -1


def pieces_of(parts: set[int], joined: Graph, framed: set[int]) -> list[set[int]]:
    """The parts that hang together; the frame is one of them where some hang on it."""
    left, found = {*parts, FRAME}, []
    while left:
        reached = [left.pop()]
        for k in reached:
            near = framed if k == FRAME else joined[k] | ({FRAME} if k in framed else set())
            reached += sorted(near & left)
            left -= near
        found.append(set(reached))
    return found


def islands_plainly(
    cluster: set[int], joined: Graph, framed: set[int], cut_at: dict[int, int]
) -> set[tuple[int, frozenset[int]]]:
    """What each cut sets apart from the frame, or from the piece that lasts longest; never-cut parts last."""
    last = {k: (cut_at.get(k, math.inf), -k) for k in cluster}
    found: set[tuple[int, frozenset[int]]] = set()
    for part, at in cut_at.items():
        before = {k for k in cluster if cut_at.get(k, math.inf) >= at}
        (whole,) = (piece for piece in pieces_of(before, joined, framed) if part in piece)
        apart = [piece for piece in pieces_of(before - {part}, joined, framed) if piece <= whole and piece != {FRAME}]
        held = FRAME in whole
        apart = [piece for piece in apart if piece]
        if not held and apart:
            apart.remove(max(apart, key=lambda piece: max(last[k] for k in piece)))
        found |= {(at, frozenset(piece)) for piece in apart if FRAME not in piece}
    return found


@st.composite
def cut_clusters(draw: st.DrawFn) -> tuple[set[int], Graph, set[int], dict[int, int]]:
    count = draw(st.integers(1, 7))
    edges = draw(st.sets(st.tuples(st.integers(0, count - 1), st.integers(0, count - 1)), max_size=12))
    joined: dict[int, set[int]] = {k: set() for k in range(count)}
    for a, b in edges:
        if a != b:
            joined[a].add(b)
            joined[b].add(a)
    framed = draw(st.sets(st.integers(0, count - 1)))
    order = draw(st.permutations(range(count)))
    return set(range(count)), joined, framed, {k: at for at, k in enumerate(order[: draw(st.integers(0, count))], 1)}


@given(cut_clusters())
@example(({0, 1, 2}, {0: {2}, 1: {2}, 2: {0, 1}}, set(), {}))
@example(({0, 1, 2, 3}, {0: {1, 2}, 1: {0}, 2: {0}, 3: set()}, set(), {0: 1, 3: 2, 1: 3}))
def test_islands_are_those_that_a_look_at_every_cut_finds(
    drawn: tuple[set[int], Graph, set[int], dict[int, int]],
) -> None:
    """Some parts may never be cut, as in a program that breaks off: those set nothing apart."""
    cluster, joined, framed, cut_at = drawn
    for own in pieces_of(cluster, joined, framed):
        own.discard(FRAME)
        if own:
            told = {(at, frozenset(island)) for at, island in island_cuts(sorted(own), joined, framed, cut_at)}
            assert told == islands_plainly(own, joined, framed & own, {k: at for k, at in cut_at.items() if k in own})
