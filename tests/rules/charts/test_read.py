"""Charts as shops keep them: CSV with units at the head or in the cells, YAML, QtPlasmaC's own file."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.rules.charts import Chart, read_chart

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
