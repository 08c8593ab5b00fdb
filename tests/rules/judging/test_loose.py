"""Metal that comes loose: the same as the sheet less one kerf after the other, piece by piece."""

from __future__ import annotations

import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st

from kerfwise.rules.judging.loose_metal import HOLDS_MM, THIN_MM, loosened

KERF_MM = 0.5
SHEET = shapely.box(-30, -30, 37, 37)

spots = st.tuples(st.integers(0, 6), st.integers(0, 6))
lines = st.lists(spots, min_size=2, max_size=5, unique=True).map(shapely.LineString)
boxes = st.builds(
    lambda x, y, w, h: shapely.box(x, y, x + w, y + h).exterior,
    st.integers(0, 5), st.integers(0, 5), st.integers(1, 6), st.integers(1, 6),
)  # fmt: skip
to_border = st.integers(0, 6).map(lambda x: shapely.LineString([(x, -31), (x, 3), (38, 3)]))
INSIDE_FIRST = [
    shapely.box(2, 2, 4, 4).exterior,
    shapely.box(0, 0, 6, 6).exterior,
    shapely.LineString([(1, 0), (2, 3)]),
]
MIDDLE = shapely.Point(3, 3)
COINCIDING = [
    shapely.LineString([(0, 0), (0, 1)]),
    shapely.LineString([(0, -31), (0, 3), (38, 3)]),
    shapely.box(0, 1, 1, 2).exterior,
    shapely.LineString([(2, -31), (2, 3), (38, 3)]),
    shapely.LineString([(0, 1), (2, 0)]),
    shapely.LineString([(2, 1), (1, 0), (1, 1)]),
]
WALLS = [
    shapely.box(0, 0, 1, 6).exterior,
    shapely.box(1, 0, 6, 1).exterior,
    shapely.box(5, 1, 6, 6).exterior,
    shapely.box(1, 5, 5, 6).exterior,
    shapely.box(2, 2, 4, 4).exterior,
]


def plainly(sheet: shapely.Polygon, burns: list[shapely.Geometry]) -> list[float]:
    """How much loose metal each burn takes away, mm²: kerf after kerf is taken from the sheet, piece by piece."""
    held, loose, found = sheet, shapely.Polygon(), []
    for burn in burns:
        kerf = burn.buffer((KERF_MM + THIN_MM) / 2, quad_segs=8)
        found.append(float(shapely.intersection(loose, kerf).area))
        loose = loose - kerf
        pieces = [piece for piece in shapely.get_parts(held - kerf) if piece.area > 1e-9]
        border = {k: piece.exterior.intersection(sheet.exterior.buffer(1e-6)).length for k, piece in enumerate(pieces)}
        frame = max((k for k in border if border[k] > 0), key=lambda k: pieces[k].area, default=-1)
        stays = [k for k in border if k == frame or border[k] >= HOLDS_MM]
        held = shapely.union_all([pieces[k] for k in stays])
        loose = shapely.union_all([loose, *(pieces[k] for k in border if k not in stays)])
    return found


def by_faces(sheet: shapely.Polygon, burns: list[shapely.Geometry]) -> list[float]:
    taken = [0.0] * len(burns)
    for face in loosened(sheet, burns, KERF_MM):
        for k, burn in enumerate(burns):
            if face.since < k <= face.gone:
                kerf = burn.buffer((KERF_MM + THIN_MM) / 2, quad_segs=8)
                inside = face.area.buffer(-1e-4)  # where edges coincide GEOS may take all of a face for common
                taken[k] += float(face.area.area if k == face.gone else inside.intersection(kerf).area)
    return taken


@settings(deadline=None, max_examples=80, derandomize=True)
@given(st.lists(st.one_of(lines, boxes, to_border), min_size=1, max_size=12))
@example(INSIDE_FIRST)
@example(INSIDE_FIRST[::-1])
@example(WALLS)
@example(COINCIDING)
@example(WALLS[::-1])
def test_each_burn_takes_as_much_loose_metal_as_piece_by_piece(burns: list[shapely.Geometry]) -> None:
    assert by_faces(SHEET, burns) == pytest.approx(plainly(SHEET, burns), abs=2e-3)


def test_four_rounds_around_a_part_cut_it_off() -> None:
    """The comparison above has loose metal to compare; in the other order there is none."""
    assert plainly(SHEET, WALLS)[-1] > 1
    assert plainly(SHEET, WALLS[::-1]) == [0.0] * 5
    (pocket,) = [face for face in loosened(SHEET, WALLS, KERF_MM) if face.since == 3 and face.area.contains(MIDDLE)]
    assert pocket.walls() == {0, 1, 2, 3}
