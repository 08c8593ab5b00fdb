"""Spots are looked at some at a time, and some rays are told by numpy: what each faces does not depend on either."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from kerfwise.encoder.nest import Nest
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.judging import facing
from kerfwise.rules.judging.facing import Facing, Spots, spots_along, spots_along_each
from kerfwise.tests.rules.test_statements_agree import sheets
from kerfwise.tests.tools.amount import examples


@examples(20)
@given(sheets(), st.integers(1, 90))
def test_spots_face_the_same_some_at_a_time(sheet: Nest, some: int) -> None:
    assume(sheet.parts)
    spots = Spots.joined(
        [spots_along(k, p.outer.line, 0.0, p.outer.line.length, 40) for k, p in enumerate(sheet.parts)]
    )
    outlines = Facing(sheet, 25.0, 25.0)
    all_at_once = outlines.faced(spots)
    assert len(all_at_once) == 40 * len(sheet.parts)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(facing, "AT_ONCE", some)
        assert outlines.faced(spots).tolist() == all_at_once.tolist()
    assert outlines.faced(Spots.joined([])).tolist() == []


@given(st.lists(st.tuples(*[st.integers(-40, 40)] * 4), min_size=1, max_size=30))
def test_looks_meet_the_chords_that_shapely_says(rays: list[tuple[int, int, int, int]]) -> None:
    """From whole millimetres to whole millimetres: many go through corners, or along outlines."""
    plate = nest(60, 50, part("A", rect(2, 3, 20, 20), [rect(5, 5, 10, 10)]), part("B", rect(25, 4, 20, 20)))
    begin = np.array([(x + 20, y + 20) for x, y, _, _ in rays], dtype=np.float64)
    end = begin + np.array([(dx, dy) if dx or dy else (1, 0) for _, _, dx, dy in rays]) / 4
    judged = Facing(plate, 25.0, 25.0)
    judged.convex[:] = False  # these looks begin anywhere
    found = judged._met(begin, end, np.zeros(len(rays), dtype=np.int64))
    lines = shapely.linestrings(np.stack([begin, end], axis=1))
    told = judged.tree.query(lines, predicate="intersects")
    assert sorted(zip(*(of.tolist() for of in found), strict=True)) == sorted(zip(*told.tolist(), strict=True))


@examples(20)
@given(sheets())
def test_looks_out_of_convex_parts_need_not_be_held_against_these(sheet: Nest) -> None:
    assume(sheet.parts)
    lines = [part.outer.line for part in sheet.parts]
    spots = Spots.joined([spots_along(k, line, 0.0, line.length, 60) for k, line in enumerate(lines)])
    outlines = Facing(sheet, 25.0, 25.0)
    found = outlines.faced(spots).tolist()
    outlines.convex[:] = False
    assert outlines.faced(spots).tolist() == found


def test_a_channel_is_not_convex() -> None:
    channel = [(0, 0), (40, 0), (40, 10), (10, 10), (10, 30), (40, 30), (40, 40), (0, 40)]
    plate = nest(200, 100, part("A", [(x + 5, y + 5) for x, y in channel]), part("B", rect(80, 5, 20, 20)))
    assert Facing(plate, 25.0, 25.0).convex.tolist() == [False, True]


@examples(20)
@given(sheets(), st.data())
def test_spots_along_several_lines_are_those_along_each(sheet: Nest, data: st.DataObject) -> None:
    lines = [contour.line for contour in sheet.contours if contour.encloses]
    lengths = [data.draw(st.floats(-1.5, 1.5).filter(bool)) * line.length for line in lines]
    begins = [data.draw(st.floats(0.0, 1.0)) * line.length for line in lines]
    counts = [data.draw(st.integers(1, 30)) for _ in lines]
    asked = list(zip(range(len(lines)), lines, begins, lengths, counts, strict=True))
    together = spots_along_each(asked)
    alone = Spots.joined([spots_along(*stretch) for stretch in asked])
    assert together.part.tolist() == alone.part.tolist()
    assert together.at.tolist() == alone.at.tolist()
    assert together.normal.tolist() == alone.normal.tolist()
    first = 0
    for line, begin, length, count in zip(lines, begins, lengths, counts, strict=True):
        where = (begin + length * (np.arange(count) + 0.5) / count) % line.length
        at = together.at[first : first + count]
        want = shapely.get_coordinates(shapely.line_interpolate_point(line, where))
        assert np.allclose(at, want, atol=1e-6)
        beside = shapely.points(at + 1e-3 * together.normal[first : first + count])
        assert shapely.distance(line, beside).max() < 1.001e-3
        first += count
