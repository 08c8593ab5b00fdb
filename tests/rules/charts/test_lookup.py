"""Rows by material and thickness, by name, by columns; what lies between two of them only where that is asked for."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kerfwise.rules.charts import Chart, ChartRow, NoRow, RowChoice, look_up

ROWS = (
    ("S235", 6.0, 1.5, 85.0, "O2"),
    ("S235", 10.0, 1.9, 85.0, "O2"),
    ("S235", 20.0, 2.4, 130.0, "O2"),
    ("S355", 6.0, 1.6, 85.0, "O2"),
    ("S355", 6.0, 1.2, 45.0, "air"),
)
CHART = Chart(
    "shop.csv",
    "",
    tuple(
        ChartRow(line, {"material": m, "thickness": t, "kerf": k, "amps": a, "gas": g})
        for line, (m, t, k, a, g) in enumerate(ROWS, 2)
    ),
)


def kerf(choice: RowChoice | None, material: str, thickness_mm: float, interpolate: bool = False) -> object:
    return look_up(CHART, choice, material, thickness_mm, interpolate).values["kerf"].value


def test_the_row_of_the_material_and_the_thickness() -> None:
    assert kerf(None, "S235", 10.0) == 1.9
    assert kerf(None, "s235", 10.0) == 1.9, "capitals make no difference"
    assert kerf((("amps", 45.0),), "S355", 6.0) == 1.2
    assert kerf((("material", "S235"), ("thickness", 20.0)), "S355", 6.0) == 2.4


@pytest.mark.parametrize(
    ("choice", "material", "thickness_mm", "interpolate", "said"),
    [
        (None, "S253", 6.0, False, "unknown material 'S253': did you mean 'S235'? (valid: S235, S355)"),
        (None, "S235", 8.0, False, "no row of S235 at 8 mm: near are 6 mm (line 2), 10 mm (line 3), 20 mm (line 4); "),
        (None, "S235", 30.0, False, "no row of S235 at 30 mm: near are 6 mm (line 2), 10 mm (line 3), 20 mm (line 4)"),
        (None, "S235", 30.0, True, "beyond its ends a chart says nothing"),
        (None, "S235", 15.0, True, "nothing lies between rows of another amps: 85 A (line 3) and 130 A (line 4)"),
        (None, "S355", 6.0, False, "2 rows with material S355, thickness 6 mm (lines 5, 6): say also amps or gas"),
        ((("amps", 60.0),), "S355", 6.0, False, "unknown amps '60 A'"),
        ((("name", "S235 6"),), "S235", 6.0, False, "no row of shop.csv has a name"),
    ],
)  # fmt: skip
def test_what_there_is_not_is_told_with_what_is_near(
    choice: RowChoice | None, material: str, thickness_mm: float, interpolate: bool, said: str
) -> None:
    with pytest.raises(NoRow, match=re.escape(said)):
        look_up(CHART, choice, material, thickness_mm, interpolate)


def test_nothing_is_interpolated_beyond_the_ends_and_no_near_row_offers_it() -> None:
    with pytest.raises(NoRow) as caught:
        look_up(CHART, None, "S235", 30.0)
    assert "interpolate" not in str(caught.value)


@given(st.floats(6.001, 9.999))
def test_what_lies_between_two_rows(thickness_mm: float) -> None:
    found = look_up(CHART, None, "S235", thickness_mm, interpolate=True).values
    assert found["kerf"].value == pytest.approx(1.5 + 0.4 * (thickness_mm - 6) / 4, rel=1e-8)
    assert found["kerf"].lines == (2, 3)
    assert found["kerf"].between_mm == (6.0, 10.0)
    assert (found["amps"].value, found["amps"].between_mm, found["gas"].value) == (85.0, (), "O2")


def test_an_empty_cell_is_filled_only_where_that_is_asked_for() -> None:
    holed = ChartRow(9, {"material": "S235", "thickness": 8.0, "amps": 85.0, "gas": "O2"})
    chart = Chart("shop.csv", "", (*CHART.rows, holed))
    assert "kerf" not in look_up(chart, None, "S235", 8.0).values
    assert look_up(chart, None, "S235", 8.0, interpolate=True).values["kerf"].value == 1.7


def test_rows_by_name_or_number() -> None:
    rows = (ChartRow(2, {"kerf": 1.5}, ("S235 6mm", "1")), ChartRow(9, {"kerf": 1.9}, ("S235 10mm", "2")))
    chart = Chart("m_material.cfg", "", rows)
    for name in ("2", "s235 10MM"):
        assert look_up(chart, (("name", name),), "S235", 6.0).values["kerf"].value == 1.9
    with pytest.raises(NoRow, match="unknown row 'S235 10': did you mean 'S235 10mm'"):
        look_up(chart, (("name", "S235 10"),), "S235", 6.0)
    with pytest.raises(
        NoRow, match=r"gives no thicknesses: name the row, such as row: S235 6mm \(it has S235 6mm, S235 10mm\)"
    ):
        look_up(chart, None, "S235", 6.0)
