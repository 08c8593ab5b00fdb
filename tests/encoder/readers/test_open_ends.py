from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.open_lines import open_end_problems
from kerfwise.tests.encoder.readers.drawings import pieces


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
