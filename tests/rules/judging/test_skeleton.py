"""What is stated of scrap lines, one pair at a time, admits the orders in which no line is cut in loose metal."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kerfwise.encoder.candidates.build import scrap_problems
from kerfwise.encoder.facts.facts import FactOptions
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.scrap import with_scrap
from kerfwise.rules.case import in_order, nest, part, rect
from kerfwise.rules.catalogue.scrap_last.skeleton import skeleton_of
from kerfwise.rules.judging.holding import bounding, loose_scrap_cuts
from kerfwise.tests.tools.amount import few

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


@pytest.mark.parametrize("seed", few(range(30), 5))
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
