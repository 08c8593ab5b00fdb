"""kerfwise heat: a plan and its program tell the same of the sheet, in figures, as a table and as pictures."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise.tests.commands.run_cli import kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    assert kerfwise("solve", NEST, "--work", 2, "-o", folder / "e.nc", "--plan", folder / "e.json").code == 0
    return folder


def figures(*argv: object) -> dict[str, object]:
    done = kerfwise("heat", NEST, *argv, "--json")
    assert done.code == 0, done.err
    data = json.loads(done.out)
    assert isinstance(data, dict)
    return data


def test_plan_and_program_agree(made: Path) -> None:
    plan, program = figures(made / "e.json"), figures(made / "e.nc")
    assert plan["model"] == "physical"
    assert plan["grid_mm"] == 5.0
    assert plan["overheats"] == program["overheats"]
    assert plan["peak_c"] == pytest.approx(program["peak_c"], abs=0.2)
    assert 0 <= float(str(plan["energy_error"])) < 0.01
    assert [part["part"] for part in plan["parts"]] == [part["part"] for part in program["parts"]]


def test_the_logical_model_has_no_energies(made: Path) -> None:
    data = figures(made / "e.json", "--model", "logical")
    assert (data["model"], data["energy_error"]) == ("logical", None)


def test_a_torch_that_leaves_no_heat(made: Path) -> None:
    done = kerfwise("heat", NEST, made / "e.json", "-p", "water-jet")
    assert done.code == 0
    assert "peak       20.0 °C" in done.out
    assert "overheats  0 points" in done.out


def test_a_program_for_another_control_is_not_guessed_at(made: Path) -> None:
    done = kerfwise("heat", NEST, made / "e.nc", "-p", "water-jet")
    assert done.code == 2
    assert "$0: tools by number are not supported here in a program for LinuxCNC" in done.err


@pytest.mark.slow
def test_map_and_frames(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kerfwise.apps.heat.verbs.FRAMES", 4)
    done = kerfwise("heat", NEST, made / "e.json", "-o", tmp_path / "map.png", "--frames", tmp_path / "frames")
    assert done.code == 0, done.err
    assert (tmp_path / "map.png").read_bytes().startswith(PNG)
    frames = sorted((tmp_path / "frames").iterdir())
    assert [f.name for f in frames] == [f"frame_{k:03d}.png" for k in (1, 2, 3, 4)]
    assert len({f.read_bytes() for f in frames}) == 4


def test_wrong_use_is_said(made: Path, tmp_path: Path) -> None:
    done = kerfwise("heat", NEST, made / "e.json", "-o", tmp_path / "map.svg")
    assert (done.code, "give a name ending in .png" in done.err) == (2, True)
    untimed = json.loads((made / "e.json").read_text())
    for cut in untimed["cuts"]:
        cut["start_s"] = cut["end_s"] = 0
    (tmp_path / "untimed.json").write_text(json.dumps(untimed))
    done = kerfwise("heat", NEST, tmp_path / "untimed.json")
    assert (done.code, "does not say when its contours are cut" in done.err) == (2, True)
    late = json.loads((made / "e.json").read_text())
    late["cuts"][2]["end_s"] += 50
    (tmp_path / "late.json").write_text(json.dumps(late))
    done = kerfwise("heat", NEST, tmp_path / "late.json")
    assert (done.code, f"{tmp_path / 'late.json'}: the plan is damaged: " in done.err) == (2, True), done.err
