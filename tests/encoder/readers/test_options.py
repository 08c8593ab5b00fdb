import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers import ReadOptions


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
