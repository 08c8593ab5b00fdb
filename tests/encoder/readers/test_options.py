"""Options of reading, and sizes that raise a doubt about the units."""

from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise import load_profile, read_nest
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


PAGE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="{}" height="{}" viewBox="0 0 400 200">'
    '<path d="M0 0h100v50h-100z"/></svg>'
)
SAID = {
    "nest.json": '{"format": "kerfwise-nest/1", "units": "mm", "sheet": {"width": 400, "height": 200}, "parts": '
    '[{"id": "A", "outer": [[10, 10], [110, 10], [110, 60], [10, 60]]}]}',
    "page.svg": PAGE.format("400mm", "200mm"),
    "drawing.dxf": "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n"
    "8\n0\n10\n100\n20\n100\n40\n50\n0\nENDSEC\n0\nEOF\n",
}


@pytest.mark.parametrize("name", SAID)
def test_units_of_the_profile_against_those_of_the_file(tmp_path: Path, name: str) -> None:
    """A nest of our own says its units, and keeps them; a drawing is read as the plant says, with a warning."""
    (tmp_path / name).write_text(SAID[name])
    plant = load_profile()
    found = {}
    for units in (None, "mm", "in"):
        nest = read_nest(tmp_path / name, replace(plant, drawing=replace(plant.drawing, units=units, frame="part")))
        found[units] = nest.parts[0].outer.curve.length_mm, [n.text for n in nest.notes if "is read in in" in n.text]
    assert found[None] == found["mm"]
    larger, told = found["in"][0] / found["mm"][0], found["in"][1]
    assert (round(larger, 3), len(told)) == ((1.0, 0) if name == "nest.json" else (25.4, 1))
    given = read_nest(tmp_path / name, units="in", frame="part")
    assert given.parts[0].outer.curve.length_mm == pytest.approx(25.4 * found["mm"][0])
    assert any("is read in in, as given" in note.text for note in given.notes)


def test_units_that_a_page_agrees_with_are_not_told(tmp_path: Path) -> None:
    (tmp_path / "page.svg").write_text(PAGE.format("400in", "200in"))
    assert all("unit" not in note.text for note in read_nest(tmp_path / "page.svg", units="in").notes)
