"""kerfwise profile new and diff."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import pytest

from kerfwise import load_profile
from kerfwise.tests.commands.run_cli import Ended, kerfwise


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def asked(monkeypatch: pytest.MonkeyPatch, *answers: str) -> Ended:
    monkeypatch.setattr("sys.stdin", Terminal("".join(f"{answer}\n" for answer in answers)))
    return kerfwise("profile", "new", "shop")


def differences(one: str, other: str) -> dict[str, str]:
    """By key, what the second profile has in the place of what the first has."""
    ended = kerfwise("profile", "diff", one, other)
    assert ended.code == 0, ended.err
    rows = [re.split(r"  +", line.strip()) for line in ended.out.splitlines()]
    return {key: there for key, _, there in (row for row in rows if len(row) == 3) if key != "key"}


@pytest.mark.parametrize("name", ["plants/shop-2.5mm", "plants/shop-2.5mm.yaml"])
def test_a_path_may_stand_in_the_place_of_the_name(name: str) -> None:
    Path("plants").mkdir()
    assert kerfwise("profile", "new", name, "--like", "laser-wood").code == 0
    assert load_profile("plants/shop-2.5mm.yaml").name == "shop-2.5mm"


def test_asked_step_by_step(monkeypatch: pytest.MonkeyPatch) -> None:
    answers = ("laser-wood", "", "600 mm/min", "", "", "", "birch", "four", "4 mm", "")
    ended = asked(monkeypatch, *answers)
    assert ended.code == 0, ended.err
    assert "expected a length over 0" in ended.out + ended.err
    found = differences("laser-wood", "shop.yaml")
    assert found == {"machine.cut_feed": "600 mm/min", "material.name": "birch", "material.thickness": "4 mm"}
    assert kerfwise("profile", "check", "shop.yaml").code == 0


def test_a_dialect_for_another_process_is_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    ended = asked(monkeypatch, "plasma-carbon-steel", "grbl", *[""] * 8)
    assert ended.code == 0, ended.err
    assert "grbl is for laser, and this machine cuts by plasma" in ended.out + ended.err


def test_whoever_stops_answering_has_no_file(monkeypatch: pytest.MonkeyPatch) -> None:
    assert asked(monkeypatch, "laser-wood").code == 130
    assert not list(Path().iterdir())


@pytest.mark.parametrize("base", ["base.yaml", "../here/base.yaml", "deep er/base, 2.yaml"])
def test_a_copy_elsewhere_is_based_on_the_same_file(base: str) -> None:
    for folder in ("here/deep er", "there/below"):
        Path(folder).mkdir(parents=True)
    Path("here", base).write_text("based_on: water-jet\nmaterial: {thickness: 7 mm}\n")
    Path("here/a.yaml").write_text(f"# ours\nbased_on: {base}  # the plant's\nmaterial: {{kerf: 0.9 mm}}\n")
    for out in ("there/shop.yaml", "there/below/shop.yaml", "shop.yaml", "here/shop.yaml"):
        assert kerfwise("profile", "new", "shop", "--like", "here/a.yaml", "-o", out).code == 0
        assert "  # the plant's\n" in Path(out).read_text()
        assert differences(out, "here/a.yaml") == {}
    assert f"\nbased_on: {base}  #" in Path("here/shop.yaml").read_text(), "beside it nothing is rewritten"


@pytest.mark.parametrize("base", ["water-jet", "gone.yaml", "a/../..", "[1, 2]", "''"])
def test_what_a_copy_elsewhere_is_based_on_may_be_shipped_or_wrong(base: str) -> None:
    Path("here").mkdir()
    Path("there").mkdir()
    Path("here/a.yaml").write_text(f"based_on: {base}\n")
    ended = kerfwise("profile", "new", "shop", "--like", "here/a.yaml", "-o", "there/shop.yaml")
    assert ended.code == (0 if base == "water-jet" else 2), ended.err
    assert [path.read_text().count("based_on: water-jet") for path in Path("there").iterdir()] == [1] * (not ended.code)


def test_a_copy_elsewhere_whose_files_are_not_there_is_not_written() -> None:
    Path("here").mkdir()
    Path("there").mkdir()
    Path("here/a.yaml").write_text("based_on: water-jet\nmodels: [plant/*.mzn]\n")
    ended = kerfwise("profile", "new", "shop", "--like", "here/a.yaml", "-o", "there/shop.yaml")
    assert ended.code == 2
    assert "there/shop.yaml:3:10: nothing is written, for this profile could not be used" in ended.err
    assert not list(Path("there").iterdir())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["shop"], "there is no terminal to ask on: say --like PROFILE"),
        (["laser-wood", "--like", "laser-wood"], "a profile that comes with kerfwise"),
        (["sh!op", "--like", "laser-wood"], "'sh!op' cannot be a profile's name"),
        (["plants/sh!op.yaml", "--like", "laser-wood"], "'sh!op' cannot be a profile's name"),
        (["plants/shop", "--like", "laser-wood"], "there is no folder 'plants'"),
        (["shop", "--like", "lasr-wood"], "did you mean 'laser-wood'"),
        (["shop", "--like", "laser-wood", "-o", "shop.txt"], "ends in .yaml"),
        (["shop", "--like", "laser-wood", "-o", "there.yaml"], "there already"),
        (["shop", "--like", "laser-wood", "-o", "gone/shop.yaml"], "there is no folder"),
    ],
)
def test_what_cannot_be(words: list[str], said: str) -> None:
    Path("there.yaml").write_text("name: there\n")
    ended = kerfwise("profile", "new", *words)
    assert (ended.code, said in ended.err) == (2, True), ended.err
    assert [path.name for path in Path().iterdir()] == ["there.yaml"]


def test_diff() -> None:
    Path("shop.yaml").write_text("based_on: plasma-carbon-steel\nmaterial: {kerf: 2 mm}\n")
    ended = kerfwise("profile", "diff", "plasma-carbon-steel", "shop.yaml")
    assert (ended.code, ended.out) == (0, "key            A       B\nmaterial.kerf  1.5 mm  2 mm\n")
    (row,) = json.loads(kerfwise("profile", "diff", "plasma-carbon-steel", "shop.yaml", "--json").out)
    assert (row["a"], row["b"], row["b_from"]) == ("1.5 mm", "2 mm", "shop.yaml:2")
    assert kerfwise("profile", "diff", "shop.yaml", "shop.yaml").out == "the same in every key\n"
    assert "shop.yaml:2" in kerfwise("profile", "diff", "plasma-carbon-steel", "shop.yaml", "--sources").out
    assert kerfwise("profile", "diff", "shop.yaml", "gone.yaml").code == 2
