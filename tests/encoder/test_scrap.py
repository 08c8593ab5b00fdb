"""Scrap lines that cannot be cut where they are drawn are refused, each with its id and a place."""

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.validate import validated
from kerfwise.rules.case import Rows, nest, part, rect

PLATE = part("A", rect(50, 20, 50, 50), [rect(60, 30, 30, 30)])


def plate(*scrap: Rows) -> Nest:
    return nest(200, 100, PLATE, scrap=scrap)


REFUSED = {
    "through a part": ([[(0, 40), (70, 40)]], "scrap1 runs through part A at (60.0, 40.0): end it before the part"),
    "in a hole of a part": (
        [[(70, 40), (80, 40)]],
        "scrap1 runs through part A at (75.0, 40.0): end it before the part",
    ),
    "off the sheet": ([[(150, 0), (150, 101)]], "scrap1 runs 1.000 mm off the sheet at (150.0, 100.5)"),
    "all beside the sheet": ([[(300, 0), (300, 9)]], "scrap1 runs 9.000 mm off the sheet at (300.0, 4.5)"),
    "of no length": ([[(150, 10), (150, 10)]], "scrap1 has no length, at (150.000, 10.000): remove it"),
    "closed": ([[(150, 10), (160, 10), (160, 20), (150, 10)]], "scrap1 is closed, at (150.000, 10.000)"),
    "over itself": ([[(120, 10), (160, 50), (160, 10), (120, 50)]], "scrap1 crosses itself, at (120.000, 10.000)"),
    "across each other": (
        [[(120, 0), (120, 100)], [(100, 50), (200, 50)]],
        "scrap1 and scrap2 cross at (120.0, 50.0): let one of them end at the other",
    ),
    "on each other": (
        [[(120, 0), (120, 60)], [(120, 40), (120, 100)]],
        "scrap1 and scrap2 run on each other at (120.0, 50.0): draw the line once",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_it_is_refused(case: str) -> None:
    lines, told = REFUSED[case]
    with pytest.raises(InputError, match="the nest cannot be cut as it is drawn: 1 problem") as error:
        validated(plate(*lines))
    assert error.value.details[0].startswith(told)


SOUND = {
    "edge to edge": [[(120, 0), (120, 100)]],
    "edge to part": [[(0, 40), (48.5, 40)]],
    "a branch": [[(120, 0), (120, 100)], [(120, 50), (200, 50)]],
    "a branch that goes on a little": [[(120, 0), (120, 100)], [(119.1, 50), (200, 50)]],
    "round a part": [[(0, 80), (110, 80), (110, 0)]],
}


@pytest.mark.parametrize("case", SOUND)
def test_it_is_sound(case: str) -> None:
    assert len(validated(plate(*SOUND[case])).scrap) == len(SOUND[case])
