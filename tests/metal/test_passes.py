"""Pierce passes and bridges written by hand: programs with exactly one fault, and one beside each that has none."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.rule_kit import rect
from kerfwise.tests.encoder.test_bridges import bridge, read
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.hand_made import KERF_MM, A, B, program, sheet, straight
from kerfwise.tests.metal.simulate import simulate

HOLES = ((45.0, 45.0), (14.0, 45.0), (80.0, 45.0))


def passed(*holes: tuple[float, float], text: str = "") -> list[Finding]:
    """The findings of the faultless program after a pass of these holes."""
    dots = [block for hole in holes for block in ("(PIERCE)", *straight(hole))]
    text = (text or program()).replace("(MARK 1", "\n".join([*dots, "(MARK 1"]), 1)
    return simulate(sheet(), text, KERF_MM, pierce_pass=True)


def test_cuts_begin_at_holes() -> None:
    assert passed(*HOLES) == []
    assert passed((45.03, 45.0), *HOLES[1:]) == []


@pytest.mark.parametrize("k", range(3))
def test_a_hole_that_is_missing(k: int) -> None:
    found = passed(*(hole for hole in HOLES if hole != HOLES[k]))
    assert [(f.kind, f.place, f.cut) for f in found] == [("not-pierced", HOLES[k], k + 2)]


def test_a_hole_that_is_not_used() -> None:
    (found,) = passed((180.0, 90.0), *HOLES)
    assert (found.kind, found.place) == ("pierce-unused", (180.0, 90.0))
    kinds = {f.kind for f in passed((45.1, 45.0), *HOLES[1:])}
    assert kinds >= {"pierce-unused", "not-pierced"}


def test_a_lead_over_the_hole_of_another() -> None:
    """B's lead comes in along y = 45, from x = 80: a hole at 85 lies on it."""
    kinds = {f.kind for f in passed((85.0, 45.0), *HOLES)}
    assert kinds == {"pierce-unused", "lead-over-void"}
    assert {f.kind for f in passed((85.0, 47.5), *HOLES)} == {"pierce-unused"}


def test_holes_are_judged_as_pierces() -> None:
    assert {f.kind for f in passed((100.0, 60.0), *HOLES)} >= {"pierce-in-part", "pierce-unused"}
    late = program().replace("(CUT 4", "\n".join(["(PIERCE)", *straight((43.0, 42.0)), "(CUT 4"]))
    assert {f.kind for f in passed(*HOLES, text=late)} >= {"loose-waste-burnt", "pierce-unused"}
    assert "pierce-over-void" in {f.kind for f in passed((15.5, 45.0), *HOLES)}


def test_a_strip_that_is_cut(tmp_path: Path) -> None:
    """A and B are joined on the drawing; cut round each alone they come apart."""
    rows = [{"id": name, "outer": rect(x, 20, 50, 50)} for name, x in (("A", 20), ("B", 90))]
    plate, joined = (
        read(tmp_path, rows, bridges, sheet={"width": 200, "height": 100})
        for bridges in ([], [bridge("A", "B", [70, 45], [90, 45], 6)])
    )
    apart = program([("A.outer", A), ("B.outer", B)])
    assert simulate(plate, apart, KERF_MM) == []
    kinds = {f.kind for f in simulate(joined, apart, KERF_MM)}
    assert "bridge-cut" in kinds
    assert "part-eroded" in kinds
    ring = [(45, 10), (45, 19), (19, 19), (19, 71), (71, 71), (71, 49), (89, 49), (89, 71), (141, 71), (141, 19),
            (89, 19), (89, 41), (71, 41), (71, 19), (45, 19)]  # fmt: skip
    around = straight(*((float(x), float(y)) for x, y in ring))
    assert simulate(joined, program([("A+B.outer", around)]), KERF_MM) == []
    thin = [(x, 45 + (y - 45) / 4 if y in (49, 41) else y) for x, y in ring]
    found = simulate(joined, program([("A+B.outer", straight(*((float(x), float(y)) for x, y in thin)))]), KERF_MM)
    assert "part-eroded" in {f.kind for f in found}
