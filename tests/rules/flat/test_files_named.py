"""A plan, a program and a list of rules say which rules stand in files of the plant, and which are replaced."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise import Profile, load_profile, read_plan
from kerfwise.rule_kit import nest, part, rect
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.rules.outside.written import RULE

LAST = "% small-last: small parts last\n% the packers\narray[int] of var bool: small_last_holds = [before(1, 2)];\n"
AHEAD = '% ours\ninclude "beside.mzn";\narray[int] of var bool: level_ahead_holds = [before(1, 2) | k in 1..often];\n'
BESIDE = "int: often = 1;\n"
ROW = nest(300, 120, part("A", rect(10, 20, 60, 60)), part("B", rect(90, 20, 60, 60)))
PLANT = "name: plant\nmodels: [rules/*.mzn]\npython: bars_last.py\nown_rules: [{file: own.mzn, why: as agreed}]\n"


def written(folder: Path, profile: str = PLANT) -> Path:
    (folder / "rules").mkdir(exist_ok=True)
    (folder / "rules" / "small_last.mzn").write_text(LAST)
    (folder / "rules" / "level_ahead.mzn").write_text(AHEAD)
    (folder / "beside.mzn").write_text("")
    (folder / "rules" / "beside.mzn").write_text(BESIDE)
    (folder / "own.mzn").write_text("array[int] of var bool: own_holds = [before(1, 2)];\n")
    (folder / "bars_last.py").write_text(RULE)
    path = folder / "plant.yaml"
    path.write_text(profile.replace("rules/*.mzn", "rules/small_last.mzn, rules/level_ahead.mzn"))
    return path


def loaded(folder: Path) -> Profile:
    return load_profile(written(folder), trust=True)


@pytest.mark.minizinc
def test_program_and_plan_name_the_files(tmp_path: Path) -> None:
    done = package.solve(ROW, loaded(tmp_path), work=1.0)
    header = [line for line in done.program.splitlines() if "RULE FILE" in line]
    digest = hashlib.sha256(LAST.encode()).hexdigest()
    assert any("RULE FILE IN PLACE OF level-ahead" in line for line in header)
    assert any(f"RULE FILE small-last SHA256 {digest[:8]}" in line.replace(",", "") for line in header)
    assert any("RULE FILE bars-last" in line for line in header)
    assert any("RULE FILE own own" in line.replace(":", " ") for line in header)
    rules = {rule["id"]: rule for rule in json.loads(done.plan.to_json())["rules"]}
    assert rules["small-last"] | {"file": "small_last.mzn", "file_sha256": digest} == rules["small-last"]
    assert "in_place_of_shipped" not in rules["small-last"]
    assert rules["level-ahead"]["file"] == "level_ahead.mzn"
    assert rules["level-ahead"]["in_place_of_shipped"] is True
    assert rules["level-ahead"]["file_sha256"] == hashlib.sha256(f"{AHEAD}\0{BESIDE}".encode()).hexdigest()
    assert rules["bars-last"]["file"] == "bars_last.py"
    assert rules["own:own"]["file"] == "own.mzn"
    assert "file" not in rules["part-contiguous"]
    (tmp_path / "plan.json").write_text(done.plan.to_json())
    assert read_plan(tmp_path / "plan.json").rules == done.plan.rules


@pytest.mark.parametrize("file", ["rules/small_last.mzn", "rules/beside.mzn", "own.mzn", "bars_last.py"])
def test_the_digest_of_a_profile_is_of_its_rules_files_too(tmp_path: Path, file: str) -> None:
    before = loaded(tmp_path).sha256
    assert before == loaded(tmp_path).sha256
    with (tmp_path / file).open("a") as changed:
        changed.write("\n# more\n" if file.endswith(".py") else "% more\n")
    assert load_profile(tmp_path / "plant.yaml", trust=True).sha256 != before


def test_of_a_profile_without_such_files_it_is_that_of_its_text(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text("name: plant\n")
    assert load_profile(path).sha256 == hashlib.sha256(b"name: plant\n").hexdigest()


def test_a_profile_based_on_another_has_its_files_in_its_digest(tmp_path: Path) -> None:
    written(tmp_path)
    path = tmp_path / "site.yaml"
    path.write_text("based_on: plant.yaml\n")
    before = load_profile(path, trust=True).sha256
    (tmp_path / "rules" / "small_last.mzn").write_text(LAST.replace("1, 2", "2, 1"))
    assert load_profile(path, trust=True).sha256 != before


def test_the_list_of_rules_names_the_files(tmp_path: Path) -> None:
    told = kerfwise("rules", "-p", written(tmp_path), "--trust").out
    lines = {line.split()[0]: line for line in told.splitlines()}
    files = tmp_path / "rules"
    assert lines["level-ahead"].endswith(f"(file {files / 'level_ahead.mzn'}, in place of the shipped rule)")
    assert lines["small-last"].endswith(f"Small parts last (file {files / 'small_last.mzn'})")
    assert lines["bars-last"].endswith(f"(file {tmp_path / 'bars_last.py'})")
    assert lines["own:own"].endswith(f"as agreed (file {tmp_path / 'own.mzn'})")
    assert "(file" not in lines["part-contiguous"]
    assert "(file" not in kerfwise("rules").out


def test_a_files_page_shows_its_text(tmp_path: Path) -> None:
    text = LAST + "\n% cases:\n% - nest: {}\n"
    written(tmp_path)
    (tmp_path / "rules" / "small_last.mzn").write_text(text)
    page, ahead = (
        kerfwise("rules", name, "-p", tmp_path / "plant.yaml", "--trust").out for name in ("small-last", "level-ahead")
    )
    assert page.startswith("# small-last\n\nSmall parts last\n\nIt stands in `")
    assert f"```\n{LAST.strip()}\n```\n" in page
    assert "in the place of the shipped rule `level-ahead`" in ahead
