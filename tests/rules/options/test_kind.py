"""Each kind of value: what it reads, what it refuses and in which words, and that what it writes reads back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.rule_kit import DURATION, ENERGY, LENGTH, LENGTH_BY_THICKNESS, SPEED, Choice, Flag, Number, OrWord, Text
from kerfwise.rules.lock import Position
from kerfwise.rules.options.kind import OptionKind, Unfit
from kerfwise.rules.options.quantities import (
    ACCELERATION,
    ByThickness,
    PointXY,
    Thicknesses,
    ThicknessTable,
    length_at,
    positive,
)
from kerfwise.rules.profile.load import load_profile, shipped_profiles
from kerfwise.rules.profile.profile_yaml import profile_yaml


def read(kind: OptionKind, text: str) -> Any:
    return kind.read(yaml.compose(text, Loader=yaml.SafeLoader))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        (LENGTH, "1.5", 1.5),
        (LENGTH, "1.5 mm", 1.5),
        (LENGTH, "'1.5mm'", 1.5),
        (LENGTH, "2 cm", 20.0),
        (LENGTH, "0.25 in", 6.35),
        (LENGTH, ".5", 0.5),
        (LENGTH, "1e-1", 0.1),
        (SPEED, "2500", 2500 / 60),
        (SPEED, "2500 mm/min", 2500 / 60),
        (SPEED, "40 mm/s", 40.0),
        (SPEED, "2.4 m/min", 40.0),
        (SPEED, "0.1 m/s", 100.0),
        (SPEED, "100 in/min", 2540 / 60),
        (ACCELERATION, "2", 2000.0),
        (ACCELERATION, "1500 mm/s2", 1500.0),
        (ACCELERATION, "0.5 g", 4903.325),
        (DURATION, "0.5", 0.5),
        (DURATION, "500 ms", 0.5),
        (DURATION, "2 min", 120.0),
        (Number(), "-3", -3.0),
        (Number(1, 9, whole=True), "9", 9),
        (Flag(), "yes", True),
        (Flag(), "off", False),
        (Choice(("hard", "soft", "off")), "off", "off"),
        (Choice(("auto", "mm"), none="auto"), "auto", None),
        (OrWord(Number(1, whole=True), "auto"), "auto", None),
        (OrWord(Number(1, whole=True), "auto"), "12", 12),
        (Text(), "P1.outer", "P1.outer"),
        (PointXY(), "[1, -2.5 mm]", (1.0, -2.5)),
        (Position(), "first", "first"),
        (Position(), "12", 12),
    ],
)
def test_reads(kind: OptionKind, text: str, value: object) -> None:
    assert read(kind, text) == value


@pytest.mark.parametrize(
    ("kind", "text", "message"),
    [
        (LENGTH, "wide", "expected a length of at least 0 such as 1.5 or '1.5 mm' (also cm, m, in), got 'wide'"),
        (LENGTH, "-1", "expected a length of at least 0 such as 1.5 or '1.5 mm' (also cm, m, in), got '-1'"),
        (LENGTH, "1,5", "expected a length of at least 0 such as 1.5 or '1.5 mm' (also cm, m, in), got '1,5': "
         "write decimals with a point, 1.5"),
        (LENGTH, "1.5 bar", "unknown unit 'bar' in '1.5 bar': expected a length of at least 0 such as 1.5 or "
         "'1.5 mm' (also cm, m, in)"),
        (LENGTH, "[1, 2]", "expected a length of at least 0 such as 1.5 or '1.5 mm' (also cm, m, in), got a list of 2"),
        (LENGTH, "", "expected a length of at least 0 such as 1.5 or '1.5 mm' (also cm, m, in), got nothing"),
        (LENGTH, ".inf", "expected a length of at least 0 such as 1.5 or '1.5 mm' (also cm, m, in), got '.inf'"),
        (positive(LENGTH), "0", "expected a length over 0 such as 1.5 or '1.5 mm' (also cm, m, in), got '0'"),
        (SPEED, "0", "expected a speed over 0 such as 2500 or '2500 mm/min' (also mm/s, m/min, m/s, in/min), got '0'"),
        (Number(1, 9, whole=True), "9.5", "expected a whole number from 1 to 9, got '9.5'"),
        (Number(1, 9, whole=True), "10", "expected a whole number from 1 to 9, got '10'"),
        (Number(0), "-0.1", "expected a number of at least 0, got '-0.1'"),
        (Number(), "many", "expected a number, got 'many'"),
        (Flag(), "maybe", "expected true or false, got 'maybe'"),
        (OrWord(Number(1, whole=True), "auto"), "atuo",
         "expected a whole number of at least 1, or the word 'auto', got 'atuo': did you mean 'auto'?"),
        (OrWord(Number(1, whole=True), "auto"), "0",
         "expected a whole number of at least 1, or the word 'auto', got '0'"),
        (OrWord(ENERGY, "off"), "3 bar",
         "unknown unit 'bar' in '3 bar': expected an energy of at least 0 such as 300 or '300 kJ', or the word 'off'"),
        (OrWord(ENERGY, "off"), "1e12", "expected an energy of at least 0 such as 300 or '300 kJ', or the word 'off', "
         "and no more than 1e+09 kJ, got '1e12'"),
        (OrWord(ENERGY, "off"), "[off]",
         "expected an energy of at least 0 such as 300 or '300 kJ', or the word 'off', got a list of 1"),
        (Choice(("hard", "soft")), "sofd", "expected one of hard, soft, got 'sofd': did you mean 'soft'?"),
        (Choice(("hard", "soft")), "zzz", "expected one of hard, soft, got 'zzz'"),
        (Text(), "''", "expected a text, got ''"),
        (Text(pattern=True), "'(a'", "expected a regular expression such as 'mark|scribe', got '(a': missing ), "
         "unterminated subpattern at position 0"),
        (PointXY(), "[1]", "expected a point [x, y] in mm, got a list of 1"),
        (Position(), "0", "expected first, last or a position counted from 1, got '0'"),
    ],
)  # fmt: skip
def test_refuses(kind: OptionKind, text: str, message: str) -> None:
    node = yaml.compose(text or "~", Loader=yaml.SafeLoader)
    with pytest.raises(Unfit) as caught:
        kind.read(node)  # type: ignore[arg-type]
    assert str(caught.value) == message


@pytest.mark.parametrize("kind", [LENGTH, SPEED, DURATION, Number(), Number(0, whole=True)], ids=repr)
@pytest.mark.parametrize("text", ["2000000000", "9" * 5000, "2000000000.5 m"])
def test_no_number_is_so_large_that_sums_could_overflow(kind: OptionKind, text: str) -> None:
    with pytest.raises(Unfit):
        kind.read(yaml.compose(text, Loader=yaml.SafeLoader))  # type: ignore[arg-type]


numbers = st.floats(-1e6, 1e6).filter(lambda x: x == 0 or abs(x) > 1e-9)


@given(numbers.map(lambda x: abs(x) / 10), st.sampled_from([LENGTH, DURATION]))
def test_quantity_reads_back(value: float, kind: OptionKind) -> None:
    assert read(kind, kind.write(value)) == value


@given(st.floats(1e-6, 1e5))
def test_speed_reads_back(value: float) -> None:
    assert read(SPEED, SPEED.write(value)) == value


@given(numbers, numbers)
def test_point_and_number_read_back(x: float, y: float) -> None:
    assert read(PointXY(), PointXY().write((x, y))) == (x, y)
    assert read(Number(), Number().write(x)) == x


@pytest.mark.slow
@given(st.text(min_size=1).filter(lambda t: t.strip() and t.isprintable()))
def test_text_reads_back_even_inside_a_flow_mapping(text: str) -> None:
    written = Text().write(text)
    assert read(Text(), written) == text
    inside = yaml.compose(f"{{key: {written}}}  # comment", Loader=yaml.SafeLoader)
    assert Text().read(inside.value[0][1]) == text  # type: ignore[union-attr]


def test_text_with_a_line_break_stays_on_one_line() -> None:
    assert Text().write("one\ntwo") == '"one\\ntwo"'


TABLE = ThicknessTable(((6.0, 6.0), (12.0, 10.0)))


def read_by_thickness(text: str) -> Any:
    return LENGTH_BY_THICKNESS.read(yaml.compose(text, Loader=yaml.SafeLoader))


def test_reads_a_length_and_a_table_in_any_order() -> None:
    assert read_by_thickness("6 mm") == 6.0
    assert read_by_thickness("{12 mm: 1 cm, 6: 6 mm}") == TABLE


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("{}", "expected a length of at least 0 such as 1.5"),
        ("{0 mm: 3 mm}", "expected a length over 0"),
        ("{6 mm: long}", "expected a length of at least 0"),
        ("{6 mm: 6 mm, 0.6 cm: 7 mm}", "the same thickness is given twice"),
        ("[6, 6]", "or a table by thickness such as {6 mm: 6 mm, 12 mm: 10 mm}, got a list of 2"),
    ],
)
def test_lengths_by_thickness_are_refused(text: str, why: str) -> None:
    with pytest.raises(Unfit) as caught:
        read_by_thickness(text)
    assert why in str(caught.value)


lengths = st.floats(0.05, 500)


@given(st.dictionaries(lengths, lengths, min_size=1, max_size=5), st.floats(0.01, 600))
def test_a_table_reads_back_and_keeps_between_its_rows(rows: dict[float, float], thickness_mm: float) -> None:
    table = ThicknessTable(tuple(sorted(rows.items())))
    assert read_by_thickness(LENGTH_BY_THICKNESS.write(table)) == table
    assert min(rows.values()) - 1e-9 <= table.at(thickness_mm) <= max(rows.values()) + 1e-9
    assert all(length_at(table, t) == length for t, length in rows.items())


def test_a_thicker_sheet_has_longer_leads_and_pierces_further_off(tmp_path: Path) -> None:
    shop = tmp_path / "shop.yaml"
    shop.write_text("based_on: plasma-carbon-steel\nmaterial: {thickness: 9 mm}\n")
    leads, options = load_profile(shop).lead_options(), load_profile(shop).settings()["pierce"].options
    assert (leads.lead_in_mm, leads.pierce_clearance_mm) == (8.0, 2.25)
    assert options.clearance_mm == 2.25
    shown = profile_yaml(load_profile(shop))
    assert "clearance: {1 mm: 1 mm, 6 mm: 1.5 mm, 12 mm: 3 mm, 25 mm: 6 mm}" in shown
    shop.write_text(shown)
    assert load_profile(shop).lead_options() == leads


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 × thickness", Thicknesses(1.0)),
        ("0.5 x thickness", Thicknesses(0.5)),
        (".25*thickness", Thicknesses(0.25)),
        ("2 thicknesses", Thicknesses(2.0)),
        ("5", 5.0),
        ("0.5 cm", 5.0),
    ],
)
def test_it_is_read_and_written(text: str, value: ByThickness) -> None:
    assert LENGTH_BY_THICKNESS.read(yaml.compose(text)) == value
    assert LENGTH_BY_THICKNESS.read(yaml.compose(LENGTH_BY_THICKNESS.write(value))) == value


@pytest.mark.parametrize("text", ["-1 × thickness", "thick", "1 × height", "[1]", "-3 mm", ""])
def test_what_is_neither_is_refused(text: str) -> None:
    with pytest.raises(Unfit, match=r"expected a length of at least 0 such as 1\.5 .*'1\.5 × thickness'"):
        LENGTH_BY_THICKNESS.read(yaml.compose(text) or yaml.ScalarNode("tag:yaml.org,2002:null", ""))


def test_a_clearance_may_be_in_thicknesses(tmp_path: Path) -> None:
    shop = tmp_path / "shop.yaml"
    shop.write_text("material: {thickness: 8 mm}\nrules: {pierce: {clearance: 0.25 × thickness}}\n", encoding="utf-8")
    profile = load_profile(shop)
    assert profile.settings()["pierce"].options.clearance_mm == profile.lead_options().pierce_clearance_mm == 2.0
    assert "clearance: 0.25 × thickness" in profile_yaml(profile)


def test_the_clearance_of_this_thickness_is_held_against_the_kerf(tmp_path: Path) -> None:
    shop = tmp_path / "shop.yaml"
    shop.write_text(
        "material: {kerf: 3 mm, thickness: 6 mm}\nrules: {pierce: {clearance: {6 mm: 1.2 mm, 12 mm: 3 mm}}}\n"
    )
    with pytest.raises(Exception, match=r"rules.pierce.clearance: 1.2 mm is within the kerf"):
        load_profile(shop)


@pytest.mark.parametrize("name", list(shipped_profiles()))
def test_the_leads_of_every_shipped_profile_grow_with_the_thickness(name: str) -> None:
    profile = load_profile(name)
    assert isinstance(profile.leads.lead_in_mm, ThicknessTable)
    for table in (profile.leads.lead_in_mm, profile.rules["pierce"].options.clearance_mm):
        if isinstance(table, ThicknessTable):
            assert [row[1] for row in table.rows] == sorted(row[1] for row in table.rows)
