"""Which parts lie in whose shadow is told by boxes where these show it: shapely says the same of every pair."""

import json

import numpy as np
import pytest
import shapely
from hypothesis import given

from kerfwise.encoder.cut import Side
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.json_nest import read_json
from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.rules.catalogue.level_ahead import AWAY, GRAZE_MM, _ahead
from kerfwise.tests.rules.test_statements_agree import sheets
from kerfwise.tests.tools.amount import examples


def by_rays(sheet: Nest, side: Side) -> set[tuple[str, str]]:
    """Pairs of parts in the same place, the first of which looks at the second away from the start side."""
    found = set()
    holes = [hole for part in sheet.parts for hole in part.holes]
    place = {
        part.id: {h.id for h in holes if h.part != part.id and h.polygon.contains(part.polygon.representative_point())}
        for part in sheet.parts
    }
    for one in sheet.parts:
        at = np.array(one.outer.polygon.centroid.coords[0])
        ray = shapely.LineString([at, at + 1e5 * np.array(AWAY[side])])
        for other in sheet.parts:
            outline = other.outer
            inside = outline.polygon.contains(shapely.Point(at)) and outline.line.distance(shapely.Point(at)) > GRAZE_MM
            beside = one is not other and place[one.id] == place[other.id] and not inside
            if beside and ray.distance(outline.line) <= GRAZE_MM:
                found.add((one.outer.id, other.outer.id))
    return found


@examples(15)
@given(sheets())
def test_shadows_of_small_sheets(sheet: Nest) -> None:
    for side in AWAY if sheet.parts else ():
        assert set(_ahead(sheet, side)) == by_rays(sheet, side)  # type: ignore[arg-type, index]


@pytest.mark.parametrize("side", AWAY)
def test_shadows_of_a_plate(side: Side) -> None:
    plate = read_json(json.dumps(make_sheet(3, 60)).encode(), ReadOptions())
    ahead = _ahead(plate, side)
    assert len(set(ahead)) == len(ahead) > 50
    assert set(ahead) == by_rays(plate, side)
