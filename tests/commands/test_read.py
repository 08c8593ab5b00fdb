"""`kerfwise read`: what a drawing is taken for, its questions, and its picture."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from kerfwise import InputError, read_nest
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.encoder.readers.drawings import lines, save_dxf, sheet, square
from kerfwise.tests.encoder.readers.test_frame import framed


def mixed(space: Any) -> None:
    sheet(space)
    lines(space, square(10, 10, 50))
    space.add_circle((35, 35), 10, dxfattribs={"layer": "Gravur"})
    space.add_line((0, 5), (400, 5), dxfattribs={"layer": "DIM"})
    space.add_line((10, 10), (60, 10))


def test_what_each_layer_is_taken_for(tmp_path: Path) -> None:
    nest, picture = save_dxf(tmp_path, mixed), tmp_path / "reading.png"
    ended = kerfwise("read", nest, "-o", picture)
    assert ended.code == 0
    assert ended.out.splitlines() == [
        "units: mm: $INSUNITS 4",
        "sheet: 400 × 300 mm: drawn on layer 'Plate H300 W400'",
        "layer '0': cut, by default (5 lines)",
        "layer 'DIM': left out, by its name (1 line)",
        "layer 'Gravur': marked, by its name (1 line)",
        "layer 'Plate H300 W400': the sheet, by its name (1 line)",
        "left out: as drawing.layers.ignore matches their layers: 1 on 'DIM'",
        f"written: {picture}",
    ]
    assert picture.read_bytes()[:4] == b"\x89PNG"


def test_questions_are_printed_and_given_as_data(tmp_path: Path) -> None:
    nest, picture = save_dxf(tmp_path, framed), tmp_path / "reading.svg"
    asked = kerfwise("read", nest, "-o", picture)
    assert asked.code == 3
    assert "sheet: 220 × 220 mm, assumed: the parts' bounding box and 10 mm around it" in asked.out
    assert "--answer frame=part" in asked.err
    assert "unknown: a question" in picture.read_text(encoding="utf-8")
    data = kerfwise("read", nest, "--json")
    assert data.code == 3
    told = json.loads(data.out)
    [question] = told["questions"]
    assert (question["id"], [choice["flag"] for choice in question["choices"]]) == (
        "frame",
        ["frame=part", "frame=sheet"],
    )
    assert told["reading"]["sheet"]["assumed"] is True


def test_plot_draws_what_is_read_so_far(tmp_path: Path) -> None:
    nest = save_dxf(tmp_path, framed)
    drawn = kerfwise("plot", nest, "-o", tmp_path / "asked.svg")
    assert (drawn.code, "what is read so far" in drawn.err) == (3, True)
    assert "unknown: a question" in (tmp_path / "asked.svg").read_text(encoding="utf-8")
    facts = kerfwise("facts", nest)
    assert (facts.code, "-o READING.png draws what is read so far" in facts.err, facts.out) == (3, True, "")


def test_an_answer_is_kept(tmp_path: Path) -> None:
    nest = save_dxf(tmp_path, framed)
    assert kerfwise("read", nest, "--answer", "frame=sheet").code == 0
    again = kerfwise("read", nest)
    assert (again.code, "answered: frame=sheet" in again.out) == (0, True)


SLIPS = [
    ("fram", "sheet", "no drawing raises a question 'fram': did you mean 'frame'?", 3),
    ("frame", "shet", "the answer frame=shet is none of the choices: expected sheet, part", 10),
    ("layr:Gravur", "cut", "no drawing raises a question 'layr:Gravur': did you mean 'layer:Gravur'?", 3),
    ("layer:Gravur", "engrave", "the answer layer:Gravur=engrave is none of the choices: expected cut, mark", 17),
    ("off-pge", "cut", "no drawing raises a question 'off-pge': did you mean 'off-page'?", 3),
]
"""A question, an answer, what is wrong with it, and the column of that in YAML."""


@pytest.mark.parametrize(("question", "choice", "said", "column"), SLIPS)
def test_an_answer_that_no_drawing_asks_for_is_refused_wherever_it_stands(
    tmp_path: Path, question: str, choice: str, said: str, column: int
) -> None:
    nest, job, plant = save_dxf(tmp_path, mixed), tmp_path / "drawing.job.yaml", tmp_path / "plant.yaml"
    on_line = kerfwise("read", nest, "--no-job", "--answer", f"{question}={choice}")
    assert (on_line.code, said in on_line.err) == (2, True)
    job.write_text(f"quantity: 2\nanswers:\n  {question}: {choice}\n", encoding="utf-8")
    of_job = kerfwise("read", nest)
    assert of_job.code == 2
    assert f"{job}:3:{column}: job file.answers: {said}" in of_job.err
    plant.write_text(f"drawing:\n  answers: {{\n  {question}: {choice}}}\n", encoding="utf-8")
    of_plant = kerfwise("read", nest, "--no-job", "-p", plant)
    assert of_plant.code == 2
    assert f"{plant}:3:{column}: drawing.answers: {said}" in of_plant.err
    with pytest.raises(InputError, match=re.escape(said)):
        read_nest(nest, answers={question: choice})


def test_an_answer_about_a_layer_that_is_not_there(tmp_path: Path) -> None:
    nest, job = save_dxf(tmp_path, mixed), tmp_path / "drawing.job.yaml"
    said = "unknown layer 'gravur': did you mean 'Gravur'? (valid: 0, DIM, Gravur, Plate H300 W400)"
    given = kerfwise("read", nest, "--answer", "layer:gravur=cut")
    assert (given.code, said in given.err, job.exists()) == (2, True, False)
    job.write_text("answers: {'layer:gravur': cut}\n", encoding="utf-8")
    kept = kerfwise("solve", nest, "--work", "0.01", "-o", tmp_path / "out.nc")  # of a drawing before, most likely
    assert (kept.code, f"{job}: answers: {said}" in kept.err) == (0, True)


def test_a_nest_that_cannot_be_cut_is_drawn_all_the_same(tmp_path: Path) -> None:
    def overlapping(space: Any) -> None:
        sheet(space)
        for x in (10, 40):
            space.add_lwpolyline([(x, 10), (x + 50, 10), (x + 50, 60), (x, 60)], close=True)

    nest, picture = save_dxf(tmp_path, overlapping), tmp_path / "reading.svg"
    ended = kerfwise("read", nest, "-o", picture)
    assert (ended.code, "overlap by" in ended.err, picture.exists()) == (2, True, True)


def test_program_and_plan_say_how_the_drawing_was_read(tmp_path: Path) -> None:
    nest, program, plan = save_dxf(tmp_path, mixed), tmp_path / "out.nc", tmp_path / "out.plan.json"
    ended = kerfwise("solve", nest, "-o", program, "--plan", plan, "--work", "1")
    told = "read in mm; sheet 400 × 300 mm; cut: '0' (5); left out: 'DIM' (1); marked: 'Gravur' (1); the sheet:"
    assert ended.code == 0
    assert told in ended.out
    assert "DRAWING READ IN MM, SHEET 400 X 300 MM" in program.read_text()
    assert json.loads(plan.read_text())["nest"]["reading"].startswith(told)
    assert kerfwise("check", nest, plan).code == 0
    assert kerfwise("check", nest, program).code == 0


def test_a_size_takes_the_place_of_the_sheet_of_a_json_nest(tmp_path: Path) -> None:
    nest = tmp_path / "nest.json"
    part = {"id": "A", "outer": [[300, 10], [480, 10], [480, 90], [300, 90]]}
    nest.write_text(json.dumps({"format": "kerfwise-nest/1", "sheet": {"width": 500, "height": 100}, "parts": [part]}))
    small = kerfwise("read", nest, "--sheet", "400x100")
    assert (small.code, "A.outer reaches 80.000 mm off the sheet" in small.err) == (2, True)
    assert (
        "sheet: 600 × 100 mm: as given (--sheet, in Python sheet_mm=)"
        in kerfwise("read", nest, "--sheet", "600x100").out
    )


def test_an_assumed_sheet_has_no_price(tmp_path: Path) -> None:
    plant = tmp_path / "plant.yaml"
    plant.write_text("prices: {sheet_each: 1000}\n")
    nest = save_dxf(tmp_path, lambda space: lines(space, square(10, 10, 50)))
    argv = ("solve", nest, "-p", plant, "-o", tmp_path / "out.nc", "--work", "1")
    assert "1000.00" not in kerfwise(*argv).out
    assert "1000.00" in kerfwise(*argv, "--sheet", "500x300").out


def test_a_batch_lists_all_questions_and_plans_the_rest(tmp_path: Path) -> None:
    folder = tmp_path / "nests"
    folder.mkdir()
    for name, draw in (("asks", framed), ("plain", mixed)):
        save_dxf(tmp_path, draw).rename(folder / f"{name}.dxf")
    ended = kerfwise("batch", folder, "-o", tmp_path / "out", "--work", "1", "--jobs", "1")
    assert (ended.code, "1 of 2 planned" in ended.out) == (3, True)
    assert "The drawing raises questions that nobody has answered" in ended.out
    assert "--answer frame=part" in ended.out
    (folder / "asks.job.yaml").write_text("answers: {frame: part}\n")
    assert kerfwise("batch", folder, "-o", tmp_path / "out", "--work", "1", "--jobs", "1").code == 0


def test_nest_lists_the_questions_of_all_parts(tmp_path: Path) -> None:
    def plate(space: Any) -> None:
        lines(space, square(0, 0, 200), layer="PLATE")
        space.add_circle((100, 100), 20, dxfattribs={"layer": "HOLES"})

    files = []
    for name in ("one", "two"):
        files.append(tmp_path / f"{name}.dxf")
        save_dxf(tmp_path, plate).rename(files[-1])
    argv = ("nest", *files, "--sheet", "1000x500", "-o", tmp_path / "out")
    ended = kerfwise(*argv)
    assert ended.code == 3
    assert [f"{name}.dxf: the drawing raises a question" in ended.err for name in ("one", "two")] == [True, True]
    for name in ("one", "two"):
        (tmp_path / f"{name}.job.yaml").write_text("answers: {'layer:PLATE': cut}\n")
    assert kerfwise(*argv).code == 0


def lettered(space: Any) -> None:
    sheet(space)
    lines(space, square(10, 10, 80))
    space.add_text("A-1", dxfattribs={"layer": "Gravur", "insert": (20, 30), "height": 8, "rotation": 30})
    space.add_point((60, 60), dxfattribs={"layer": "Gravur"})
    space.add_text("1932", dxfattribs={"insert": (40, 70), "height": 5})


def test_what_is_written_is_read_planned_checked_and_cut(tmp_path: Path) -> None:
    nest, program, plan = save_dxf(tmp_path, lettered), tmp_path / "a.nc", tmp_path / "a.plan.json"
    told = json.loads(kerfwise("read", nest, "--json").out)
    assert [(row["text"], row["height"], len(row["marks"])) for row in told["reading"]["engraved"]] == [
        ("A-1", 8.0, 5),
        ("", 2.0, 1),
    ]
    asked = kerfwise("solve", nest, "-p", "laser-st10kp-2mm", "-o", program, "--plan", plan, "--answer", "text:0=mark")
    assert asked.code == 0, asked.err
    cuts = json.loads(plan.read_text())["cuts"]
    marks = [cut["contour"] for cut in cuts if cut["kind"] == "mark"]
    assert len(marks) == 5 + 1 + 5
    assert (
        "marked texts: '0' (1), 'Gravur' (1); marked points: 'Gravur' (1)"
        in program.read_text().replace('"', "'") + asked.out
    )
    head = program.read_text()
    assert "(LAYER Gravur TEXTS MARKED 1)" in head
    assert "(LAYER Gravur POINTS MARKED 1)" in head
    assert kerfwise("check", nest, program, "-p", "laser-st10kp-2mm").code == 0
    page, sheet_of_work = tmp_path / "a.html", tmp_path / "a.pdf"
    assert kerfwise("plot", nest, plan, "-p", "laser-st10kp-2mm", "-o", page).code == 0
    assert "as a stroke of the text 'A-1'" in page.read_text(encoding="utf-8")
    assert kerfwise("sheet", nest, plan, "-p", "laser-st10kp-2mm", "-o", sheet_of_work).code == 0
    without = kerfwise("solve", nest, "-p", "laser-st10kp-2mm", "--answer", "text:0=ignore")
    assert without.code == 0, without.err


def test_a_dialect_without_marks_names_what_leaves_writing_out(tmp_path: Path) -> None:
    nest, profile = save_dxf(tmp_path, lettered), tmp_path / "b.yaml"
    profile.write_text("machine: {dialect: burny}\n")
    refused = kerfwise("solve", nest, "-p", profile)
    assert refused.code == 2
    advice = '--answer "point:Gravur=ignore" --answer "text:Gravur=ignore" leaves out what is written'
    assert advice in refused.err
    done = kerfwise("solve", nest, "-p", profile, "--answer", "point:Gravur=ignore", "--answer", "text:Gravur=ignore")
    assert done.code == 0, done.err


def test_a_repair_that_nobody_has_answered_is_not_said_to_be_answered(tmp_path: Path) -> None:
    crossed = [[200, 20], [300, 20], [300, 100], [201, 100], [199, 98], [200, 100]]
    data = {
        "format": "kerfwise-nest/1",
        "sheet": {"width": 400, "height": 200},
        "parts": [{"id": "B", "outer": crossed}],
    }
    (tmp_path / "nest.json").write_text(json.dumps(data))
    asked = kerfwise("read", tmp_path / "nest.json")
    assert asked.code == 3
    assert "the largest loop is kept, the likeliest, until it is answered" in asked.out
    answered = kerfwise("read", tmp_path / "nest.json", "--answer", "crossing=largest")
    assert answered.code == 0
    assert "the largest loop is kept, as answered" in answered.out
