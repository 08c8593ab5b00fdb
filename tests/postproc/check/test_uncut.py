"""The check finds by itself what a program leaves uncut; it and the planner call the same features lost."""

from __future__ import annotations

import math

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.by_hand import nest, part, rect
from kerfwise.encoder.compensation import compensated
from kerfwise.encoder.cut import CutSequence
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.narrow import lost_features
from kerfwise.encoder.nest import Contour
from kerfwise.postproc.check import check_cuts
from kerfwise.postproc.check.rings import torch_rings
from kerfwise.postproc.check.torch_run import TorchRun
from kerfwise.postproc.check.uncut import features_lost
from kerfwise.rules.rule import Violation
from kerfwise.tests.encoder.narrow_shapes import FITS, KERF_MM, LOST, SHARP, contour, slot
from kerfwise.tests.postproc.plans import cut_of, profile
from kerfwise.tests.tools.amount import examples


def judged(drawn: Contour, kerf_mm: float = KERF_MM) -> list[Violation]:
    """What the ring of the check's own making leaves of a contour."""
    (ring,) = torch_rings([drawn], kerf_mm)
    assert ring is not None
    return features_lost([TorchRun(1, "cut 1", drawn, None, ring, None)], kerf_mm)


@pytest.mark.parametrize("shape", FITS)
def test_what_a_kerf_enters_is_kept(shape: str) -> None:
    assert judged(FITS[shape]) == []


@pytest.mark.parametrize("shape", [*LOST, *SHARP])
def test_what_it_does_not_enter_is_found(shape: str) -> None:
    drawn = (LOST | SHARP)[shape][0]
    found = judged(drawn)
    assert found
    assert {v.contours for v in found} == {(drawn.id,)}


def test_a_plan_over_a_slot_fails_the_check() -> None:
    """An 80 mm deep slot, 1 mm wide: the ring passes over it, and that is no cut of the contour."""
    sheet = nest(100, 140, part("P", [(x + 20, y + 20) for x, y, _ in slot(1.0, 80).curve.vertices.tolist()]))
    cuts = CutSequence((cut_of(sheet.contour("P.outer"), 0.05, "cw"),), "left")
    result = check_cuts(sheet, cuts, profile())
    assert "features-kept" in result.broken()
    (told,) = result.rule("features-kept").violations
    assert told.text.startswith("cut 1: 160.")
    assert told.text.endswith("beside the kerf: a slot, notch, neck or corner that is too narrow for it")


@pytest.mark.parametrize("kerf_mm", [0.0, 1.5])
def test_three_sides_cut_to_and_fro_leave_the_fourth(kerf_mm: float) -> None:
    drawn = Contour("P.outer", "P", "outer", Curve.of(rect(0, 0, 100, 10)))
    beside = kerf_mm / 2
    corners = [(-beside, -beside), (-beside, 10 + beside), (100 + beside, 10 + beside), (100 + beside, -beside)]
    path = [corners[k] for k in (0, 1, 0, 3, 2, 3, 0)]
    (found,) = features_lost([TorchRun(1, "cut 1", drawn, None, shapely.LineString(path), None)], kerf_mm)
    assert found.text.startswith("cut 1: 9")
    all_round = shapely.LineString([*corners, corners[0]])
    assert features_lost([TorchRun(1, "cut 1", drawn, None, all_round, None)], kerf_mm) == []


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
    found = features_lost([run], kerf_mm)
    if not refused:
        assert found == []
    if not found and refused:  # within the check's slack only
        assert all(lost.left_mm <= kerf_mm / 2 + 0.1 for lost in refused[drawn.id])
