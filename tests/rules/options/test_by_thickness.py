"""Lengths by thickness: what is read, what is written, and what a profile makes of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.rules.options.kind import Unfit
from kerfwise.rules.options.quantities import LENGTH_BY_THICKNESS, ByThickness, Thicknesses, ThicknessTable, length_at
from kerfwise.rules.profile.load import load_profile, shipped_profiles
from kerfwise.rules.profile.profile_yaml import profile_yaml

TABLE = ThicknessTable(((6.0, 6.0), (12.0, 10.0)))


def read(text: str) -> Any:
    return LENGTH_BY_THICKNESS.read(yaml.compose(text, Loader=yaml.SafeLoader))


def test_reads_a_length_and_a_table_in_any_order() -> None:
    assert read("6 mm") == 6.0
    assert read("{12 mm: 1 cm, 6: 6 mm}") == TABLE


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
def test_refuses(text: str, why: str) -> None:
    with pytest.raises(Unfit) as caught:
        read(text)
    assert why in str(caught.value)


lengths = st.floats(0.05, 500)


@given(st.dictionaries(lengths, lengths, min_size=1, max_size=5), st.floats(0.01, 600))
def test_a_table_reads_back_and_keeps_between_its_rows(rows: dict[float, float], thickness_mm: float) -> None:
    table = ThicknessTable(tuple(sorted(rows.items())))
    assert read(LENGTH_BY_THICKNESS.write(table)) == table
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
