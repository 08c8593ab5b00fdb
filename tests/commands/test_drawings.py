"""Drawings on the command line: a question ends the command with exit code 3, writes nothing, and is asked once."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.encoder.readers.drawings import save_dxf
from kerfwise.tests.encoder.readers.test_frame import framed
from kerfwise.tests.encoder.readers.test_open_lines import engraved


def test_a_frame_is_asked_about_and_the_answer_is_taken(tmp_path: Path) -> None:
    nest, out = save_dxf(tmp_path, framed), tmp_path / "out.json"
    asked = kerfwise("facts", nest, "-o", out)
    assert (asked.code, asked.out) == (3, "")
    assert "--answer frame=part    a part; what is in it is openings: 1 part, 1 hole (200 × 200 mm)" in asked.err
    assert f"kerfwise: {nest}: the drawing raises a question that nobody has answered:" in asked.err
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


def test_an_answer_is_kept_in_the_job_file(tmp_path: Path) -> None:
    nest, out, job = save_dxf(tmp_path, framed), tmp_path / "out.json", tmp_path / "drawing.job.yaml"
    job.write_text("quantity: 4  # sheets\n")
    answered = kerfwise("facts", nest, "-o", out, "--answer", "frame=part")
    assert answered.code == 0
    assert "kept in" in answered.err
    assert job.read_text() == 'quantity: 4  # sheets\nanswers: {"frame": "part"}\n'
    assert kerfwise("facts", nest, "-o", out).code == 0
    assert "P1.hole1" in out.read_text()
    assert kerfwise("facts", nest, "-o", out, "--no-job").code == 3


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such files")
def test_a_pipe_in_the_place_of_the_job_file_is_not_read_for_answers(tmp_path: Path) -> None:
    nest, job = save_dxf(tmp_path, framed), tmp_path / "drawing.job.yaml"
    os.mkfifo(job)
    fed = threading.Thread(target=job.write_text, args=["quantity: 4\n"], daemon=True)
    fed.start()
    answered = kerfwise("facts", nest, "-o", tmp_path / "out.json", "--answer", "frame=part")
    assert answered.code == 0
    assert "the answers are not kept: " in answered.err
    assert "device or a pipe" in answered.err
    assert fed.is_alive(), "somebody has read the pipe"


def test_an_answer_to_no_question_is_said_and_a_wrong_one_is_refused(tmp_path: Path) -> None:
    nest, out = save_dxf(tmp_path, framed), tmp_path / "out.json"
    said = kerfwise("facts", nest, "-o", out, "--answer", "frame=part", "--answer", "units=in")
    assert "--answer units=in answers no question of drawing.dxf: it is not kept" in said.err
    wrong = kerfwise("facts", nest, "-o", out, "--answer", "frame=board")
    assert wrong.code == 2
    assert "the answer frame=board is none of the choices: expected sheet, part" in wrong.err
    assert kerfwise("facts", nest, "-o", out, "--answer", "frame").code == 2


def test_a_profile_may_answer_for_a_plant(tmp_path: Path) -> None:
    nest, out, plant = save_dxf(tmp_path, framed), tmp_path / "out.json", tmp_path / "plant.yaml"
    plant.write_text("drawing: {answers: {frame: sheet}}")
    assert kerfwise("facts", nest, "-p", plant, "-o", out).code == 0
    assert not (tmp_path / "drawing.job.yaml").exists()


def test_open_lines_beside_closed_ones_are_no_part_of_a_program(tmp_path: Path) -> None:
    nest, out = save_dxf(tmp_path, engraved), tmp_path / "out.nc"
    ended = kerfwise("solve", nest, "-o", out)
    assert (ended.code, ended.out) == (3, "")
    assert "--answer layer:G2=mark" in ended.err
    repaired = kerfwise("solve", nest, "-o", out, "--repair")
    assert (repaired.code, repaired.out) == (3, "")
    assert "--answer layer:G2=mark" in repaired.err
    assert not out.exists()
