from kerfwise.encoder.contour_checks import metal_of
from kerfwise.rules.case import part, rect


def test_a_hole_that_reaches_out_adds_no_metal() -> None:
    sound = part("A", rect(0, 0, 50, 50), [rect(10, 10, 10, 10)])
    reaching = part("B", rect(0, 0, 50, 50), [rect(45, 10, 20, 10)])
    nested = part("C", rect(0, 0, 50, 50), [rect(10, 10, 20, 20), rect(15, 15, 5, 5)])
    flat = part("D", [(0, 0), (50, 0)])
    flat_hole = part("E", rect(0, 0, 50, 50), [[(5, 5), (9, 9)]])
    assert [round(m.area, 6) for m in metal_of([sound, reaching, nested, flat, flat_hole])] == [
        2400,
        2450,
        2100,
        0,
        2500,
    ]
