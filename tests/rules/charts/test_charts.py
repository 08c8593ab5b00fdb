"""Charts as shops keep them: CSV with units at the head or in the cells, YAML, QtPlasmaC's own file."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from kerfwise import InputError
from kerfwise.rules.charts import Chart, ChartRow, NoRow, RowChoice, look_up, read_chart
from kerfwise.tests.tools.amount import examples

CSV = """\
# cut chart, own figures
material; Thickness [mm]; kerf (mm); feed; pierce delay [s]; amps [A]; gas
S235;  6; 1.5; 2500 mm/min; 0.5; 85; O2/air

"S355, normalised"; 10; 1.9; 1.5 m/min; 0.9; 85; O2/air
"""
YAML = """\
- {material: S235, thickness: 6 mm, kerf: 1.5, feed: 2500, pierce_delay: 500 ms, amps: 85, gas: O2/air}
- material: S355, normalised
  thickness: 1 cm
  kerf: 1.9 mm
  feed: 1.5 m/min
  pierce_delay: 0.9
  amps: 85 A
  gas: O2/air
"""
QTPLASMAC = """\
# plasmac material file
[MATERIAL_NUMBER_1]
NAME               = S235 6mm
KERF_WIDTH         = 1.5
THC                = 1
PIERCE_HEIGHT      = 3.8
PIERCE_DELAY       = 0.5
PUDDLE_JUMP_HEIGHT = 0
PUDDLE_JUMP_DELAY  = 0
CUT_HEIGHT         = 1.5
CUT_SPEED          = 2500.0
CUT_AMPS           = 85
CUT_VOLTS          = 120
PAUSE_AT_END       = 0.0
GAS_PRESSURE       = 0.0
CUT_MODE           = 1

[MATERIAL_NUMBER_12]
NAME          = S355 10mm
KERF_WIDTH    = 0
PIERCE_HEIGHT = 4
PIERCE_DELAY  = 0
CUT_HEIGHT    = 1.5
CUT_SPEED     = 1500
"""


def chart(tmp_path: Path, text: str, name: str, **units: str) -> Chart:
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_chart(tmp_path / name, **units)  # type: ignore[arg-type]


@pytest.mark.parametrize(("text", "name"), [(CSV, "a.csv"), (YAML, "a.yaml"), (CSV.replace(";", "\t"), "a.csv")])
def test_units_stand_at_the_head_or_in_the_cells(tmp_path: Path, text: str, name: str) -> None:
    first, second = (row.values for row in chart(tmp_path, text, name).rows)
    assert first == {
        "material": "S235", "thickness": 6.0, "kerf": 1.5, "feed": pytest.approx(2500 / 60), "pierce_delay": 0.5,
        "amps": 85.0, "gas": "O2/air",
    }  # fmt: skip
    assert (second["material"], second["thickness"], second["feed"]) == ("S355, normalised", 10.0, 25.0)


def test_rows_and_values_know_their_lines(tmp_path: Path) -> None:
    assert [row.line for row in chart(tmp_path, CSV, "a.csv").rows] == [3, 5]
    row = chart(tmp_path, YAML, "a.yaml").rows[1]
    assert (row.line, row.line_of("feed")) == (2, 5)


def test_qtplasmacs_own_file_is_read_as_it_is(tmp_path: Path) -> None:
    first, second = chart(tmp_path, QTPLASMAC, "m_material.cfg").rows
    assert first.values == {
        "name": "S235 6mm", "kerf": 1.5, "pierce_height": 3.8, "pierce_delay": 0.5, "cut_height": 1.5,
        "feed": pytest.approx(2500 / 60), "amps": 85.0, "volts": 120.0,
    }  # fmt: skip
    assert first.names == ("S235 6mm", "1")
    assert first.line_of("feed") == 11
    assert "kerf" not in second.values, "0 stands for what nobody has given"
    assert second.values["pierce_delay"] == 0.0


def test_qtplasmac_in_inches(tmp_path: Path) -> None:
    text = QTPLASMAC.replace("= 1.5\nTHC", "= 0.06\nTHC").replace("2500.0", "100").replace("= 4\n", "= 0.15\n")
    values = chart(tmp_path, text, "m_material.cfg", units="inch").rows[0].values
    assert values["kerf"] == pytest.approx(1.524)
    assert values["feed"] == pytest.approx(2540 / 60)


def test_a_file_of_another_kind_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a\.xlsx: a material chart is a \.csv, a \.yaml, or a \.cfg of QtPlasmaC"):
        chart(tmp_path, CSV, "a.xlsx")


WORDS = st.sampled_from(
    [
        "material",
        "thickness [mm]",
        "kerf",
        "kerf [cm]",
        "feed [mm/min]",
        "amps [A]",
        "name",
        "gas",
        ",",
        ";",
        "\t",
        "\n",
        "S235",
        "6",
        "1,5",
        "-3",
        "1e9",
        "6 mm",
        '"',
        "#",
        "- {",
        "}",
        ": ",
        "[MATERIAL_NUMBER_1]",
        "KERF_WIDTH = 1.5",
        "=",
        "CUT_SPEED = 100",
        "PIERCE_DELAY = 0",
        "CUT_HEIGHT=x",
        "NAME = a",
        "PIERCE_HEIGHT = 2",
        "[",
        "]",
        "²",
        "\x00",
        "٣",
    ]
)
TEXTS = st.one_of(st.lists(WORDS, max_size=40).map("".join), st.lists(WORDS, max_size=30).map(" ".join), st.text())


@examples(300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(TEXTS, st.sampled_from([".csv", ".yaml", ".cfg"]), st.floats(0.1, 100), st.booleans())
def test_any_text(tmp_path: Path, text: str, ending: str, thickness_mm: float, interpolate: bool) -> None:
    file = tmp_path / f"chart{ending}"
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    with contextlib.suppress(InputError):  # anything else would fail the test
        chart = read_chart(file)
        for choice in (None, (("name", "a"),), (("thickness", thickness_mm),)):
            with contextlib.suppress(NoRow):
                found = look_up(chart, choice, "S235", thickness_mm, interpolate)
                assert all(isinstance(one.value, float | str) for one in found.values.values())


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(b"material\n\xff\n")
    with pytest.raises(InputError, match=r"a\.csv:2: not a material chart: it is not UTF-8"):
        read_chart(tmp_path / "a.csv")


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
