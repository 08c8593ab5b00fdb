"""A control on which the same words cut or mark, by the station or process that is selected."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.postproc.dialects import dialect_text, load_dialect
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.postproc.verdict.dialect_read_back import read_back
from kerfwise.tests.postproc.dialects import reading
from kerfwise.tests.postproc.plans import good_cuts, plan_of, plate, profile

STATIONS = {"torch_station": ("M36 T1", "M37 T1"), "mark_station": ("M36 T3", "M37 T2")}
BY_PROCESS = dataclasses.replace(load_dialect("eia"), mark_on=("M07",), mark_off=("M08",), **STATIONS)


def program() -> str:
    plant = reading.with_dialect(profile(), "eia")
    return write_program(plan_of(plate(), good_cuts(plate()), plant), plate(), plant, BY_PROCESS)


def test_a_station_is_selected_where_the_other_was_in_use() -> None:
    read_back(BY_PROCESS, "shop.yaml")
    rows = [row.split(" ", 1)[1] for row in program().split("\n") if row.startswith("N")]
    assert rows.count("M36 T1") == rows.count("M36 T3") == 1
    assert rows.index("M36 T3") < rows.index("M07") < rows.index("M36 T1")
    assert check_program(plate(), program(), reading.with_dialect(profile(), "eia")).ok


def test_a_forgotten_station_marks_what_should_be_cut() -> None:
    damaged = "\n".join(row for row in program().split("\n") if "M36 T1" not in row)
    verdict = check_program(plate(), damaged, reading.with_dialect(profile(), "eia"))
    assert "every-contour-once" in verdict.broken()


def test_a_process_that_marks_is_no_torch() -> None:
    wrong = dataclasses.replace(BY_PROCESS, torch_station=("M36 T4",))
    with pytest.raises(InputError, match="torch_on: 'M07' starts what marks"):
        read_back(wrong, "eia")


def test_stations_of_both_or_of_neither(tmp_path: Path) -> None:
    (tmp_path / "shop.yaml").write_text(dialect_text("eia") + "mark_station: M36 T3\n")
    with pytest.raises(
        InputError, match=r"shop\.yaml:\d+:15: torch_station and mark_station: expected blocks for both"
    ):
        load_dialect(str(tmp_path / "shop.yaml"))
