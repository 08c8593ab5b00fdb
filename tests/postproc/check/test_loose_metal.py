"""What several burns enclose, put together burn by burn: the same as all of them put together each time."""

import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from kerfwise.postproc.check.loose_metal import Burnt
from kerfwise.tests.tools.amount import examples

KERF_MM = 0.5

spots = st.tuples(st.integers(0, 6), st.integers(0, 6))
lines = st.lists(spots, min_size=2, max_size=5, unique=True).map(shapely.LineString)
boxes = st.builds(
    lambda x, y, w, h: shapely.box(x, y, x + w, y + h).exterior,
    st.integers(0, 5), st.integers(0, 5), st.integers(1, 6), st.integers(1, 6),
)  # fmt: skip
INSIDE_FIRST = [
    shapely.box(2, 2, 4, 4).exterior,
    shapely.box(0, 0, 6, 6).exterior,
    shapely.LineString([(1, 0), (2, 3)]),
]


def plainly(burns: list[shapely.Geometry]) -> list[set[tuple[float, ...]]]:
    """The pieces that each burn has made or changed, found in all that is burnt."""
    burnt, known, found = shapely.Polygon(), set[tuple[float, ...]](), []
    for burn in burns:
        burnt = shapely.union(burnt, burn)
        rings = [ring for part in shapely.get_parts(burnt) for ring in shapely.get_rings(part)[1:]]
        new = {named(shapely.Polygon(ring)) for ring in rings if shapely.Polygon(ring).area > KERF_MM**2} - known
        known |= new
        found.append(new)
    return found


def named(piece: shapely.Polygon) -> tuple[float, ...]:
    return tuple(round(value, 2) + 0.0 for value in (*piece.bounds, piece.area))


@examples(60)
@given(st.lists(st.one_of(lines, boxes), min_size=1, max_size=12))
@example(INSIDE_FIRST)
@example(INSIDE_FIRST[::-1])
def test_burn_by_burn_encloses_what_all_together_enclose(ways: list[shapely.Geometry]) -> None:
    burns = [shapely.buffer(way, KERF_MM / 2, quad_segs=4) for way in ways]
    burnt, known = Burnt(KERF_MM), set[tuple[float, ...]]()
    for burn, expected in zip(burns, plainly(burns), strict=True):
        new = {named(piece) for piece in burnt.by(burn)} - known
        known |= new
        assert new == expected


def test_two_rounds_and_a_way_from_the_one_to_the_other() -> None:
    """The comparison above has pieces to compare."""
    burns = [shapely.buffer(way, KERF_MM / 2, quad_segs=4) for way in INSIDE_FIRST]
    assert [len(new) for new in plainly(burns)] == [1, 1, 1]
    assert sum(piece.area for piece in Burnt(KERF_MM).by(burns[1])) == pytest.approx(5.5**2)
