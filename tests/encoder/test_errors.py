from kerfwise.encoder.errors import MOST_DETAILS, InputError


def text(lines: int) -> list[str]:
    return str(InputError("wrong", file="nest.dxf", details=tuple(f"line {k}" for k in range(lines)))).splitlines()


def test_a_long_list_is_cut_short_and_says_how_many_are_left_out() -> None:
    assert text(0) == ["nest.dxf: wrong"]
    assert text(MOST_DETAILS)[-1] == f"  - line {MOST_DETAILS - 1}"
    assert text(MOST_DETAILS + 92)[-2:] == [f"  - line {MOST_DETAILS - 1}", "  … and 92 more"]
