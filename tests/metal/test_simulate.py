"""Hand-made programs, each with one known fault, and faultless ones."""

from __future__ import annotations

import math
import time

import pytest

from kerfwise import Nest
from kerfwise.rule_kit import circle, nest, part, rect
from kerfwise.tests.encoder.facts.random_nests import moved
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.hand_made import (  # fmt: skip
    CUTS,
    HOLE,
    KERF_MM,
    A,
    B,
    around,
    inside,
    program,
    sheet,
    straight,
    with_cut,
)
from kerfwise.tests.metal.program import UnreadableProgram
from kerfwise.tests.metal.simulate import by_kind, simulate


def judged(text: str, drawn: Nest | None = None, **more: object) -> list[Finding]:
    return simulate(drawn or sheet(), text, KERF_MM, **more)  # type: ignore[arg-type]


def only(findings: list[Finding]) -> Finding:
    assert len(findings) == 1, "\n".join(map(str, findings))
    return findings[0]


def test_a_faultless_program_has_no_findings() -> None:
    assert judged(program()) == []


def test_a_kerf_in_a_part_is_found_with_place_and_depth() -> None:
    found = only(judged(with_cut("A.outer", around(20, 20, 50, 50, (14, 45), off=0.8))))
    assert (found.kind, found.cut, found.contours) == ("part-eroded", 3, ("A.outer", "A.outer"))
    assert found.size == pytest.approx(0.2, abs=0.01)
    assert judged(with_cut("A.outer", around(20, 20, 50, 50, (14, 45), off=0.96))) == []


def test_metal_that_two_parts_share_is_found_on_the_other_part() -> None:
    drawn = nest(200, 100, part("A", rect(20, 20, 50, 50)), part("C", rect(71.4, 20, 50, 50)))
    ring = ((96.4, 14), (96.4, 19), (70.4, 19), (70.4, 71), (122.4, 71), (122.4, 19), (96.4, 19))
    found = judged(program([("A.outer", A), ("C.outer", straight(*ring))]), drawn)
    eroded = [f for f in found if f.kind == "part-eroded"]
    assert [f.contours for f in eroded] == [("A.outer", "C.outer"), ("C.outer", "A.outer")]
    assert [f.size for f in eroded] == pytest.approx([0.6, 0.6], abs=0.01)
    assert "30.0 mm²" in eroded[0].text


def test_where_parts_may_touch_a_ring_may_take_of_its_neighbour_and_a_lead_may_not() -> None:
    """As in wood: A and C touch, each ring runs in the other part; the way to C then leads through A."""
    drawn = nest(200, 100, part("A", rect(20, 20, 50, 50)), part("C", rect(70, 20, 50, 50)))
    ring = around(70, 20, 50, 50, (69, 15))
    from_below = ["G0 X95 Y12", "M3 $0 S1", "G1 X95 Y19 F2500", *ring[9:12], *ring[3:9], "G1 X95 Y19", "M5 $0"]
    text = program([("A.outer", A), ("C.outer", from_below)])
    assert by_kind(judged(text, drawn))["part-eroded"] == 2
    assert "part-eroded" not in by_kind(judged(text, drawn, touching=True))
    across = around(70, 20, 50, 50, (60, 45))
    found = judged(program([("A.outer", A), ("C.outer", across)]), drawn, touching=True)
    assert [f.contours for f in found if f.kind == "part-eroded"] == [("C.outer", "A.outer")]


def test_a_ring_that_does_not_close_leaves_metal_and_the_part_hangs() -> None:
    open_ring = [*A[:-2], "G1 X19 Y41", "M5 $0"]
    kinds = by_kind(judged(with_cut("A.outer", open_ring)))
    assert kinds == {"left-uncut": 1, "part-not-free": 1}


def test_a_contour_that_is_never_cut_is_found() -> None:
    found = only(judged(program(cut for cut in CUTS if cut[0] != "A.hole1")))
    assert (found.kind, found.cut, found.contours) == ("left-uncut", 0, ("A.hole1",))
    assert found.size == pytest.approx(16 * math.pi, rel=1e-3)


def test_a_small_hole_that_is_left_out_stays_metal() -> None:
    without = program(cut for cut in CUTS if cut[0] != "A.hole1")
    assert judged(without, left_out=["A.hole1"], hole_limit_mm=16.1) == []
    assert by_kind(judged(program(CUTS), left_out=["A.hole1"], hole_limit_mm=16.1)).keys() >= {"part-eroded"}
    assert by_kind(judged(without, left_out=["A.hole1"], hole_limit_mm=10)) == {"hole-not-small": 1}


def test_a_small_hole_that_is_spotted_has_a_mark_at_its_middle() -> None:
    x, y = 45.0, 45.0
    spot = straight((x - 1, y), (x + 1, y), tool=1)
    others = [cut for cut in CUTS if cut[0] != "A.hole1"]
    assert judged(program([("A.mark1", spot), *others]), spotted=["A.hole1"], hole_limit_mm=16.1) == []
    assert by_kind(judged(program(others), spotted=["A.hole1"], hole_limit_mm=16.1)) == {"mark-not-made": 1}
    burnt = judged(program([("A.mark1", straight((x - 1, y), (x + 1, y))), *others]), spotted=["A.hole1"])
    assert "pierce-in-part" in by_kind(burnt)


@pytest.mark.parametrize("width", [1.0, 1.9, 2.4])
def test_a_slot_that_is_passed_over_is_found(width: float) -> None:
    """Narrower than the kerf it is a feature lost, wider it is metal left on the contour."""
    y0, y1 = 45 - width / 2, 45 + width / 2
    slotted = [(20, 20), (70, 20), (70, y0), (40, y0), (40, y1), (70, y1), (70, 70), (20, 70)]
    drawn = nest(200, 100, part("A", slotted))
    found = only(judged(program([("A.outer", A)]), drawn))
    assert found.kind == ("feature-lost" if width < KERF_MM else "left-uncut")
    assert found.size == pytest.approx(60 + width, abs=6)


def test_a_mark_that_is_not_made_is_found() -> None:
    found = only(judged(program(cut for cut in CUTS if cut[0] != "B.mark1")))
    assert (found.kind, found.contours, found.size) == ("mark-not-made", ("B.mark1",), pytest.approx(20))


def test_a_mark_made_with_the_torch_burns_the_part() -> None:
    kinds = by_kind(judged(with_cut("B.mark1", straight((100, 30), (120, 30)))))
    assert kinds == {"part-eroded": 1, "mark-not-made": 1, "pierce-in-part": 1}


def test_a_pierce_beside_an_older_kerf_is_found() -> None:
    """The kerf of A ends at x = 72; half a kerf away from it is 73."""
    near = around(90, 20, 50, 50, (72.5, 45))
    found = only(judged(with_cut("B.outer", near)))
    assert (found.kind, found.cut, found.contours) == ("pierce-over-void", 4, ("B.outer", "A.outer"))
    assert found.size == pytest.approx(0.5, abs=0.01)
    assert judged(with_cut("B.outer", around(90, 20, 50, 50, (73.0, 45)))) == []
    splashed = only(judged(with_cut("B.outer", around(90, 20, 50, 50, (73.0, 45))), splash_mm=1.0))
    assert splashed.kind == "pierce-over-void"


def test_the_kerf_of_a_lead_is_void_too() -> None:
    """A is pierced at (14, 45), far from its contour: a later pierce on that very lead is over nothing."""
    later = [("A.hole1", HOLE), ("A.outer", A), ("C.outer", around(5, 40, 5, 10, (14, 44)))]
    drawn = nest(200, 100, *sheet().parts[:1], part("C", rect(5, 40, 5, 10)))
    kinds = by_kind(judged(program(later), drawn))
    assert kinds["pierce-over-void"] == 1


def test_a_lead_across_an_older_kerf_is_found() -> None:
    """B is led in from below, along a way that runs over a corner of A's kerf and back into the street."""
    far = ["G0 X80 Y10", "M3 $0 S1", "G1 X71 Y19", "G1 X80 Y45", *B[2:]]
    found = only(judged(with_cut("B.outer", far)))
    assert (found.kind, found.contours) == ("lead-over-void", ("B.outer", "A.outer"))
    assert 1 < found.size < 4


def test_the_last_half_kerf_of_a_lead_may_meet_an_older_kerf() -> None:
    """In a street of 3 mm the ring itself runs along the other's kerf: that much of the lead cannot be spared."""
    drawn = nest(200, 100, part("A", rect(20, 20, 50, 50)), part("B", rect(73, 20, 50, 50)))
    from_below = around(73, 20, 50, 50, (60, 80))
    ring = [*from_below[3:-1]]
    lead = ["G0 X98 Y12", "M3 $0 S1", "G1 X98 Y19 F2500", "G1 X73 Y19", "G2 X72 Y20 I0 J1", "G1 X72 Y45"]
    text = program([("A.outer", A), ("B.outer", [*lead, *ring[:-2], "G1 X98 Y19", "M5 $0"])])
    kinds = by_kind(judged(text, drawn))
    assert "lead-over-void" not in kinds


def chained(top: float) -> list[Finding]:
    """A plate cut first, then two in one burn: its link leaves at 30° beside the corner of the first at `top`."""
    sizes = {"C": (27, 20, 30, top - 20), "A": (60, 20, 30, 40), "B": (60, 80, 30, 30)}
    drawn = nest(200, 130, *(part(name, rect(*size)) for name, size in sizes.items()))
    link = ["G1 X57.5 Y42.598", "G1 X54 Y85"]
    chain = [*around(*sizes["A"], (57.5, 50))[:-1], *link, *around(*sizes["B"], (0, 0))[2:]]
    return judged(program([("C.outer", around(*sizes["C"], (20, 25))), ("A.outer", chain)]), drawn)


def test_a_link_is_in_the_kerf_of_the_part_that_it_leaves_for_one_kerf() -> None:
    assert chained(38.0) == []


def test_for_its_second_half_kerf_it_is_in_no_other_part_s() -> None:
    assert only(chained(39.7)).kind == "lead-over-void"


def test_a_pierce_in_a_part_is_found() -> None:
    kinds = by_kind(judged(with_cut("B.outer", around(90, 20, 50, 50, (65, 45)))))
    assert kinds["pierce-in-part"] == 1
    assert kinds["lead-over-void"] == 1


def test_a_torch_lit_off_the_sheet_is_found() -> None:
    from_edge = with_cut("A.outer", around(20, 20, 50, 50, (-4, 45)))
    found = only(judged(from_edge))
    assert (found.kind, found.cut, found.size) == ("off-sheet", 3, pytest.approx(4))
    assert judged(from_edge, edge_starts=True) == []


def test_a_hole_of_a_part_that_has_dropped_is_found() -> None:
    names = ("B.mark1", "A.outer", "A.hole1", "B.outer")
    found = only(judged(program((n, dict(CUTS)[n]) for n in names)))
    assert (found.kind, found.cut, found.contours) == ("loose-part-burnt", 3, ("A.hole1",))


def test_a_guest_in_dropped_waste_is_found() -> None:
    drawn = nest(200, 100, part("H", rect(20, 20, 50, 50), [rect(25, 25, 40, 40)]), part("G", rect(40, 40, 10, 10)))
    host = straight((60, 45), (64, 45), (64, 64), (26, 64), (26, 26), (64, 26), (64, 46))
    guest = around(40, 40, 10, 10, (36, 45))
    lawful = [("G.outer", guest), ("H.hole1", host), ("H.outer", A)]
    assert judged(program(lawful), drawn) == []
    dropped = [lawful[1], lawful[0], lawful[2]]
    found = only(judged(program(dropped), drawn))
    assert (found.kind, found.cut) == ("loose-part-burnt", 2)


def test_a_cut_in_a_slug_that_has_dropped_is_found() -> None:
    extra = ("A.hole1", inside(45, 45, 4, (45, 45)))
    found = judged(program([*CUTS[:2], extra, *CUTS[2:]]))
    assert "loose-waste-burnt" in by_kind(found)


def test_a_contour_cut_again_is_found() -> None:
    kinds = by_kind(judged(program([*CUTS, ("A.outer", A)])))
    assert kinds["cut-twice"] == 1
    assert kinds["pierce-over-void"] == 1


def test_the_rest_of_a_program_is_judged_with_what_was_burnt_before() -> None:
    rest = program(CUTS[3:], first=4, head=["(RESUME AFTER CUT 3)"])
    assert judged(rest, before=program()) == []
    near = program([("B.outer", around(90, 20, 50, 50, (72.5, 45)))], first=4, head=["(RESUME AFTER CUT 3)"])
    assert only(judged(near, before=program())).kind == "pierce-over-void"
    missing = program(CUTS[3:], first=4, head=["(RESUME AFTER CUT 2)"])
    assert by_kind(judged(missing, before=program())) == {"left-uncut": 1, "resumed-wrong": 1}


def test_a_rest_that_begins_anew_is_found() -> None:
    again = program(CUTS, head=["(RESUME AFTER CUT 3)"])
    kinds = by_kind(judged(again, before=program()))
    assert kinds["resumed-wrong"] == 1
    assert kinds["cut-twice"] == 2
    assert judged(program(), before=program())[0].kind == "resumed-wrong"
    with pytest.raises(ValueError, match="takes up the work of another"):
        judged(again)


def test_a_program_that_counts_from_the_sheet_s_corner_is_laid_there() -> None:
    away = moved(sheet(), 3000, -20)
    assert judged(program(head=["(ORIGIN SHEET CORNER, AT X3000 Y-20 OF THE DRAWING)"]), away) == []
    assert "off-sheet" in by_kind(judged(program(head=["(ORIGIN DRAWING)"]), away))


def test_a_kerf_without_width_is_refused() -> None:
    with pytest.raises(ValueError, match="over 0"):
        simulate(sheet(), program(), 0.0)


def test_an_unknown_word_is_refused() -> None:
    with pytest.raises(UnreadableProgram, match="G43"):
        judged(program([*CUTS[:3], ("B.outer", ["G43 H1", *B])]))


@pytest.mark.slow
def test_a_plate_of_hundreds_of_contours_takes_seconds() -> None:
    """150 plates with a hole each; the processor works on them for some seconds."""
    columns, rows, pitch = 15, 10, 60.0
    places = [(10 + pitch * i, 10 + pitch * j) for i in range(columns) for j in range(rows)]
    parts = [part(f"P{k}", rect(x, y, 40, 40), [circle(x + 20, y + 20, 8)]) for k, (x, y) in enumerate(places)]
    cuts = [
        cut
        for k, (x, y) in enumerate(places)
        for cut in (
            (f"P{k}.hole1", inside(x + 20, y + 20, 8, (x + 20, y + 20))),
            (f"P{k}.outer", around(x, y, 40, 40, (x - 5, y + 20))),
        )
    ]
    began = time.process_time()
    assert judged(program(cuts), nest(columns * pitch + 10, rows * pitch + 10, *parts)) == []
    assert time.process_time() - began < 30
