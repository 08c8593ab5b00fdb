"""Rule pierce and links: a linked cut is not pierced, and its link keeps off older kerfs but for its two ends."""

from __future__ import annotations

from dataclasses import replace

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.catalogue.pierce import Pierce, PierceOptions

ROW = nest(340, 120, *(part(name, rect(x, 30, 80, 50)) for name, x in (("A", 20), ("B", 120), ("C", 220))))
FROM, TO = (100.75, 40.0), (119.25, 40.0)
A = Cut("A.outer", (100, 40), "cw", (106, 45), Curve.of([(106, 45), FROM], False), Curve.of([FROM], False))
B = Cut("B.outer", (120, 40), "cw", FROM, Curve.of([FROM, TO], False), Curve.of([TO], False), linked=True)


def broken(*cuts: Cut) -> list[str]:
    return [v.text for v in Pierce().violations(ROW, CutSequence(cuts), PierceOptions())]


def test_a_linked_cut_is_not_pierced() -> None:
    assert broken(A, B) == []
    pierced = broken(A, replace(B, linked=False))
    assert "B.outer (cut 2) is pierced 0.75 mm from A.outer, less than 1.5 mm" in pierced
    assert any("is pierced in the kerf of A.outer (cut 1)" in text for text in pierced)


def test_a_link_over_the_kerf_of_a_third_contour() -> None:
    way = Curve.of([FROM, (110, 40), (110, 90), (212, 90), (212, 60), (219.25, 60)], False)
    c = Cut("C.outer", (220, 60), "cw", FROM, way, Curve.of([(219.25, 60)], False), linked=True)
    b = replace(B, pierce=(112, 95), lead_in=Curve.of([(112, 95), (112, 85), TO], False), linked=False)
    assert broken(A, c) == []
    assert broken(b, A, c) == ["the link of C.outer (cut 3) crosses the kerf of the lead-in of B.outer (cut 1)"]
