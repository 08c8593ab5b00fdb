"""Drawings on the command line: what is asked about costs an exit code of 2 and writes nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.encoder.readers.drawings import save_dxf
from kerfwise.tests.encoder.readers.test_frame import framed
from kerfwise.tests.encoder.readers.test_open_lines import engraved


def test_a_frame_is_asked_about_and_the_answer_is_taken(tmp_path: Path) -> None:
    nest, out = save_dxf(tmp_path, framed), tmp_path / "out.json"
    asked = kerfwise("facts", nest, "-o", out)
    assert (asked.code, asked.out) == (2, "")
    assert "Pass --frame sheet or --frame part" in asked.err
    assert "Traceback" not in asked.err
    assert not out.exists()
    taken = kerfwise("facts", nest, "--frame", "sheet", "-o", out)
    assert taken.code == 0
    assert "warning: the rectangle around everything, 200 × 200 mm" in taken.err
    assert "P1.hole1" not in out.read_text()
    (tmp_path / "plant.yaml").write_text("drawing: {frame: part}")
    assert kerfwise("facts", nest, "-p", tmp_path / "plant.yaml", "-o", out).code == 0
    assert "P1.hole1" in out.read_text()
    assert kerfwise("facts", nest, "-p", tmp_path / "plant.yaml", "--frame", "sheet", "-o", out).code == 0
    assert "P1.hole1" not in out.read_text()


@pytest.mark.parametrize("repair", [[], ["--repair"]])
def test_open_lines_beside_closed_ones_are_no_part_of_a_program(repair: list[str], tmp_path: Path) -> None:
    nest, out = save_dxf(tmp_path, engraved), tmp_path / "out.nc"
    ended = kerfwise("solve", nest, "-o", out, *repair)
    assert (ended.code, ended.out) == (2, "")
    assert "drawing: {layers: {mark: '^G2$'}}" in ended.err
    assert not out.exists()
