import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.encoder.readers.join import join
from kerfwise.tests.encoder.readers.drawings import pieces, segments, square
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
