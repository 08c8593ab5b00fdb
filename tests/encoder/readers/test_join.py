"""Ends that meet, pieces that are joined to rings, and lines drawn twice."""

import itertools
import math
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.join import Trail, endpoint_clusters, join, trace
from kerfwise.encoder.readers.open_lines import open_end_problems
from kerfwise.encoder.readers.trim import trim_overlaps
from kerfwise.tests.encoder.readers.drawings import square
from kerfwise.tests.encoder.readers.pieces import pieces, segments
from kerfwise.tests.tools.amount import examples

Points = list[tuple[float, float]]


def ring_areas(joined_rings: object) -> list[float]:
    return sorted(round(abs(r.curve.signed_area_mm2), 3) for r in joined_rings)  # type: ignore[attr-defined]


def test_loose_sides_become_a_ring() -> None:
    joined = join(pieces(*segments(square(0, 0, 10))), 0.1)
    assert ring_areas(joined.rings) == [100]
    assert joined.rings[0].curve.as_rows() == [[0, 0], [10, 0], [10, 10], [0, 10]]
    assert (joined.chains, joined.repeats, joined.specks, joined.gaps) == ((), (), (), ())


def test_arcs_stay_arcs_whichever_way_they_are_drawn() -> None:
    # a slot: two lines, two half-circles, one of them drawn backwards
    joined = join(pieces([(0, 0), (20, 0)], [(20, 10, -1), (20, 0)], [(0, 10), (20, 10)], [(0, 10, 1), (0, 0)]), 0.1)
    [slot] = joined.rings
    assert abs(slot.curve.signed_area_mm2) == pytest.approx(200 + math.pi * 25)


def test_gaps_within_the_tolerance_close_in_their_middle() -> None:
    joined = join(pieces([(0, 0), (10, 0)], [(10.08, 0), (10, 10)], [(10, 10), (0, 0)]), 0.1)
    [ring] = joined.rings
    assert ring.curve.as_rows() == [[0, 0], [10.04, 0], [10, 10]]
    assert [round(g.width_mm, 6) for g in joined.gaps] == [0.08]


def test_a_wider_gap_stays_open_unless_it_may_be_bridged() -> None:
    drawn = pieces([(0, 0), (10, 0)], [(10.5, 0), (10, 10)], [(10, 10), (0, 0)])
    assert len(join(drawn, 0.1).chains) == 1
    [ring] = join(drawn, 0.1, bridge_mm=1.0).rings
    assert [10.0, 0.0] in ring.curve.as_rows()
    assert [10.5, 0.0] in ring.curve.as_rows()


def test_closing_a_nearly_full_circle_does_not_bloat_it() -> None:
    bulge = math.tan(math.radians(359.9) / 4)
    end = (50 * math.cos(math.radians(359.9)), 50 * math.sin(math.radians(359.9)))
    [ring] = join(pieces([(50, 0, bulge), end]), 0.1).rings
    assert abs(ring.curve.signed_area_mm2) == pytest.approx(math.pi * 2500, rel=2e-3)
    assert ring.curve.length_mm == pytest.approx(math.tau * 50, rel=2e-3)


def test_squares_that_share_a_corner_are_two_rings() -> None:
    joined = join(pieces(*segments(square(0, 0, 10)), *segments(square(10, 10, 10))), 0.1)
    assert ring_areas(joined.rings) == [100, 100]


def test_a_side_that_both_parts_draw_is_in_both() -> None:
    joined = join(pieces(*segments(square(0, 0, 10)), *segments(square(10, 0, 10))), 0.1)
    assert ring_areas(joined.rings) == [100, 100]
    assert joined.repeats == ()


def test_a_side_drawn_once_between_two_parts_is_in_both() -> None:
    drawn = [*segments(square(0, 0, 10)), *segments(square(10, 0, 10))[:3]]
    joined = join(pieces(*drawn), 0.1)
    assert ring_areas(joined.rings) == [100, 100]
    assert joined.chains == ()


def test_every_side_drawn_twice_in_a_row_gives_two_rings_that_coincide() -> None:
    drawn = [side for side in segments(square(0, 0, 10)) for _ in range(2)]
    joined = join(pieces(*drawn), 0.1)
    assert ring_areas(joined.rings) == [100, 100]
    assert joined.chains == ()


def test_one_side_drawn_twice_is_a_repeat() -> None:
    drawn = [*segments(square(0, 0, 10)), [(10, 0), (0, 0)]]
    joined = join(pieces(*drawn), 0.1)
    assert ring_areas(joined.rings) == [100]
    assert len(joined.repeats) == 1
    assert joined.chains == ()


def test_a_piece_of_a_side_drawn_again_is_a_repeat() -> None:
    joined = join(pieces(*segments(square(0, 0, 10)), [(2, 0), (7, 0)]), 0.1)
    assert ring_areas(joined.rings) == [100]
    assert [r.curve.length_mm for r in joined.repeats] == [5]


def test_two_lines_that_overlap_in_a_side_still_close() -> None:
    drawn = pieces([(0, 0), (6, 0)], [(4, 0), (10, 0)], [(10, 0), (10, 10)], [(10, 10), (0, 10)], [(0, 10), (0, 0)])
    joined = join(drawn, 0.1)
    assert ring_areas(joined.rings) == [100]
    assert joined.rings[0].curve.length_mm == pytest.approx(40)
    assert [r.curve.length_mm for r in joined.repeats] == [2]


def test_the_same_open_line_twice_is_one_open_line() -> None:
    joined = join(pieces([(0, 0), (10, 0)], [(0, 0), (10, 0)]), 0.1)
    assert joined.rings == ()
    assert [c.curve.length_mm for c in joined.chains] == [10]
    assert [c.curve.length_mm for c in joined.repeats] == [10]


def test_a_whisker_on_a_ring_is_an_open_chain() -> None:
    joined = join(pieces(*segments(square(0, 0, 10)), [(10, 10), (15, 15)]), 0.1)
    assert ring_areas(joined.rings) == [100]
    assert [c.curve.as_rows() for c in joined.chains] == [[[15, 15], [10, 10]]]


def test_specks_are_set_aside() -> None:
    joined = join(pieces(*segments(square(0, 0, 10)), [(3, 3), (3, 3)]), 0.1)
    assert len(joined.rings) == len(joined.specks) == 1


def test_nothing_joins_to_nothing() -> None:
    assert join([], 0.1).rings == ()


@pytest.mark.slow
@examples(40)
@given(st.randoms(use_true_random=False), st.integers(1, 12))
def test_separate_polygons_survive_any_order_direction_and_jitter(rnd: random.Random, count: int) -> None:
    drawn: list[Points] = []
    expected = []
    for k in range(count):
        n = rnd.randint(3, 8)
        at = [(30 * k + 10 * math.cos(math.tau * j / n), 10 * math.sin(math.tau * j / n)) for j in range(n)]
        expected.append(n * 50 * math.sin(math.tau / n))
        for side in segments(at):
            jittered = [(x + rnd.uniform(-0.02, 0.02), y + rnd.uniform(-0.02, 0.02)) for x, y in side]
            drawn.append(jittered if rnd.random() < 0.5 else jittered[::-1])
    rnd.shuffle(drawn)
    joined = join(pieces(*drawn), 0.1)
    assert joined.chains == ()
    assert ring_areas(joined.rings) == pytest.approx(sorted(expected), abs=3)
    assert len(joined.rings) == count


@examples(30)
@given(st.randoms(use_true_random=False), st.integers(1, 4), st.integers(1, 4))
def test_a_grid_of_parts_with_common_sides_is_found_cell_by_cell(rnd: random.Random, columns: int, rows: int) -> None:
    sides = {
        tuple(sorted(s)) for i in range(columns) for j in range(rows) for s in segments(square(10 * i, 10 * j, 10))
    }
    drawn = [list(s) for s in sorted(sides)]
    rnd.shuffle(drawn)
    joined = join(pieces(*drawn), 0.1)
    assert ring_areas(joined.rings) == [100] * (columns * rows)
    assert joined.chains == ()


def test_lines_that_overlap_without_end_come_to_one() -> None:
    """To cut one back to the other makes neither shorter."""
    hook = [(3.910294, 3.836927), (3.911052, 3.837685), (3.90802, 3.836169)]
    loop = [(3.90802, 3.836169), (3.914842, 3.8392020000000002), (3.914842, 3.839202), (3.910294, 3.836927)]
    joined = join(pieces(hook, loop), 0.1)
    assert joined.repeats
    assert len(joined.rings) + len(joined.chains) >= 1


def numbers(ends: list[tuple[float, float]], lengths: list[float], tolerance: float = 0.1) -> list[int]:
    return endpoint_clusters(np.array(ends, dtype=float), np.array(lengths), tolerance).tolist()


def test_ends_a_rounding_apart_are_one_point_however_many() -> None:
    found = numbers([(0, 0), (9, 0), (9, 1e-4), (9, 9), (9, -1e-4), (0, 9)], [9, 9, 13])
    assert found[1] == found[2] == found[4]
    assert len(set(found)) == 4


@pytest.mark.parametrize(("gap", "meet"), [(0.0, True), (0.05, True), (0.0999, True), (0.11, False)])
def test_lone_ends_meet_within_the_tolerance(gap: float, meet: bool) -> None:
    found = numbers([(0, 0), (10, 0), (10 + gap, 0), (20, 0)], [10, 10])
    assert (found[1] == found[2]) is meet


def test_the_closest_pair_meets_and_the_third_stays_alone() -> None:
    found = numbers([(0, 0), (10, 0), (10.09, 0), (20, 0), (10.03, 0), (10, 20)], [10, 10, 20])
    assert found[1] == found[4] != found[2]


def test_short_chords_do_not_melt_into_one_point() -> None:
    steps = [k * 0.05 for k in range(41)]
    ends = [p for a, b in itertools.pairwise(steps) for p in ((a, 0.0), (b, 0.0))]
    assert len(set(numbers(ends, [0.05] * 40, tolerance=0.1))) == 41


def test_a_long_piece_closes_on_itself_and_a_short_one_does_not() -> None:
    assert len(set(numbers([(0, 0), (0.05, 0)], [100.0]))) == 1
    assert len(set(numbers([(0, 0), (0.05, 0)], [0.05]))) == 2


def traced(nodes: list[tuple[int, int]], twin: dict[int, int] | None = None) -> list[Trail]:
    group = list(range(len(nodes)))
    return trace(group, np.array(nodes), twin or {k: k for k in group})


def test_a_ring_drawn_in_any_direction_closes() -> None:
    assert traced([(0, 1), (2, 1), (2, 0)]) == [Trail(((0, True), (1, False), (2, True)), closed=True)]


def test_a_piece_that_returns_to_its_start_is_a_ring() -> None:
    assert traced([(4, 4)]) == [Trail(((0, True),), closed=True)]


def test_a_chain_is_followed_from_its_loose_end() -> None:
    assert traced([(1, 2), (0, 1), (3, 2)]) == [Trail(((1, True), (0, True), (2, False)), closed=False)]


def test_two_rings_that_share_a_corner_come_apart() -> None:
    # squares 0-1-2-3 and 2-4-5-6, drawn one after the other
    found = traced([(0, 1), (1, 2), (2, 3), (3, 0), (2, 4), (4, 5), (5, 6), (6, 2)])
    assert [sorted(k for k, _ in t.steps) for t in found] == [[0, 1, 2, 3], [4, 5, 6, 7]]
    assert all(t.closed for t in found)


def test_a_figure_eight_drawn_in_one_go_comes_apart_at_its_waist() -> None:
    found = traced([(0, 1), (1, 2), (2, 3), (3, 1), (1, 4), (4, 0)])
    assert sorted(sorted(k for k, _ in t.steps) for t in found) == [[0, 4, 5], [1, 2, 3]]


def test_a_line_drawn_twice_is_no_ring_of_two() -> None:
    found = traced([(0, 1), (0, 1), (1, 2), (2, 0)], twin={0: 0, 1: 0, 2: 2, 3: 3})
    assert [(len(t.steps), t.closed) for t in found] == [(3, True), (1, False)]


def test_every_piece_is_followed_once() -> None:
    nodes = [(0, 1), (1, 2), (2, 0), (2, 3), (3, 4), (4, 2), (4, 5), (6, 7)]
    steps = sorted(k for t in traced(nodes) for k, _ in t.steps)
    assert steps == list(range(len(nodes)))


def test_the_later_line_is_cut_back() -> None:
    left, shared = trim_overlaps(pieces([(0, 0), (6, 0)], [(9, 0), (4, 0)]), 0.1)
    assert [p.curve.as_rows() for p in left] == [[[0, 0], [6, 0]], [[9, 0], [6, 0]]]
    assert [p.curve.as_rows() for p in shared] == [[[6, 0], [4, 0]]]


def test_one_chain_may_overlap_itself() -> None:
    ring = [(6, 0), (0, 0), (0, 10), (10, 10), (10, 0), (4, 0)]
    left, shared = trim_overlaps(pieces(ring), 0.1)
    assert left[0].curve.as_rows()[-1] == [6, 0]
    assert len(shared) == 1


def test_lines_that_only_meet_are_left_alone() -> None:
    for other in ([(6, 0), (9, 0)], [(6, 0), (6, 5)], [(3, 0), (3, 5)]):
        left, shared = trim_overlaps(pieces([(0, 0), (6, 0)], other), 0.1)
        assert shared == []
        assert left[1].curve.as_rows() == [list(p) for p in other]


def test_arcs_are_left_alone() -> None:
    assert trim_overlaps(pieces([(0, 0, 0.001), (6, 0)], [(4, 0), (9, 0)]), 0.1)[1] == []


def test_nothing_overlaps_nothing() -> None:
    assert trim_overlaps([], 0.1) == ([], [])


def test_each_open_line_says_where_and_how_far() -> None:
    near, far = open_end_problems(pieces([(0, 0), (10, 0)], [(10.3, 0), (200, 0)]), ReadOptions())
    assert near == (
        "the line of 10.000 mm from (0.000, 0.000) to (10.000, 0.000) on layer '0' is open: the end at (10.000, 0.000) "
        "is 0.300 mm from any other: close the line in CAD, raise drawing.join_tolerance over 0.300 mm, "
        "or try --repair (in Python: repair=True)"
    )
    assert "the end at (10.300, 0.000) is 0.300 mm from any other" in far


def test_no_tolerance_is_advised_for_a_wide_gap() -> None:
    [said] = open_end_problems(pieces([(0, 0), (100, 0)]), ReadOptions())
    assert said.endswith("is 100.000 mm from any other: close the line in CAD")
