"""A nest as it is cut: which holes are marked, which left out, which cut more slowly."""

from __future__ import annotations

import pytest

from kerfwise.encoder.nest import Nest
from kerfwise.encoder.small_holes import HoleLimits, kept_hole_reason, uncut_hole_reasons, with_small_holes
from kerfwise.rules.case import circle, nest, part, rect

LIMITS = HoleLimits(least_mm=6, full_feed_mm=30, feed_share=0.6)
SPOT = HoleLimits(least_mm=6, under="spot", room_mm=3, full_feed_mm=30, feed_share=0.6)


def holed(*across_mm: float) -> Nest:
    """A plate with round holes of these diameters."""
    holes = [circle(50 + 60 * k, 60, mm / 2) for k, mm in enumerate(across_mm)]
    return nest(1000, 200, part("A", rect(10, 10, 900, 100), holes))


@pytest.mark.parametrize(
    ("across_mm", "kind", "share"),
    [
        (5.98, "mark", 1.0),
        (6.0, "hole", 0.6),
        (6.02, "hole", 0.6 + 0.4 * 0.02 / 24),
        (18, "hole", 0.8),
        (30, "hole", 1),
    ],
)
def test_exactly_at_the_least_diameter_a_hole_is_cut_and_slowest(across_mm: float, kind: str, share: float) -> None:
    made = with_small_holes(holed(across_mm), SPOT).contour("A.hole1")
    assert (made.kind, made.feed_share) == (kind, pytest.approx(share))


def test_a_nest_without_small_holes_is_left_as_it_is() -> None:
    plate = holed(30, 45)
    assert with_small_holes(plate, SPOT) is plate
    assert with_small_holes(holed(2), HoleLimits()).drawn is None


def test_a_spot_is_a_cross_at_the_middle_that_stays_in_its_hole() -> None:
    made = with_small_holes(holed(5, 1), SPOT)
    assert [c.kind for c in made.contours] == ["mark", "mark", "outer"]
    assert made.contour("A.hole1").line.bounds == pytest.approx((49, 59, 51, 61))
    assert made.contour("A.hole2").line.bounds == pytest.approx((109.6, 59.6, 110.4, 60.4))
    assert made.parts[0].holes == ()
    assert made.parts[0].polygon.area == pytest.approx(90000)


def test_what_is_done_again_begins_with_the_drawing() -> None:
    plate = holed(4, 12)
    spotted = with_small_holes(plate, SPOT)
    skipped = with_small_holes(spotted, HoleLimits(least_mm=6, under="skip"))
    assert skipped.drawn is plate
    assert (spotted.spotted, spotted.left_out) == (("A.hole1",), ())
    assert (skipped.spotted, skipped.left_out) == ((), ("A.hole1",))
    assert with_small_holes(skipped, HoleLimits()) is plate


def test_refusing_leaves_small_holes_where_they_are() -> None:
    made = with_small_holes(holed(4), LIMITS)
    assert made.contour("A.hole1").kind == "hole"
    assert made.contour("A.hole1").feed_share == pytest.approx(0.6)


def test_a_hole_without_room_for_a_pierce_counts_as_small_where_it_may_be_marked() -> None:
    limits = HoleLimits(least_mm=1, under="spot", room_mm=3)
    assert [c.kind for c in with_small_holes(holed(2.9, 3.0), limits).contours] == ["mark", "hole", "outer"]


def test_every_hole_that_is_not_cut_has_its_reason() -> None:
    limits = HoleLimits(least_mm=6, under="spot", room_mm=8)
    assert uncut_hole_reasons(with_small_holes(holed(5, 7, 9), limits), limits) == {
        "A.hole1": "A.hole1 is 5.00 mm across, less than small_holes.min_hole, 6 mm: it is marked at its middle "
        "(small_holes.under: spot)",
        "A.hole2": "A.hole2 is 7.00 mm across, and a pierce needs 8 mm to keep its clearance: it is marked at its "
        "middle (small_holes.under: spot)",
    }


def test_a_hole_with_a_part_in_it_is_neither_marked_nor_left_out() -> None:
    slot = part("A", rect(10, 10, 300, 100), [rect(30, 40, 200, 5)])
    plate = nest(400, 200, slot, part("B", rect(40, 41, 100, 3)))
    for limits in (SPOT, HoleLimits(least_mm=6, under="skip")):
        assert [c.kind for c in with_small_holes(plate, limits).contours] == ["hole", "outer", "outer"]
        assert kept_hole_reason(plate, plate.contour("A.hole1"), limits) == "B lies in it"


def test_a_bent_slot_has_no_middle_to_mark_but_may_be_left_out() -> None:
    bent = [(30, 60, 1.0), (70, 60), (66, 60, -1.0), (34, 60)]
    plate = nest(400, 200, part("A", rect(10, 10, 300, 100), [bent]))
    assert with_small_holes(plate, SPOT).contour("A.hole1").kind == "hole"
    assert with_small_holes(plate, HoleLimits(least_mm=6, under="skip")).left_out == ("A.hole1",)
