"""Questions about many points of a curve are answered as those about one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.geometry import segment_arrays
from kerfwise.encoder.geometry.curve import lines_of, polygons_of
from kerfwise.encoder.geometry.segment_arrays import SegmentArrays
from kerfwise.rule_kit import Curve
from kerfwise.tests.encoder.geometry.rings import star_rings
from kerfwise.tests.encoder.geometry.test_curve_points import curves
from kerfwise.tests.tools.amount import examples


@examples(40)
@given(star_rings())
def test_points_tangents_and_projections_are_those_of_the_curve(drawn: Curve) -> None:
    arrays = SegmentArrays.of(drawn)
    at_mm = np.linspace(0, drawn.length_mm, 23)[1:-1] + 0.0123
    points, before, after = arrays.frames(at_mm)
    for k, s_mm in enumerate(at_mm.tolist()):
        assert points[k] == pytest.approx(drawn.point_at(s_mm), abs=1e-7)
        assert before[k] == pytest.approx(drawn.tangent_at(s_mm), abs=1e-7)
        assert after[k] == pytest.approx(drawn.tangent_at(s_mm), abs=1e-7)
    asked = np.random.default_rng(len(at_mm)).uniform(-25, 25, (30, 2))
    found_mm, distance_mm = arrays.project(asked)
    for k, point in enumerate(asked.tolist()):
        assert distance_mm[k] == pytest.approx(drawn.project(point)[1], abs=1e-7)
        assert drawn.point_at(found_mm[k]) == pytest.approx(drawn.nearest(point), abs=1e-4)


@examples(40)
@given(star_rings())
def test_far_segments_may_be_left_out(drawn: Curve) -> None:
    arrays = SegmentArrays.of(drawn)
    asked = np.random.default_rng(len(drawn.segments)).uniform(-25, 25, (150, 2))
    each = arrays.project(asked)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(segment_arrays, "COMPARED_AT_ONCE", 0)
        near = arrays.project(asked)
    assert [a.tolist() for a in near] == [a.tolist() for a in each]


@examples(30)
@given(st.lists(star_rings(), min_size=2, max_size=5), st.booleans())
def test_several_curves_at_once_are_answered_as_each_alone(drawn: list[Curve], one_is_large: bool) -> None:
    random = np.random.default_rng(len(drawn))
    alone = [SegmentArrays.of(curve) for curve in drawn]
    of = np.sort(random.integers(0, len(drawn), 40))
    at_mm, asked = random.uniform(-9, 99, 40), random.uniform(-25, 25, (40, 2))
    with pytest.MonkeyPatch.context() as patch:
        if one_is_large:
            patch.setattr(segment_arrays, "COMPARED_AT_ONCE", 60)
        patch.setattr(segment_arrays, "_TOGETHER", 50)
        for together in (SegmentArrays.of(*drawn), SegmentArrays.joined(alone)):
            every = [*together.frames(at_mm, of), *together.project(asked, of)]
            each = [[*a.frames(at_mm[of == k]), *a.project(asked[of == k])] for k, a in enumerate(alone)]
            for found, pieces in zip(every, zip(*each, strict=True), strict=True):
                assert found.tolist() == np.concatenate(pieces).tolist()
            assert together.turn_rad.tolist() == np.concatenate([a.turn_rad for a in alone]).tolist()
            for one, same in zip(together.each(), alone, strict=True):
                assert one.starts_mm.tolist() == same.starts_mm.tolist()
                assert one.tangent_out.tolist() == same.tangent_out.tolist()


def test_points_along_a_curve_of_many_vertices_are_compared_with_few_segments(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = SegmentArrays._project
    compared = 0

    def counted(self: SegmentArrays, points: Floats, among: Ints) -> tuple[Floats, Floats]:
        nonlocal compared
        compared += len(points) * len(among)
        return plain(self, points, among)

    monkeypatch.setattr(SegmentArrays, "_project", counted)
    pairs = []
    for n in (2000, 20_000):
        angle = np.arange(n) * 2 * np.pi / n
        radius = 400 + np.random.default_rng(n).uniform(-0.05, 0.05, n)
        ring = Curve(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(n)]))
        compared = 0
        SegmentArrays.of(ring).project(1.002 * ring.vertices[:, :2])
        pairs.append(compared)
    assert pairs[1] < 15 * pairs[0] < 2000 * 2000


def test_at_a_corner_the_tangents_before_and_after_differ() -> None:
    square = SegmentArrays.of(Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
    points, before, after = square.frames(np.array([0.0, 10.0, 40.0]))
    assert points.tolist() == [[0, 0], [10, 0], [0, 0]]
    assert before.tolist() == [[0, -1], [1, 0], [0, -1]]
    assert after.tolist() == [[1, 0], [0, 1], [1, 0]]
    assert square.turn_rad == pytest.approx([np.pi / 2] * 4)


@given(st.lists(curves, max_size=5), st.sampled_from([0.002, 0.01, 0.5]))
def test_lines_of_several_curves_are_those_of_each(several: list[Curve], tolerance_mm: float) -> None:
    lines = lines_of(several, tolerance_mm)
    assert [line.coords[:] for line in lines] == [curve.line(tolerance_mm).coords[:] for curve in several]


@given(st.lists(curves.filter(lambda curve: curve.closed), max_size=5), st.sampled_from([0.002, 0.5]))
def test_polygons_of_several_curves_are_those_of_each(several: list[Curve], tolerance_mm: float) -> None:
    areas = polygons_of(several, tolerance_mm)
    assert [area.wkb for area in areas] == [curve.polygon(tolerance_mm).wkb for curve in several]
