"""Lines that are made in the skeleton: pieces no larger than the grid, and the largest unused rectangle saved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise.encoder.candidates.build import scrap_problems
from kerfwise.encoder.cut import Side
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Box
from kerfwise.encoder.nest import Nest, Sheet
from kerfwise.encoder.scrap import LEAST_MM, remnant_of, remnant_rectangle, with_scrap
from kerfwise.encoder.validate import validated
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.tools.amount import examples

KERF_MM = 1.5
SIDES: tuple[Side, ...] = ("left", "right", "bottom", "top")


def plate(seed: int) -> Nest:
    """A sheet with a few parts at random, some of them slanted, none nearer than 6 mm to another."""
    rng = np.random.default_rng(seed)
    parts: list[shapely.Polygon] = []
    for _ in range(40):
        x, y, w, h = (float(v) for v in (*rng.uniform(5, 900, 2), *rng.uniform(30, 300, 2)))
        corners = [(x, y), (x + w, y + rng.uniform(0, 20)), (x + w, y + h), (x, y + h)]
        shape = shapely.Polygon(corners)
        if shapely.box(5, 5, 995, 695).covers(shape) and all(shape.distance(other) > 6 for other in parts):
            parts.append(shape)
    return nest(1000, 700, *(part(f"P{k}", list(p.exterior.coords)[:-1]) for k, p in enumerate(parts)))


def pieces(made: Nest) -> list[shapely.Polygon]:
    gone = [p.outer.polygon.buffer(KERF_MM) for p in made.parts]
    gone += [line.line.buffer(KERF_MM / 2) for line in made.scrap]
    left = shapely.get_parts(made.sheet.polygon - shapely.union_all(gone))
    return [piece for piece in left if piece.area > KERF_MM**2]


@examples(25)
@given(st.integers(0, 10_000), st.sampled_from([150.0, 300.0, 500.0]))
def test_no_piece_is_larger_than_the_grid(seed: int, grid_mm: float) -> None:
    made = with_scrap(plate(seed), KERF_MM, grid_mm, None)
    for piece in pieces(made):
        x0, y0, x1, y1 = piece.bounds
        assert max(x1 - x0, y1 - y0) <= grid_mm
    assert scrap_problems(made, KERF_MM) == []
    assert validated(made).scrap == made.scrap


@examples(25)
@given(st.integers(0, 10_000), st.sampled_from(SIDES))
def test_a_remnant_lies_at_its_side_off_all_parts(seed: int, side: Side) -> None:
    drawn = plate(seed)
    bounds, _ = remnant_rectangle(
        (0, 0, 1000, 700), [p.outer.polygon.buffer(KERF_MM).bounds for p in drawn.parts], side, 0.0
    )
    assume(min(bounds[2] - bounds[0], bounds[3] - bounds[1]) > LEAST_MM + 2 * KERF_MM)
    remnant = remnant_of(drawn, KERF_MM, side)
    x0, y0, x1, y1 = remnant.bounds
    assert {"left": x0 == 0, "right": x1 == 1000, "bottom": y0 == 0, "top": y1 == 700}[side]
    made = with_scrap(drawn, KERF_MM, 400.0, side)
    [piece] = [p for p in pieces(made) if p.covers(shapely.box(*remnant.bounds).buffer(-0.02))]
    assert piece.area == pytest.approx(np.prod(remnant.size_mm), rel=1e-3)
    assert validated(made).scrap == made.scrap
    assert scrap_problems(made, KERF_MM) == []


@examples(100)
@given(st.lists(st.tuples(*[st.integers(0, 8)] * 4), max_size=5), st.sampled_from(SIDES))
def test_the_rectangle_is_the_largest(rows: list[tuple[int, int, int, int]], side: Side) -> None:
    """All rectangles between whole numbers are tried."""
    blocks: list[Box] = [(a, b, a + w % 4 + 1, b + h % 4 + 1) for a, b, w, h in rows]
    (x0, y0, x1, y1), _ = remnant_rectangle((0, 0, 9, 9), blocks, side, 0.0)
    at = range(10)
    lawful = [
        (c - a) * (d - b)
        for a in at for b in at for c in at for d in at
        if a < c and b < d and {"left": a == 0, "right": c == 9, "bottom": b == 0, "top": d == 9}[side]
        and not any(max(a, p) < min(c, r) and max(b, q) < min(d, s) for p, q, r, s in blocks)
    ]  # fmt: skip
    assert (x1 - x0) * (y1 - y0) == pytest.approx(max(lawful, default=0))
    assert not any(max(x0, p) < min(x1, r) and max(y0, q) < min(y1, s) for p, q, r, s in blocks)


def test_a_sheet_that_is_no_rectangle_has_no_remnant() -> None:
    drawn = nest(1000, 700, part("A", rect(20, 20, 100, 100)))
    corner = replace(drawn, sheet=Sheet(Curve.of([(0, 0), (1000, 0), (1000, 300), (0, 700)])))
    with pytest.raises(InputError, match="this sheet is none"):
        with_scrap(corner, KERF_MM, None, "right")
    assert with_scrap(corner, KERF_MM, 400.0, None).scrap


def test_a_remnant_is_saved_of_the_largest_piece_that_parts_leave() -> None:
    """A part from edge to edge has cut off the smaller side: a line there would be cut in a loose piece."""
    drawn = nest(1000, 400, part("A", rect(20, 20, 100, 100)), part("W", rect(700, 0, 100, 400)))
    assert remnant_of(drawn, KERF_MM, "left").bounds[0] == 0
    with pytest.raises(InputError, match="right leaves nothing to save"):
        with_scrap(drawn, KERF_MM, None, "right")
    halved = nest(900, 400, part("A", rect(20, 20, 100, 100)), part("W", rect(400, 0, 100, 400)))
    assert remnant_of(halved, KERF_MM, "right").bounds[2] == 900


def test_nothing_is_made_unasked() -> None:
    drawn = plate(1)
    assert with_scrap(drawn, KERF_MM, None, None) is drawn
