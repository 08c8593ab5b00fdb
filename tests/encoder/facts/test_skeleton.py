"""Which scrap lines bound the largest piece of the skeleton, and which bound one piece together."""

from __future__ import annotations

from kerfwise.encoder.facts.compute import skeleton_of
from kerfwise.rules.case import Rows, nest, part, rect
from kerfwise.rules.judging.holding import bounding

A = part("A", rect(400, 50, 100, 100))


def found(*scrap: Rows) -> tuple[list[str], set[tuple[str, str]]]:
    made = nest(1000, 200, A, scrap=scrap)
    skeleton = skeleton_of(made, 1.5)
    ids = [c.id for c in made.contours]
    beside = {(ids[a], ids[b]) for a, b in skeleton.beside.tolist()}
    framed = [name for name, is_framed in zip(ids, skeleton.framed.tolist(), strict=True) if is_framed]
    assert bounding(made, 1.5) == (set(framed), beside), "the check measures the same in its own way"
    return framed, beside


def test_without_lines_there_is_nothing() -> None:
    assert found() == ([], set())


def test_lines_to_a_part_bound_the_frame_where_each_leaves_it_whole() -> None:
    """The part's own kerf joins them: left and right of it are two pieces."""
    framed, beside = found([(450, 0), (450, 48.5)], [(450, 151.5), (450, 200)])
    assert framed == ["scrap1", "scrap2"]
    assert beside == {("scrap1", "scrap2"), ("scrap2", "scrap1")}


def test_a_line_that_ends_short_of_the_part_cuts_nothing_off() -> None:
    framed, _ = found([(450, 0), (450, 45)], [(450, 151.5), (450, 200)], [(900, 0), (900, 200)])
    assert framed == ["scrap1", "scrap2", "scrap3"]


def test_a_branch_bounds_no_more_than_the_pieces_at_its_sides() -> None:
    framed, beside = found([(200, 0), (200, 200)], [(0, 100), (200, 100)])
    assert framed == ["scrap1"]
    assert beside == {("scrap1", "scrap2"), ("scrap2", "scrap1")}
    assert found([(200, 0), (200, 200)], [(0, 100), (200.9, 100)]) == (framed, beside)


def test_of_pieces_as_large_the_lowest_and_leftmost_is_the_frame() -> None:
    framed, _ = found([(250, 0), (250, 200)], [(750, 0), (750, 200)])
    made = nest(900, 200, scrap=[[(300, 0), (300, 200)], [(600, 0), (600, 200)]])
    assert framed == ["scrap1", "scrap2"]
    assert skeleton_of(made, 1.5).framed.tolist() == [True, False]
