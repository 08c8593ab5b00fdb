import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.readers import ReadOptions


def test_layers_are_searched_without_regard_to_case() -> None:
    options = ReadOptions()
    assert options.is_sheet("Plate H475 W595")
    assert options.is_mark("PART_ENGRAVING")
    assert not options.is_sheet("OUTER")
    assert not options.is_mark("OUTER")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"units": "inch"}, "unknown units 'inch': expected one of mm, cm, m, in, ft"),
        ({"sheet_size_mm": (100, 0)}, "sheet_size_mm has 0: expected a width and a height over 0"),
        ({"margin_mm": -1}, "margin_mm is -1: expected 0 or more"),
        ({"join_tolerance_mm": 0}, "join_tolerance_mm is 0: expected a number over 0"),
        ({"join_tolerance_mm": float("nan")}, "join_tolerance_mm is nan: expected a number over 0"),
    ],
)
def test_a_wrong_option_says_what_was_expected(given: dict[str, object], said: str) -> None:
    with pytest.raises(InputError) as error:
        ReadOptions(**given)
    assert str(error.value) == said


def test_a_wrong_pattern_is_named() -> None:
    with pytest.raises(InputError, match=r"^mark_layer '\(' is not a regular expression: "):
        ReadOptions(mark_layer="(")
