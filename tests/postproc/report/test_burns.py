"""Pictures of programs without a plan: each travel is drawn, the way home among them."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.postproc.report.simple_pictures import Panel, draw_burns


def burn(*points: Point) -> Burn:
    return Burn(0, 1, Curve.of(points, closed=False), 0.0, 0.0, "")


def travels(panel: Panel) -> int:
    """How many dashed lines a picture has."""
    drawn = draw_burns([panel], ".svg", "old.nc")
    return sum("stroke-dasharray" in one.attrib for one in ElementTree.fromstring(drawn).iter())


BURNS = [burn((10, 10), (20, 10)), burn((20, 20), (10, 20))]


@pytest.mark.parametrize(("end", "count"), [((0.0, 0.0), 3), ((10.0, 20.0), 2), ((300.0, 0.0), 3)])
def test_the_way_home_is_drawn_where_the_program_has_one(end: Point, count: int) -> None:
    assert travels(Panel("old.nc", "2 burns", BURNS, (0.0, 0.0), end)) == count


def test_a_burn_that_begins_where_the_one_before_ends_has_no_travel() -> None:
    on = [burn((10, 10), (20, 10)), burn((20, 10), (20, 20))]
    assert travels(Panel("old.nc", "2 burns", on, (10.0, 10.0), (20.0, 20.0))) == 0
