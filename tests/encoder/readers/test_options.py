"""Options of reading, and sizes that raise a doubt about the units."""

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Sheet
from kerfwise.encoder.readers import ReadOptions
from kerfwise.encoder.readers.options import doubts


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (
            {"units": "inch"},
            "unknown units 'inch': expected one of mm, cm, m, in, ft, pt, px, or dots an inch such as 90dpi",
        ),
        ({"sheet_size_mm": (100, 0)}, "sheet_size_mm has 0: expected a width and a height over 0"),
        ({"margin_mm": -1}, "margin_mm is -1: expected 0 or more"),
        ({"frame": "board"}, "unknown frame 'board': expected one of sheet, part"),
        ({"open_lines": "cut"}, "unknown open_lines 'cut': expected one of mark, ignore, refuse"),
        ({"join_tolerance_mm": 0}, "join_tolerance_mm is 0: expected a number over 0"),
        ({"join_tolerance_mm": float("nan")}, "join_tolerance_mm is nan: expected a number over 0"),
    ],
)
def test_a_wrong_option_says_what_was_expected(given: dict[str, object], said: str) -> None:
    with pytest.raises(InputError) as error:
        ReadOptions(**given)
    assert str(error.value) == said


@pytest.mark.parametrize("size", [(20, 5), (6000, 1500), (50_000, 3000)])
def test_a_plausible_sheet_raises_no_doubt(size: tuple[float, float]) -> None:
    assert doubts(Sheet.rectangle(*size), "mm") == []


@pytest.mark.parametrize(
    ("size", "units", "advice"),
    [
        (
            (19.9, 5),
            "mm",
            "too small to be one: if mm is the wrong unit, pass --units (in Python: units=) cm, m, in or ft",
        ),
        ((152_400, 38_100), "in", "too large to be one: if in is the wrong unit, pass --units (in Python: units=) mm"),
        ((60_000, 15_000), "cm", "too large to be one: if cm is the wrong unit, pass --units (in Python: units=) mm"),
        (
            (1.5875, 0.3),
            "px",
            "too small to be one: if px is the wrong unit, pass --units (in Python: units=) cm, m, in or ft",
        ),
        ((1e-6, 1e-6), "mm", "too small to be one: if mm is the wrong unit, pass the right units"),
    ],
)
def test_the_units_that_would_fit_are_named(size: tuple[float, float], units: str, advice: str) -> None:
    [note] = doubts(Sheet.rectangle(*size), units)
    assert note.severity == "warning"
    assert advice in note.text
