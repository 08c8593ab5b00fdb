from dataclasses import replace

import pytest

from kerfwise.encoder.readers.drawing import DrawnCurve
from kerfwise.encoder.readers.lettering import with_marks
from kerfwise.encoder.readers.nest_from_drawing import assemble
from kerfwise.tests.encoder.readers.drawings import square, texts
from kerfwise.tests.encoder.readers.pieces import pieces


def rings(*squares: tuple[float, float, float]) -> list[DrawnCurve]:
    return pieces(*(square(*s) for s in squares), closed=True)


def test_even_depth_is_a_part_and_odd_depth_a_hole() -> None:
    parts, notes = assemble(rings((0, 0, 100), (10, 10, 50), (20, 20, 20), (25, 25, 5), (70, 70, 10)))
    assert [c.id for p in parts for c in p] == ["P1.hole1", "P1.hole2", "P1.outer", "P2.hole1", "P2.outer"]
    assert [p.polygon.area for p in parts] == [10_000 - 2500 - 100, 400 - 25]
    assert notes == []


def test_parts_are_numbered_as_their_outlines_are_drawn() -> None:
    parts, _ = assemble(rings((210, 10, 5), (200, 0, 50), (0, 0, 50)))
    assert {p.id: p.polygon.bounds[0] for p in parts} == {"P1": 200, "P2": 0}
    assert [h.id for h in parts[0].holes] == ["P1.hole1"]


def test_a_ring_drawn_again_is_dropped_and_named() -> None:
    parts, notes = assemble(rings((0, 0, 100), (10, 10, 50), (20, 20, 20), (20, 20, 20)))
    assert [c.id for p in parts for c in p] == ["P1.hole1", "P1.outer", "P2.outer"]
    assert texts(notes) == [
        "the ring at (20.000, 20.000) on layer '0' is the same line as P2.outer; it is cut once, as P2.outer"
    ]


@pytest.mark.parametrize(
    ("layers", "common"),
    [(("HOLES", "OUTER"), True), (("OUTER", "HOLES"), True), (("inner cut", "outer cut"), True), (("0", "CUT"), False),
     (("HOLES", "HOLES"), False)],
)  # fmt: skip
def test_a_ring_drawn_as_a_hole_and_as_an_outline_is_given_to_two_parts(layers: tuple[str, str], common: bool) -> None:
    drawn = rings((0, 0, 100), (20, 20, 20), (20, 20, 20))
    drawn[1:] = [replace(piece, layer=layer) for piece, layer in zip(drawn[1:], layers, strict=True)]
    _, (note,) = assemble(drawn)
    assert note.common is common
    assert note.contours == ((f"the ring on layer '{layers[1]}'", "P1.hole1") if common else ("P1.hole1",))


def test_a_ring_drawn_three_times_is_cut_once() -> None:
    parts, notes = assemble(rings((0, 0, 100), (0, 0, 100), (0, 0, 100)))
    assert (len(parts), len(notes)) == (1, 2)


def test_a_mark_belongs_to_the_metal_it_lies_on() -> None:
    marks = pieces([(1, 5), (9, 5)], [(25, 25), (35, 25)], [(12, 15), (18, 15)])
    parts, notes, _ = with_marks(assemble(rings((0, 0, 100), (10, 10, 50), (20, 20, 20)))[0], marks)
    assert [m.id for p in parts for m in p.marks] == ["P1.mark1", "P2.mark1"]
    assert texts(notes) == ["the mark at (12.000, 15.000) on layer '0' is on no part: left out"]


def test_a_mark_over_two_parts_belongs_to_the_one_it_is_longest_on() -> None:
    parts, *_ = with_marks(assemble(rings((0, 0, 10), (20, 0, 10)))[0], pieces([(8, 5), (28, 5)]))
    assert [m.id for p in parts for m in p.marks] == ["P2.mark1"]
