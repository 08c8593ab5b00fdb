"""Islands that cuts leave, told from the last cut to the first, are those that a look at every cut finds."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise import Nest
from kerfwise.encoder.candidates.build import scrap_problems
from kerfwise.encoder.scrap import with_scrap
from kerfwise.rule_kit import FactOptions, in_order, nest, part, rect
from kerfwise.rules.catalogue.scrap_last.skeleton import skeleton_of
from kerfwise.rules.judging.holding import Graph, bounding, island_cuts, loose_scrap_cuts
from kerfwise.tests.tools.amount import few

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
    for one, at in cut_at.items():
        before = {k for k in cluster if cut_at.get(k, math.inf) >= at}
        (whole,) = (piece for piece in pieces_of(before, joined, framed) if one in piece)
        apart = [piece for piece in pieces_of(before - {one}, joined, framed) if piece <= whole and piece != {FRAME}]
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


KERF_MM = 1.5


def gridded(seed: int) -> Nest:
    """Some parts in the left half of a sheet, and a grid over all of it: right of them lines meet from both sides."""
    rng = np.random.default_rng(seed)
    placed: list[shapely.Polygon] = []
    for _ in range(12):
        x, y, w, h = (float(v) for v in (rng.uniform(5, 300), rng.uniform(5, 300), *rng.uniform(40, 200, 2)))
        box = shapely.box(x, y, x + w, y + h)
        if shapely.box(5, 5, 500, 495).covers(box) and all(box.distance(other) > 6 for other in placed):
            placed.append(box)
    parts = [part(f"P{k}", rect(*b.bounds[:2], *np.subtract(b.bounds[2:], b.bounds[:2]))) for k, b in enumerate(placed)]
    return with_scrap(nest(1000, 500, *parts), KERF_MM, 260.0, None)


def orders(ids: list[str], framed: set[str], pairs: set[tuple[str, str]], rng: np.random.Generator) -> list[list[str]]:
    """Orders of lines at random, and some that begin at the frame and are turned round."""
    found = [[ids[k] for k in rng.permutation(len(ids))] for _ in range(10)]
    for _ in range(10):
        last = [str(rng.choice(sorted(framed)))]
        while ready := sorted(a for a in {*ids} - {*last} if a in framed or any((a, b) in pairs for b in last)):
            last.append(str(rng.choice(ready)))
        found.append(last[::-1])
        at = int(rng.integers(len(last) - 1))
        found.append([*found[-1][:at], found[-1][at + 1], found[-1][at], *found[-1][at + 2 :]])
    return found


@pytest.mark.parametrize("seed", few(range(30), 2))
def test_orders_that_are_stated_cut_nothing_loose(seed: int) -> None:
    made = gridded(seed)
    framed, pairs = bounding(made, KERF_MM)
    ids, parts = [line.id for line in made.scrap], " ".join(c.id for c in made.without_scrap.contours)
    known = [c.id for c in made.contours]
    facts = skeleton_of(made, FactOptions(kerf_mm=KERF_MM))
    assert {known[k] for k in np.flatnonzero(facts["scrap_framed"].values)} == framed
    assert {(known[a], known[b]) for a, b in facts["scrap_beside"].values.tolist()} == pairs
    lawful = 0
    for order in orders(ids, framed, pairs, np.random.default_rng(seed)):
        stated = all(a in framed or any((a, b) in pairs for b in order[k + 1 :]) for k, a in enumerate(order))
        loose = list(loose_scrap_cuts(made, in_order(made, f"{parts} {' '.join(order)}"), KERF_MM))
        assert (loose == []) == (stated and len(order) == len(ids)), (order, loose)
        lawful += stated
    assert lawful >= 5


def test_a_line_that_others_sever_is_refused_with_the_place() -> None:
    lines = [[(100, 0), (100, 200)], [(0, 80), (100, 80)], [(100, 80), (300, 80)]]
    drawn = nest(300, 200, scrap=lines)
    told = "scrap1 is cut in two by the lines that end on it at (100.0, 80.0): draw it as two lines that meet there"
    assert scrap_problems(drawn, KERF_MM) == [told]
    moved = [*lines[:2], [(100, 90), (300, 90)]]
    assert scrap_problems(nest(300, 200, scrap=moved), KERF_MM) == []
    split = [[(100, 0), (100, 80)], [(100, 80), (100, 200)], *lines[1:]]
    assert scrap_problems(nest(300, 200, scrap=split), KERF_MM) == []


def test_a_void_across_from_where_a_line_ends_severs_as_well() -> None:
    plate = part("A", rect(101.5, 60, 198, 40))
    lines = [[(100, 0), (100, 200)], [(0, 80), (100, 80)]]
    assert scrap_problems(nest(300, 200, plate, scrap=lines), KERF_MM) != []
    assert scrap_problems(nest(300, 200, part("A", rect(140, 60, 40, 40)), scrap=lines), KERF_MM) == []
