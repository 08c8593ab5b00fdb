import pytest

from kerfwise.encoder.nest import Sheet
from kerfwise.encoder.readers.options import doubts


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
