"""Slots narrower than the kerf that one pass along their middle opens, and those that none does."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.narrow_features import lost_walls
from kerfwise.encoder.nest import Contour
from kerfwise.encoder.slits import blocked_slits, narrow_because, slits_of, with_slits
from kerfwise.rules.case import nest, part
from kerfwise.tests.encoder.narrow_shapes import (
    FITS,
    KERF_MM,
    comb,
    contour,
    lost_features,
    neck,
    plate,
    pocket,
    relief,
    round_slot,
    slot,
)  # fmt: skip
from kerfwise.tests.tools.amount import examples

HALF = KERF_MM / 2
HOLE = contour([(0, 0), (40, 0), (40, 14.5), (60, 14.5), (60, 15.5), (40, 15.5), (40, 30), (0, 30)], "hole")


def slanted(angle_deg: float, width_mm: float, depth_mm: float) -> Contour:
    """A plate with a slot that leans from its upper side, its end square to its sides."""
    a = math.radians(angle_deg)
    into, across = np.array([-math.sin(a), -math.cos(a)]), np.array([math.cos(a), -math.sin(a)]) * width_mm / 2
    mouth, end = np.array([30.0, 100.0]), np.array([30.0, 100.0]) + depth_mm * into
    half = width_mm / 2 / math.cos(a)
    return plate((mouth[0] + half, 100), tuple(end + across), tuple(end - across), (mouth[0] - half, 100))


def forked() -> Contour:
    """A slot that goes on to both sides, as a T."""
    return plate((30.5, 100), (30.5, 80), (40, 80), (40, 79), (20, 79), (20, 80), (29.5, 80), (29.5, 100))


def bent() -> Contour:
    """A slot with a corner in it."""
    return plate((30.5, 100), (30.5, 80), (40, 80), (40, 79), (29.5, 79), (29.5, 100))


def curved() -> Contour:
    """A slot along an arc, 1 mm wide."""
    quarter = math.tan(math.pi / 8)
    return plate((30.5, 100, -quarter), (10.5, 80), (10.5, 79, quarter), (31.5, 100))


OPENED = {
    "a deep slot, 1 mm wide": (slot(1.0, 80), (30, 100 + math.sqrt(HALF**2 - 0.5**2)), (30, 20 + HALF), 0.25),
    "one 0.5 mm wide": (slot(0.5, 80), (30, 100 + math.sqrt(HALF**2 - 0.25**2)), (30, 20 + HALF), 0.5),
    "one 1.4 mm wide": (slot(1.4, 80), (30, 100 + math.sqrt(HALF**2 - 0.7**2)), (30, 20 + HALF), 0.05),
    "one as wide as the kerf": (slot(1.5, 80), (30, 100.0), (30, 20 + HALF), 0.0),
    "a notch less deep than half the kerf": (slot(1.0, 0.7), (30, 100.559), (30, 99.3 + HALF), 0.25),
    "a round end": (round_slot(1.0, 40), (30, 100.559), (30, 60 - 0.5 + HALF), 0.25),
    "a slot in a hole": (HOLE, (40 - 0.559, 15), (60 - HALF, 15), 0.25),
}
UNFIT = {
    "a fork": (forked(), "it forks or bends: one pass would leave some of it"),
    "a bend": (bent(), "it forks or bends: one pass would leave some of it"),
    "an arc": (curved(), "it has no straight middle"),
    "a pocket behind a narrow mouth": (pocket(1.0), "it is wider than the kerf behind its mouth"),
    "two chambers": (neck(1.0), "it is wider than the kerf behind its mouth"),
}


@pytest.mark.parametrize("shape", OPENED)
def test_the_pass_begins_on_the_torchs_path_and_ends_half_a_kerf_before_the_end(shape: str) -> None:
    drawn, start, end, loss_mm = OPENED[shape]
    (slit,), unfit = slits_of(drawn, KERF_MM)
    assert unfit == ()
    assert slit.line.point_at(0.0) == pytest.approx(start, abs=0.01)
    assert slit.line.end == pytest.approx(end, abs=0.01)
    assert slit.loss_mm == pytest.approx(loss_mm, abs=0.01)


@pytest.mark.parametrize("shape", UNFIT)
def test_what_has_no_straight_middle_is_not_slit(shape: str) -> None:
    drawn, why = UNFIT[shape]
    slits, unfit = slits_of(drawn, KERF_MM)
    assert slits == ()
    assert {one.why for one in unfit} == {why}


@pytest.mark.parametrize("shape", FITS)
def test_what_the_kerf_enters_is_not_slit(shape: str) -> None:
    assert slits_of(FITS[shape], KERF_MM) == ((), ())


def test_a_bend_relief_is_slit() -> None:
    """One side of it is the flange beside the bend, so that the torch's path runs beside its middle."""
    (slit,), _ = slits_of(relief(1.0, 6.0), KERF_MM)
    assert slit.line.point_at(0.0) == pytest.approx((29.5, 30.559), abs=0.02)
    assert slit.line.end == pytest.approx((29.5, 24 + HALF), abs=0.01)


@pytest.mark.slow
@examples(60)
@given(st.floats(-50, 50), st.floats(0.2, 1.45), st.floats(1.5, 25), st.sampled_from(["outer", "hole"]))
def test_a_slit_opens_all_of_its_slot_and_takes_no_more_than_it_says(
    angle_deg: float, width_mm: float, depth_mm: float, kind: str
) -> None:
    """Leaning slots of plates, and of holes with the same slots."""
    drawn = slanted(angle_deg, width_mm, depth_mm)
    if kind == "hole":
        notch = [(x, 200 - y) for x, y, _ in drawn.curve.vertices.tolist()[3:-1]]
        drawn = contour([(0, 60), (60, 60), (60, 100), *notch, (0, 100)], "hole")
    lost = lost_features([drawn], KERF_MM)
    slits, unfit = slits_of(drawn, KERF_MM)
    if unfit:
        assert lost
        return
    assert len(slits) == len(lost.get(drawn.id, ()))
    for slit in slits:
        assert lost_walls([drawn], KERF_MM, None, {drawn.id: [slit.line]}) == {}
        burnt = shapely.buffer(slit.line.line(), HALF)
        area = drawn.curve.polygon()
        taken = burnt & area if drawn.kind == "outer" else burnt - area
        depths = shapely.distance(drawn.line, shapely.points(shapely.get_coordinates(shapely.segmentize(taken, 0.05))))
        assert depths.max(initial=0) <= slit.loss_mm + 0.03
        assert slit.loss_mm == pytest.approx((KERF_MM - slit.width_mm) / 2)


def test_slits_are_numbered_along_the_contours_of_their_part() -> None:
    plate_ = part("A", [(x + 5, y + 5) for x, y, _ in comb(4, 1.0).curve.vertices.tolist()])
    made = with_slits(nest(100, 100, plate_), KERF_MM)
    assert [c.id for c in made.contours] == ["A.slit1", "A.slit2", "A.slit3", "A.outer"]
    assert {c.slot_of for c in made.contours if c.kind == "slit"} == {"A.outer"}
    assert made.drawn is not None
    assert [c.id for c in made.drawn.contours] == ["A.outer"]
    told = narrow_because(made, KERF_MM)
    assert told["A.slit1"].startswith("A.slit1 opens the slot of A.outer at (")
    assert told["A.slit1"].endswith(
        "in one pass: it becomes 1.5 mm wide, the part loses 0.25 mm at each side (cuts.narrow: slit)"
    )


def test_a_nest_without_narrow_slots_stays_itself() -> None:
    plain = nest(100, 100, part("A", [(10, 10), (60, 10), (60, 60), (10, 60)]))
    assert with_slits(plain, KERF_MM) is plain


def test_a_web_that_two_passes_would_burn_is_in_the_way() -> None:
    """Two slots 1 mm wide with 0.4 mm between them: each pass takes 0.25 mm of that."""
    rows = [(10, 10), (60, 10), (60, 60), (32.9, 60), (32.9, 40), (31.9, 40), (31.9, 60), (31.5, 60), (31.5, 40),
            (30.5, 40), (30.5, 60), (10, 60)]  # fmt: skip
    made = with_slits(nest(100, 100, part("A", rows)), KERF_MM)
    assert {one.why for one in blocked_slits(made, made.contour("A.outer"), KERF_MM)} == {
        "the pass would burn through the web to A.slit2",
        "the pass would burn through the web to A.slit1",
    }


def test_moved_and_mirrored_slots_have_the_same_slits() -> None:
    one = slanted(20, 1.0, 20)
    rows = one.curve.vertices
    moved = Contour("P.outer", "P", "outer", one.curve.moved(123.4, -77.7))
    mirrored = contour([(-x, y) for x, y, _ in rows[::-1].tolist()])
    (slit,), (there,), (other,) = (slits_of(c, KERF_MM)[0] for c in (one, moved, mirrored))
    assert Curve.of(there.line.as_rows(), closed=False).moved(-123.4, 77.7).as_rows() == [
        pytest.approx(row, abs=1e-6) for row in slit.line.as_rows()
    ]
    assert other.line.as_rows() == [pytest.approx([-x, y], abs=1e-6) for x, y in slit.line.as_rows()]


def test_of_too_many_features_none_is_slit_and_all_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    many = comb(4, 1.0)
    slits_of.cache_clear()
    monkeypatch.setattr("kerfwise.encoder.slits.MOST_FEATURES", 1)
    lost = lost_features([many], KERF_MM)[many.id]
    slits, unfit = slits_of(many, KERF_MM)
    slits_of.cache_clear()
    assert (slits, tuple(one.slot for one in unfit), len(lost) > 1) == ((), lost, True)
    assert f"has {len(lost)} such features, and slits are tried for up to 1 of a contour" in unfit[0].why
