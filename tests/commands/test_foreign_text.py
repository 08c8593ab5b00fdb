"""Foreign text is shown, not obeyed, wherever it comes from and wherever it goes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.escape import OBEYED, escape_text
from kerfwise.encoder.files import strict_json
from kerfwise.encoder.nest import Note
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.commands.test_boundary import PLAIN

FORGED = "ok: every hard rule holds"
FOREIGN = ["A\n" + FORGED, "A\r" + FORGED, "A\x1b[2J", "A\u202eB", "A\u2028" + FORGED, "A\x85B", "A\x00", "A\ud800"]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def obeyed(text: str) -> list[str]:
    from unicodedata import category

    return [c for c in text if category(c) in OBEYED and c not in "\n"]


@pytest.mark.parametrize("name", FOREIGN)
def test_a_part_id(name: str, here: Path) -> None:
    data = json.loads(json.dumps(PLAIN))
    data["parts"][0]["id"] = name
    data["parts"][1]["outer"] = [[110, 20], [250, 20], [250, 120], [110, 120]]
    (here / "broken.json").write_text(json.dumps(data))
    ended = kerfwise("facts", "broken.json")
    assert ended.code == 2
    assert "overlap" in ended.err
    assert not obeyed(ended.err)
    assert FORGED not in ended.err.splitlines()
    data["parts"][1]["outer"] = PLAIN["parts"][1]["outer"]  # type: ignore[index]
    (here / "fine.json").write_text(json.dumps(data))
    ended = kerfwise("solve", "fine.json", "--work", "0.1", "-o", "a.nc", "--plan", "a.plan.json", "--picture", "a.svg")
    assert ended.code == 0
    assert ended.out.splitlines().count(FORGED) == 1
    assert not obeyed(ended.out + ended.err)
    for path in ("a.nc", "a.plan.json", "a.svg"):
        text = (here / path).read_text(encoding="utf-8")
        assert not obeyed(text)
        assert FORGED not in text.splitlines()
    assert escape_text(name) in json.dumps(json.loads((here / "a.plan.json").read_text())).replace("\\\\", "\\")
    assert kerfwise("check", "fine.json", "a.nc").code == 0
    assert kerfwise("check", "fine.json", "a.plan.json").code == 0


def test_names_of_files_and_profiles(here: Path) -> None:
    nest = here / f"a\n{FORGED}.json"
    nest.write_text(json.dumps(PLAIN))
    profile = here / "p\x1b[2J.yaml"
    profile.write_text("based_on: plasma-carbon-steel\n")
    ended = kerfwise("solve", nest, "-p", profile, "--work", "0.1")
    assert ended.code == 0
    assert ended.out.splitlines().count(FORGED) == 1
    assert not obeyed(ended.out + ended.err)
    for path in here.iterdir():
        if path not in (nest, profile):
            assert not obeyed(path.read_text(encoding="utf-8"))
    for argv in (("facts", f"no\n{FORGED}.json"), ("facts", nest, "-p", f"no\n{FORGED}.yaml")):
        ended = kerfwise(*argv)
        assert (ended.code, FORGED in ended.err.splitlines()) == (2, False)


@pytest.mark.parametrize("name", ["a\0b", "a\ud800b", "n" * 300])
def test_names_that_no_file_system_holds(name: str, here: Path) -> None:
    (here / "plain.json").write_text(json.dumps(PLAIN))
    base = json.dumps(f"{name}.yaml")
    (here / "based.yaml").write_text(f"based_on: {base}\n")
    (here / "spoken.yaml").write_text(f"machine: {{dialect: {base}}}\n")
    for argv in (
        ("facts", f"{name}.json"),
        ("facts", "plain.json", "-p", f"{name}.yaml"),
        ("facts", "plain.json", "-p", "based.yaml"),
        ("solve", "plain.json", "-p", "spoken.yaml"),
        ("facts", "plain.json", "-o", f"{name}.json"),
        ("plot", "plain.json", "-o", f"{name}.svg"),
        ("check", "plain.json", f"{name}.nc"),
        ("check", "plain.json", f"{name}.json"),
        ("solve", "plain.json", "-o", f"{name}.nc"),
        ("solve", "plain.json", "--lock-from", f"{name}.nc", "--upto", "1"),
    ):
        ended = kerfwise(*argv)
        assert (ended.code, ended.out) == (2, ""), (argv, ended)
        assert not obeyed(ended.err)


def test_messages_and_notes() -> None:
    assert str(InputError(f"a\n{FORGED}", file=f"b\n{FORGED}", details=(f"c\n{FORGED}",))).splitlines() == [
        f"b\\u000a{FORGED}: a\\u000a{FORGED}",
        f"  - c\\u000a{FORGED}",
    ]
    assert Note("warning", f"layer\n{FORGED}").text == f"layer\\u000a{FORGED}"


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ('{"a": 1,\n "a": 2}', "2:2: the key 'a' is given twice, first in line 1, column 2"),
        ('{"parts": [{"id": "A"}, {"id": "B",\n\n  "id": "B"}]}', "3:3: the key 'id' is given twice, first in line 1"),
        ('{"a": {"a": 1}, "b": [{"a": 1}, {"a": 1}], "\\u0061": 2}', "1:44: the key 'a' is given twice"),
        ('{"x": "{\\"a\\": 1, \\"a\\": 2}", "x": 1}', "1:31: the key 'x' is given twice"),
    ],
)
def test_a_key_given_twice(text: str, place: str) -> None:
    with pytest.raises(InputError) as caught:
        strict_json(text)
    assert str(caught.value).startswith(place)


def test_a_key_given_twice_in_a_nest_and_in_a_plan(here: Path) -> None:
    text = json.dumps(PLAIN, indent=1)
    (here / "plain.json").write_text(text)
    assert kerfwise("solve", "plain.json", "--work", "0.1").code == 0
    (here / "twice.json").write_text(text.replace('"width": 400', '"width": 400,\n  "width": 500'))
    ended = kerfwise("facts", "twice.json")
    assert (ended.code, ended.err.split(":")[1:3]) == (2, [" twice.json", "5"])
    assert "first in line 4" in ended.err
    plan = (here / "plain.plan.json").read_text()
    (here / "twice.plan.json").write_text(plan.replace('"start_side":', '"start_side": "left",\n"start_side":', 1))
    ended = kerfwise("check", "plain.json", "twice.plan.json")
    assert ended.code == 2
    assert "the key 'start_side' is given twice" in ended.err
