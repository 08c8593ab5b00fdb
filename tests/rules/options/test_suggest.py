from kerfwise.encoder.nearest_name import nearest, unknown


def test_nearest_ignores_case_and_underscores() -> None:
    assert nearest("Level_Ahead", ["hull-before", "level-ahead"]) == "level-ahead"


def test_a_beginning_is_enough() -> None:
    assert nearest("plasma", ["laser-wood", "plasma-carbon-steel"]) == "plasma-carbon-steel"


def test_nothing_near() -> None:
    assert nearest("zzz", ["hull-before", "level-ahead"]) is None
    assert nearest("zzz", []) is None


def test_long_lists_are_cut_short() -> None:
    names = [f"P{k}.outer" for k in range(100, 200)]
    assert unknown("contour", "P12.outer", names).endswith("P119.outer, …)")
    assert unknown("contour", "P1", []) == "unknown contour 'P1'"
