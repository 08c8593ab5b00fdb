"""Whatever nobody foresaw ends in one line, a report file and exit code 70."""

from __future__ import annotations

import errno
import json
import re
from pathlib import Path
from typing import Any

import pytest

import kerfwise as package
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.nest_job import request
from kerfwise.postproc.verdict import check_plan
from kerfwise.rules.catalogue.level_ahead import LevelAhead
from kerfwise.rules.profile.load import load_profile
from kerfwise.tests.commands.run_cli import Ended, kerfwise

NEST = Path(package.__file__).parent / "examples" / "nests" / "e1x_6.json"
PLAIN = {
    "format": "kerfwise-nest/1",
    "sheet": {"width": 400, "height": 200},
    "parts": [
        {"id": "A", "outer": [[20, 20], [120, 20], [120, 120], [20, 120]]},
        {"id": "B", "outer": [[150, 20], [250, 20], [250, 120], [150, 120]]},
    ],
}


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def ended_with(error: BaseException, monkeypatch: pytest.MonkeyPatch) -> Ended:
    def fail(*args: object, **options: object) -> Any:
        raise error

    monkeypatch.setattr(request, "plant_of", fail)
    return kerfwise("facts", NEST)


UNFORESEEN = [
    MemoryError(),
    EOFError("Ran out of input"),
    RecursionError("maximum recursion depth exceeded"),
    ZeroDivisionError("division by zero"),
    KeyError("P3.outer"),
    BrokenPipeError(errno.EPIPE, "Broken pipe"),
    OSError(errno.EIO, "Input/output error"),
    SystemExit(0),
    GeneratorExit(),
    AssertionError("two\nlines"),
]


@pytest.mark.parametrize("error", UNFORESEEN, ids=lambda error: type(error).__name__)
def test_one_line_a_report_and_exit_code_70(error: BaseException, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ended = ended_with(error, monkeypatch)
    assert ended.code == 70
    assert len(ended.err.splitlines()) == 1
    assert type(error).__name__ in ended.err
    assert str(NEST) in ended.err
    [report] = here.iterdir()
    assert report.name in ended.err
    text = report.read_text(encoding="utf-8")
    assert "Traceback" in text
    assert f"command: kerfwise facts {NEST}".replace(str(Path.home()), "~") in text
    assert "numpy " in text


def test_ctrl_c_is_none_of_these(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert ended_with(KeyboardInterrupt(), monkeypatch).code == 130
    assert list(here.iterdir()) == []


def test_a_report_takes_no_place_of_another_and_tells_no_secrets(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLANT_TOKEN", "hunter2-of-the-environment")
    said = f"{Path.home()}/x of https://me:hunter2@plant/nest, password=hunter2"
    for _ in range(2):
        ended_with(ValueError(said), monkeypatch)
    reports = [path.read_text() for path in here.iterdir()]
    assert len(reports) == 2
    assert all("hunter2" not in text and "~/x" in text for text in reports)


def test_a_folder_that_takes_no_report(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (here / "beside").mkdir()
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(here / "nowhere"))
    monkeypatch.chdir(here / "beside")
    (here / "beside").rmdir()
    ended = ended_with(ValueError("odd"), monkeypatch)
    assert ended.code == 70
    assert "could not be written" in ended.err
    monkeypatch.chdir(here)


@pytest.mark.parametrize("hook", ["statements", "pairs", "reason"])
def test_an_exception_in_a_rule_names_the_rule(hook: str, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(self: object, *args: object) -> Any:
        raise ZeroDivisionError("division by zero")

    rule = type("Broken", (LevelAhead,), {hook: fail, "__module__": __name__})()
    with pytest.raises(ZeroDivisionError) as caught:
        list(getattr(rule, hook)(*[None] * (2 if hook == "statements" else 3)))
    monkeypatch.setattr(request, "plant_of", lambda *asked: (_ for _ in ()).throw(caught.value))
    where = rf"in rule level-ahead \(test_boundary.py, line {fail.__code__.co_firstlineno + 1}\): ZeroDivisionError"
    assert re.search(where, kerfwise("facts", NEST).err)


def test_an_exception_in_a_rule_that_yields(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(self: object, *args: object) -> Any:
        yield 1
        raise KeyError("A")

    rule = type("Broken", (LevelAhead,), {"statements": fail, "__module__": __name__})()
    with pytest.raises(KeyError) as caught:
        list(rule.statements(None, None))
    line = fail.__code__.co_firstlineno + 2
    assert caught.value.__notes__ == [f"in rule level-ahead (test_boundary.py, line {line})"]


def test_messages_without_a_file_name_the_nest(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert kerfwise("facts", NEST, "--sheet", "big").err.startswith("kerfwise: --sheet 'big'")
    ended = ended_with(InputError("A.outer cannot be cut"), monkeypatch)
    assert ended.err == f"kerfwise: {NEST}: A.outer cannot be cut\n"


@pytest.mark.slow
def test_a_nest_is_named_as_it_was_given(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nest = here / "beside" / "plain.json"
    nest.parent.mkdir()
    nest.write_text(json.dumps(PLAIN))
    for typed in (str(nest), "beside/plain.json"):
        for verb in (("facts", typed), ("solve", typed, "--work", "0.1")):
            ended = kerfwise(*verb, "-p", wide(here))
            assert ended.code == 2
            assert ended.err.startswith(f"kerfwise: {typed}: "), ended.err


def wide(folder: Path) -> Path:
    """A profile whose leads have no room on so small a sheet."""
    path = folder / "wide.yaml"
    path.write_text("name: wide\nleads: {lead: line, lead_in: 300 mm, lead_in_min: 300 mm}\n")
    return path


def test_a_program_that_cannot_be_read_back_is_no_place(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nest = here / "plain.json"
    nest.write_text(json.dumps(PLAIN))
    check = check_plan.check_nc

    def refused(nest: Any, text: str, *rest: Any, **more: Any) -> Any:
        return check(nest, text.replace("M5", "STOP"), *rest, **more)

    monkeypatch.setattr(check_plan, "check_nc", refused)
    ended = kerfwise("solve", nest, "-o", "out.nc", "--work", "0.1")
    assert ended.code == 2
    assert f"{load_profile().file}: the program that dialect" in ended.err
    assert "cannot be read back (block '" in ended.err
    assert not (here / "out.nc").exists()
