"""Whatever a chart's file holds, it is read, or refused with its file and a line."""

from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from kerfwise.encoder.errors import InputError
from kerfwise.rules.charts import NoRow, look_up, read_chart
from kerfwise.tests.tools.amount import examples

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
