"""Features that a kerf would lose are named with place, width and depth; corners that a round kerf leaves are none."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from kerfwise.encoder import narrow_features
from kerfwise.encoder.candidates import LeadOptions, build_candidates, lead_search
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.narrow_features import MOST_TOLD, Narrow, lost_walls
from kerfwise.encoder.nest import Contour, Nest, Part, Sheet
from kerfwise.encoder.questions import Questions
from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.encoder.narrow_shapes import FITS, KERF_MM, LOST, SHARP, comb, corner, lost_features, slot


@pytest.mark.parametrize("shape", FITS)
def test_what_a_kerf_enters_is_kept(shape: str) -> None:
    assert lost_features([FITS[shape]], KERF_MM) == {}


@pytest.mark.parametrize("shape", LOST)
def test_what_it_does_not_enter_is_named_with_width_and_depth(shape: str) -> None:
    contour, width_mm, depth_mm = LOST[shape]
    (lost, *_) = lost_features([contour], KERF_MM)[contour.id]
    assert lost.corner_deg is None
    assert lost.width_mm == pytest.approx(width_mm, abs=0.05)
    assert lost.depth_mm == pytest.approx(depth_mm, abs=0.3)


@pytest.mark.parametrize("shape", SHARP)
def test_a_corner_of_any_angle_is_no_feature_lost_unless_a_plant_limits_what_is_left(shape: str) -> None:
    contour, angle_deg = SHARP[shape]
    assert lost_features([contour], KERF_MM) == {}
    ((lost, _),) = lost_walls([contour], KERF_MM, corner_mm=0.3)[contour.id]
    assert lost.corner_deg == pytest.approx(angle_deg, abs=1)


def test_a_corner_leaves_what_geometry_says() -> None:
    ((lost, _),) = lost_walls([corner(30)], KERF_MM, corner_mm=0.5)["P.hole1"]
    assert lost.left_mm == pytest.approx(KERF_MM / 2 * (1 / math.sin(math.radians(15)) - 1), abs=0.01)
    assert lost.place == pytest.approx((0, 0), abs=0.01)


@pytest.mark.parametrize("kerf_mm", [0.2, 0.7, 1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("width_mm", [0.5, 1.0, 1.5, 2.0, 2.5, 3.0])
def test_a_slot_is_lost_if_it_is_no_wider_than_the_kerf(kerf_mm: float, width_mm: float) -> None:
    assert bool(lost_features([slot(width_mm, 80)], kerf_mm)) is (width_mm <= kerf_mm)


def test_every_slot_of_a_comb_is_found() -> None:
    assert len(lost_features([comb(8, 1.0)], KERF_MM)["P.outer"]) == 7


def sheet_of(*contours: Contour) -> Nest:
    """Outer contours as parts A, B, …, 100 mm from each other."""
    parts = []
    for k, c in enumerate(contours):
        name = "ABCDEF"[k]
        parts.append(Part(name, Contour(f"{name}.outer", name, "outer", c.curve.moved(20 + 200 * k, 20))))
    return Nest(Sheet.rectangle(200 * len(contours) + 20, 150), tuple(parts))


def test_all_faults_of_a_nest_are_one_message() -> None:
    sheet = sheet_of(slot(1.0, 80), slot(2.0, 80), slot(0.6, 5))
    with pytest.raises(InputError) as error:
        build_candidates(sheet, LeadOptions(kerf_mm=KERF_MM, narrow="refuse"))
    leave = "`cuts.narrow: leave` (the torch cuts straight across)"
    ways = "one pass along the middle opens it (cuts.narrow: slit), or change the drawing"
    assert str(error.value) == (
        f"2 contours of the nest cannot be cut as the options ask; {leave} frees all of them\n"
        "  - A.outer: a kerf of 1.5 mm does not enter the slot, notch or neck at (50.0, 120.0), 1.00 mm wide and "
        f"80.0 mm deep; {ways}; {leave} frees it\n"
        "  - C.outer: a kerf of 1.5 mm does not enter the slot, notch or neck at (450.0, 120.0), 0.60 mm wide and "
        f"5.0 mm deep; {ways}; {leave} frees it"
    )


@pytest.mark.parametrize("how", ["leave", "slit", "ask", "refuse"])
@pytest.mark.parametrize("depth_mm", [1.0, 20.0])
def test_a_slot_is_left_where_it_is_shallow_or_the_profile_says_so(how: Narrow, depth_mm: float) -> None:
    sheet = sheet_of(slot(1.0, depth_mm))
    options = LeadOptions(kerf_mm=KERF_MM, narrow=how)
    if how == "leave" or (how != "refuse" and depth_mm < 2 * KERF_MM):
        assert build_candidates(sheet, options)
    elif how == "ask":
        with pytest.raises(Questions) as asked:
            build_candidates(sheet, options)
        assert [choice.value for choice in asked.value.questions[0].choices] == ["slit", "leave", "refuse"]
    else:  # no slits are made here: a profile makes them when it takes the nest
        with pytest.raises(InputError, match="does not enter the slot, notch or neck"):
            build_candidates(sheet, options)


def test_a_limit_for_corners_refuses_sharper_ones() -> None:
    sheet = sheet_of(SHARP["notch of 45°"][0])
    assert build_candidates(sheet, LeadOptions(kerf_mm=KERF_MM, corner_mm=1.3))
    with pytest.raises(InputError, match=r"the corner of 45° at .*, which keeps 1\.21 mm; corners\.leave allows 1 mm"):
        build_candidates(sheet, LeadOptions(kerf_mm=KERF_MM, corner_mm=1.0))


def test_every_contour_with_a_narrow_feature_is_told_by_itself() -> None:
    plates = [Part(f"P{k}", Contour(f"P{k}.outer", f"P{k}", "outer", slot(1.0, 80).curve.moved(20 + 70 * k, 20)))
              for k in range(12)]  # fmt: skip
    with pytest.raises(InputError) as error:
        build_candidates(Nest(Sheet.rectangle(900, 150), tuple(plates)), LeadOptions(kerf_mm=KERF_MM, narrow="refuse"))
    assert [line.split(":")[0] for line in error.value.details] == [part.outer.id for part in plates]


def test_many_features_of_a_contour_are_one_line() -> None:
    with pytest.raises(InputError) as error:
        build_candidates(sheet_of(comb(18, 1.0)), LeadOptions(kerf_mm=KERF_MM, narrow="refuse"))
    (line,) = error.value.details
    assert line.count("slot") == MOST_TOLD
    assert "; and 11 more; one pass along the middle opens them" in line


def test_a_pocket_that_the_kerf_closes_is_named_with_the_width_of_its_mouth() -> None:
    drawn, width_mm, _ = LOST["pocket behind 1.0 mm"]
    with pytest.raises(
        InputError, match=r"A\.outer: a kerf of 1\.5 mm does not enter .* 1\.00 mm wide and 40\.0 mm deep"
    ):
        build_candidates(sheet_of(drawn), LeadOptions(kerf_mm=KERF_MM, narrow="refuse"))
    assert width_mm == 1.0


def test_plain_plates_have_candidates() -> None:
    plain = nest(200, 200, part("A", rect(20, 20, 60, 60), [rect(40, 40, 20, 20)]))
    assert build_candidates(plain, LeadOptions(kerf_mm=KERF_MM))


def test_without_a_kerf_nothing_is_lost() -> None:
    assert lost_features([slot(0.5, 80)], 0.0) == {}


def test_paths_of_very_many_chords_are_evened_out_before_they_are_grown(monkeypatch: pytest.MonkeyPatch) -> None:
    """A traced ring of 20,000 vertices has a path of over 100,000 chords; the time to grow it goes with the square."""
    a = np.arange(20_000) * math.tau / 20_000
    turns = np.column_stack([np.cos(a), np.sin(a), 0 * a])
    drawn, path = Contour("P.outer", "P", "outer", Curve(20 * turns)), Curve((20 + KERF_MM / 2) * turns)
    path = Curve(np.roll(path.vertices, 10_000, axis=0))  # begun elsewhere, it is not seen to run beside the contour
    far = Curve((20 + KERF_MM / 2 + 0.08) * turns)
    grown: list[int] = []
    plain = shapely.buffer

    def counted(shape: object, *args: object, **named: object) -> object:
        grown.extend(np.atleast_1d(shapely.get_num_coordinates(shape)).tolist())
        return plain(shape, *args, **named)

    monkeypatch.setattr(shapely, "buffer", counted)
    assert lost_features([drawn], KERF_MM, {"P.outer": path}) == {}
    assert max(grown) < 1000
    assert narrow_features.MANY_CHORDS < 20_000
    assert len(narrow_features.lost_walls([drawn], KERF_MM, {"P.outer": far})) <= 1


@pytest.mark.parametrize("shape", LOST)
def test_an_evened_path_loses_the_same(shape: str, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = lost_features([LOST[shape][0]], KERF_MM)
    monkeypatch.setattr(narrow_features, "MANY_CHORDS", 0)
    evened = lost_features([LOST[shape][0]], KERF_MM)
    for name, features in exact.items():
        assert [f.place for f in evened[name]] == [pytest.approx(f.place, abs=0.05) for f in features]
        assert [f.depth_mm for f in evened[name]] == [pytest.approx(f.depth_mm, abs=0.05) for f in features]


def test_what_helps_against_a_slot_is_thought_of_once_not_for_every_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    plain = lead_search.slits_of
    monkeypatch.setattr(lead_search, "slits_of", lambda contour, mm: asked.append(contour.id) or plain(contour, mm))
    with pytest.raises(InputError, match="slot, notch or neck"):
        build_candidates(nest(400, 300, Part("P", comb(5, 1.0))), LeadOptions(narrow="refuse"))
    assert asked == ["P.outer"]
