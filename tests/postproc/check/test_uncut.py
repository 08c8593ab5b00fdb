"""The check finds by itself what a program leaves uncut; it and the planner call the same features lost."""

from __future__ import annotations

import math

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour
from kerfwise.encoder.torch_path import compensated
from kerfwise.postproc.check import check_cuts
from kerfwise.postproc.check.features_kept import Allowed, Uncut, features_lost
from kerfwise.postproc.check.torch_run import TorchRun, torch_rings
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.judging.violation import Violation
from kerfwise.tests.encoder.narrow_shapes import FITS, KERF_MM, LOST, SHARP, contour, lost_features, slot
from kerfwise.tests.postproc.plans import cut_of, profile
from kerfwise.tests.tools.amount import examples


def judged(drawn: Contour, kerf_mm: float = KERF_MM) -> list[Violation]:
    """What the ring of the check's own making leaves of a contour."""
    (ring,) = torch_rings([drawn], kerf_mm)
    assert ring is not None
    return features_lost([TorchRun(1, "cut 1", drawn, None, ring, None)], kerf_mm).lost


def left(drawn: Contour, allowed: Allowed) -> Uncut:
    """What is left, and what of it may be."""
    (ring,) = torch_rings([drawn], KERF_MM)
    assert ring is not None
    return features_lost([TorchRun(1, "cut 1", drawn, None, ring, None)], KERF_MM, allowed=allowed)


@pytest.mark.parametrize("shape", FITS)
def test_what_a_kerf_enters_is_kept(shape: str) -> None:
    assert judged(FITS[shape]) == []


@pytest.mark.parametrize("shape", LOST)
def test_what_it_does_not_enter_is_found(shape: str) -> None:
    drawn = LOST[shape][0]
    found = judged(drawn)
    assert found
    assert {v.contours for v in found} == {(drawn.id,)}


@pytest.mark.parametrize("shape", SHARP)
def test_what_a_round_kerf_leaves_of_a_corner_is_told_and_no_fault(shape: str) -> None:
    drawn, angle_deg = SHARP[shape]
    left_mm = KERF_MM / 2 * (1 / math.sin(math.radians(angle_deg) / 2) - 1)
    found = left(drawn, Allowed())
    assert found.lost == []
    assert [one.corner for one in found.left] == [True]
    if angle_deg != 30 or drawn.kind == "hole":  # the notch of 30° is so small that less of it is left
        assert found.left[0].left_mm == pytest.approx(left_mm, rel=0.02)
    left_mm = found.left[0].left_mm
    assert found.told() == [
        f"a corner keeps {found.left[0].left_mm:.2f} mm that a round kerf does not reach: {drawn.id} at "
        f"({found.left[0].at[0]:z.1f}, {found.left[0].at[1]:z.1f})"
    ]
    assert left(drawn, Allowed(corner_mm=left_mm + 0.1)).lost == []
    (over,) = left(drawn, Allowed(corner_mm=left_mm - 0.1)).lost
    assert over.text.endswith(f"the profile allows {left_mm - 0.1:g} mm of a corner (corners.leave)")


@pytest.mark.parametrize("shape", LOST)
def test_a_narrow_feature_is_left_where_the_profile_has_it_cut_across(shape: str) -> None:
    drawn, _, depth_mm = LOST[shape]
    found = left(drawn, Allowed(deep_mm=math.inf))
    assert found.lost == []
    assert not any(one.corner for one in found.left)
    assert max(one.left_mm for one in found.left) <= depth_mm + 0.05
    assert left(drawn, Allowed(deep_mm=0.3)).lost


def test_what_the_torch_could_have_reached_is_never_left() -> None:
    """A path that cuts straight across a wide slot is no cut of it, whatever may be left of narrow ones."""
    drawn, across = slot(4.0, 20), slot(1.0, 20)
    (ring,) = torch_rings([across], KERF_MM)
    run = TorchRun(1, "cut 1", drawn, None, ring, None)
    (found,) = features_lost([run], KERF_MM, allowed=Allowed(deep_mm=math.inf)).lost
    assert found.text.endswith("the torch could reach there")


def test_a_plan_over_a_slot_fails_the_check() -> None:
    """An 80 mm deep slot, 1 mm wide: the ring passes over it, and that is no cut of the contour."""
    sheet = nest(100, 140, part("P", [(x + 20, y + 20) for x, y, _ in slot(1.0, 80).curve.vertices.tolist()]))
    cuts = CutSequence((cut_of(sheet.contour("P.outer"), 0.05, "cw"),), "left")
    result = check_cuts(sheet, cuts, profile())
    assert "features-kept" in result.broken()
    (told,) = result.rule("features-kept").violations
    assert told.text.startswith("cut 1: 160.")
    assert told.text.endswith("beside the kerf: a slot, notch or neck that is too narrow for it")


@pytest.mark.parametrize("kerf_mm", [0.0, 1.5])
def test_three_sides_cut_to_and_fro_leave_the_fourth(kerf_mm: float) -> None:
    drawn = Contour("P.outer", "P", "outer", Curve.of(rect(0, 0, 100, 10)))
    beside = kerf_mm / 2
    corners = [(-beside, -beside), (-beside, 10 + beside), (100 + beside, 10 + beside), (100 + beside, -beside)]
    path = [corners[k] for k in (0, 1, 0, 3, 2, 3, 0)]
    (found,) = features_lost([TorchRun(1, "cut 1", drawn, None, shapely.LineString(path), None)], kerf_mm).lost
    assert found.text.startswith("cut 1: 9")
    all_round = shapely.LineString([*corners, corners[0]])
    assert features_lost([TorchRun(1, "cut 1", drawn, None, all_round, None)], kerf_mm).lost == []


@pytest.mark.slow
@examples(150)
@given(
    st.lists(st.tuples(st.floats(12, 40), st.floats(0.6, 1.4)), min_size=4, max_size=14),
    st.sampled_from(["outer", "hole"]),
    st.sampled_from([0.2, 0.7, 1.5, 3.0]),
)
def test_planner_and_check_agree_on_stars(spokes: list[tuple[float, float]], kind: str, kerf_mm: float) -> None:
    """Stars with spokes of any length: corners of every angle, both ways. Where nothing is refused nothing is lost."""
    total = sum(share for _, share in spokes)
    angle, rows = 0.0, []
    for radius_mm, share in spokes:
        rows.append((radius_mm * math.cos(angle), radius_mm * math.sin(angle)))
        angle += math.tau * share / total
    drawn = contour(rows, kind)  # type: ignore[arg-type]
    try:
        path = compensated(drawn, kerf_mm)
    except InputError:
        return
    refused = lost_features([drawn], kerf_mm, {drawn.id: path})
    run = TorchRun(1, "cut 1", drawn, None, path.line(0.005), None)
    found = features_lost([run], kerf_mm).lost
    if not refused:
        assert found == []
    if not found and refused:  # within the check's slack only
        assert all(lost.left_mm <= kerf_mm / 2 + 0.1 for lost in refused[drawn.id])
