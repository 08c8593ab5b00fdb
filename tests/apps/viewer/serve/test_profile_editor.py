"""The profile editor: what is written keeps every other byte, what is wrong is named, others are left alone."""

from __future__ import annotations

import hashlib
import os
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from kerfwise import load_profile, rules
from kerfwise.apps.viewer.serve import profile_answers
from kerfwise.apps.viewer.serve.plan_request import PlanRequest
from kerfwise.encoder import files
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.inputs import plant_of
from kerfwise.postproc.output_files import write_files
from kerfwise.tests.apps.viewer.serve.served import SMALL, Open, Served, Tab

pytestmark = pytest.mark.slow

PLANT = """\
# our table, since 2019
name: ours      # as on the door
based_on: plasma-carbon-steel

rules:
    # asked for by the night shift
    level-ahead: soft                        # was hard
    heat-lag: {weight: 50 mm,  strength: soft}   # a pause
    pierce:
        clearance: 1.5 mm      # measured
machine:  {home: [0, 0]}
"""


@pytest.fixture
def tab(opened: Open, served: Served, tmp_path: Path) -> Tab:
    """A nest whose job file names a profile beside it."""
    folder = served.server.folder.path / tmp_path.name
    folder.mkdir()
    (folder / "ours.yaml").write_text(PLANT, encoding="utf-8", newline="\n")
    return opened(job="profile: ours.yaml\n")


def rule_of(tab: Tab, rule: str) -> dict[str, Any]:
    return next(one for one in tab.get("profile")["rules"] if one["id"] == rule)


def written(tab: Tab, *values: tuple[str, str, str], expected: int = 200, **said: Any) -> dict[str, Any]:
    changes = [{"rule": rule, "key": key, "to": to} for rule, key, to in values]
    seen = {"sha256": tab.get("profile")["sha256"]}
    return tab.post("profile", expected, changes=changes, **seen | said)


def ours(tab: Tab) -> str:
    return tab.nest.with_name("ours.yaml").read_bytes().decode()


def test_rules_are_told_with_units_ranges_pages_and_pictures(tab: Tab) -> None:
    told = tab.get("profile")
    assert (told["name"], told["writable"], told["file"]) == ("ours", True, f"{tab.nest.parent.name}/ours.yaml")
    lag = rule_of(tab, "heat-lag")
    assert (lag["strength"], lag["weight"], lag["strengths"]) == ("soft", "50 mm", ["hard", "soft", "off"])
    clearance = next(one for one in rule_of(tab, "pierce")["options"] if one["key"] == "clearance")
    assert (clearance["value"], clearance["said_at"]) == ("1.5 mm", "ours.yaml:10")
    assert "a length of at least 0 such as 1.5 or '1.5 mm' (also cm, m, in)" in clearance["expected"]
    page = tab.get("rule", rule="level-ahead")
    assert "What it does" in page["page"]
    assert page["wrong"].startswith("<svg")
    assert page["right"].startswith("<svg")
    assert page["wrong"] != page["right"]


def test_what_is_written_keeps_every_other_byte(tab: Tab) -> None:
    tab.solved()
    told = written(
        tab, ("heat-lag", "weight", "80 mm"), ("pierce", "clearance", "1.4 mm"), ("level-ahead", "strength", "hard")
    )
    wanted = PLANT.replace("{weight: 50 mm,", "{weight: 80 mm,").replace("clearance: 1.5 mm", "clearance: 1.4 mm")
    assert ours(tab) == wanted.replace("level-ahead: soft  ", "level-ahead: hard  ")
    assert rule_of(tab, "heat-lag")["weight"] == "80 mm"
    assert told["fits"] is False  # the plan is of the profile as it was
    assert "plan again" in tab.post("save", 422)["message"]
    assert tab.post("back", to=1)["fits"] is False
    tab.solved()
    tab.post("save")


@pytest.mark.parametrize(
    ("rule", "key", "value", "place", "words"),
    [
        ("pierce", "clearance", "1.5 kg", (10, 20), "unknown unit 'kg' in '1.5 kg'"),
        ("heat-lag", "weight", "-3 mm", (8, 24), "expected a length of at least 0"),
        ("level-ahead", "strength", "medium", (7, 18), "expected one of hard, soft, off, got 'medium'"),
        ("heat-lag", "colour", "red", (8, 16), "unknown key 'colour'"),
        ("no-such-rule", "strength", "off", (7, 5), "unknown rule 'no-such-rule'"),
    ],
)
def test_what_a_profile_cannot_say_is_named_with_its_place(
    tab: Tab, rule: str, key: str, value: str, place: tuple[int, int], words: str
) -> None:
    told = written(tab, ("heat-lag", "weight", "90 mm"), (rule, key, value), expected=422)
    assert words in told["message"]
    assert told["message"].startswith("nothing is written")
    assert Path(told["file"]).name == "ours.yaml"
    assert (told["line"], told["column"]) == place
    assert ours(tab) == PLANT
    assert [file.name for file in tab.nest.parent.iterdir() if file.suffix == ".yaml"].count("ours.yaml") == 1
    assert not list(tab.nest.parent.glob(".kerfwise-*"))


def test_a_file_that_has_changed_is_not_written_over(tab: Tab) -> None:
    seen = tab.get("profile")["sha256"]
    path = tab.nest.with_name("ours.yaml")
    path.write_text(PLANT + "# more\n", encoding="utf-8", newline="\n")
    told = written(tab, ("heat-lag", "weight", "80 mm"), expected=422, sha256=seen)
    assert "has changed since it was shown" in told["message"]
    assert ours(tab) == PLANT + "# more\n"
    tab.version -= 1
    assert tab.post("profile", 409, changes=[], sha256=seen)["kind"] == "stale"


def test_what_was_written_is_told_whatever_stands_there_since(tab: Tab, monkeypatch: pytest.MonkeyPatch) -> None:
    def written_and_replaced(files: dict[Path, bytes]) -> None:
        write_files(files)
        tab.nest.with_name("ours.yaml").write_text(PLANT + "# more\n", encoding="utf-8", newline="\n")

    monkeypatch.setattr("kerfwise.apps.viewer.serve.profile_writing.write_files", written_and_replaced)
    told = written(tab, ("heat-lag", "weight", "80 mm"))
    text = PLANT.replace("{weight: 50 mm,", "{weight: 80 mm,")
    assert told["written"]["sha256"] == hashlib.sha256(text.encode()).hexdigest()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such files")
@pytest.mark.parametrize("other", ["pipe", "link"])
def test_another_file_in_the_place_of_a_profile_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, other: str
) -> None:
    """It comes after the profile was read, and before its bytes are; whoever writes into the pipe is not waited for."""
    folder, outside = tmp_path / "nests", tmp_path / "outside.yaml"
    folder.mkdir()
    for file in (folder / "ours.yaml", outside):
        file.write_text(PLANT, encoding="utf-8")
    (folder / "small.json").write_text(SMALL, encoding="utf-8")
    wanted = PlanRequest(str(folder / "small.json"), "profile: ours.yaml\n")

    def plant_and_other(*words: Any) -> Any:
        plant = plant_of(*words)
        (folder / "ours.yaml").unlink()
        if other == "link":
            (folder / "ours.yaml").symlink_to(outside)
        else:
            os.mkfifo(folder / "ours.yaml")
            threading.Thread(target=(folder / "ours.yaml").write_bytes, args=(b"",), daemon=True).start()
        return plant

    monkeypatch.chdir(folder)
    monkeypatch.setattr(files, "_only_within", (str(folder.resolve()), str(Path(rules.__file__).parent)))
    monkeypatch.setattr(profile_answers, "plant_of", plant_and_other)
    with pytest.raises(InputError, match="not read: it"):
        profile_answers.profile_told(wanted)


def test_a_profile_outside_the_folder_is_not_written(served: Served, opened: Open, tmp_path: Path) -> None:
    outside = served.also[0] / "outside.yaml"
    outside.write_text(PLANT, encoding="utf-8", newline="\n")
    link = served.server.folder.path / tmp_path.name / "linked.yaml"
    link.parent.mkdir()
    link.symlink_to(outside)
    tab = opened(job="profile: linked.yaml\n")
    for said in ({}, {"as": "../new.yaml"}, {"as": "linked.yaml"}, {"as": "x.job.yaml"}, {"as": "small.json"}):
        written(tab, ("heat-lag", "weight", "80 mm"), expected=422, **said)
    assert "lies outside the folder" in tab.get("profile")["why_not"]
    assert outside.read_text(encoding="utf-8") == PLANT
    assert sorted(file.name for file in served.also[0].iterdir()) == ["outside.yaml"]
    served.server.profile = str(outside)
    try:
        written(tab, ("heat-lag", "weight", "80 mm"))
    finally:
        served.server.profile = None
    assert outside.read_text(encoding="utf-8") == PLANT.replace("{weight: 50 mm", "{weight: 80 mm")


def test_a_shipped_profile_is_saved_as_one_that_is_based_on_it(opened: Open) -> None:
    tab = opened()
    assert "comes with kerfwise" in written(tab, ("heat-lag", "weight", "80 mm"), expected=422)["message"]
    told = written(tab, ("heat-lag", "weight", "80 mm"), **{"as": "mine.yaml"})
    assert told["profile"] == "mine"
    made = load_profile(tab.nest.with_name("mine.yaml"))
    assert made.rules["heat-lag"].weight == 80.0
    assert made.rules["level-ahead"] == load_profile("plasma-carbon-steel").rules["level-ahead"]
    assert "there is a file mine.yaml already" in written(
        tab, ("heat-lag", "weight", "90 mm"), expected=422, **{"as": "mine.yaml"}
    )["message"]  # fmt: skip
    written(tab, ("heat-lag", "weight", "90 mm"))  # now it is the nest's, and lies in the folder
    assert load_profile(tab.nest.with_name("mine.yaml")).rules["heat-lag"].weight == 90.0


def test_the_effect_is_told_and_nothing_is_changed(tab: Tab) -> None:
    before = tab.state()
    told = tab.post("effect", changes=[{"rule": "level-ahead", "key": "strength", "to": "off"}])
    assert told["before"]["cuts"] == told["after"]["cuts"] == 4
    assert told["after"]["idle_mm"] < told["before"]["idle_mm"] - 50
    assert told["after"]["objective_mm"] < told["before"]["objective_mm"] - 50
    assert (told["before"]["breaches"], told["before"]["excuses"]) == ({"heat-lag": 2}, 0)
    assert told["after"]["breaches"] == {"heat-lag": 1, "level-ahead": 1}  # it is off, and now broken
    refused = tab.post("effect", 422, changes=[{"rule": "pierce", "key": "clearance", "to": "1.5 kg"}])
    assert "unknown unit 'kg'" in refused["message"]
    assert "expected a list" in tab.post("effect", 422, changes=[])["message"]
    assert tab.state() == before
    assert ours(tab) == PLANT


@pytest.fixture
def page(browser: Browser, served: Served, tab: Tab) -> Iterator[Any]:
    wrong: list[str] = []
    made = browser.new_page(viewport={"width": 1400, "height": 900})
    made.set_default_timeout(60_000)
    made.on("pageerror", lambda error: wrong.append(str(error)))
    made.on("console", lambda said: wrong.append(said.text) if said.type in ("error", "warning") else None)
    made.goto(served.entrance)
    made.goto(f"{served.address}/nest/{tab.id}")
    made.wait_for_selector("[data-ready=yes]", state="attached")
    yield made
    made.close()
    assert wrong == []


def test_a_rule_is_switched_its_effect_seen_and_written(page: Any, tab: Tab) -> None:
    page.click("#tab-profile")
    page.click("[data-rule=level-ahead] summary")
    page.wait_for_selector("[data-rule=level-ahead] img[alt='level-ahead: right']")
    for image in page.locator("[data-rule=level-ahead] img").all():
        assert image.evaluate("one => one.decode().then(() => one.naturalWidth)") > 100
    page.select_option("[aria-label='strength of level-ahead in the profile']", "off")
    page.wait_for_selector("#profile-effect table")
    assert page.locator("#profile-effect caption").inner_text() == "level-ahead.strength: off"
    assert page.locator("#profile-effect tr").nth(1).inner_text().split("\t") == ["idle travel", "0.688 m", "0.598 m"]
    assert "breaches of level-ahead\t0\t1" in page.locator("#profile-effect").inner_text()
    assert ours(tab) == PLANT
    page.click("#profile-write")
    expect(page.locator("#profile-bar")).to_be_hidden()
    assert ours(tab) == PLANT.replace("level-ahead: soft  ", "level-ahead: off  ")
    assert page.locator("[data-rule=level-ahead] summary small").inner_text() == "off"
