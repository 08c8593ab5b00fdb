"""Nests and programs that went wrong once, each with what is right: `tests/metal/cases`."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from kerfwise import InputError, load_profile, read_nest, read_plan
from kerfwise.rule_kit import nest, part, rect
from kerfwise.tests.checked import checked
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.metal.plant import plant
from kerfwise.tests.metal.simulate import simulate
from kerfwise.tests.metal.test_loose_metal import made

CASES = Path(__file__).parent / "cases"


def test_rounded_plates_in_a_grid_are_cut_by_whole_rounds_and_that_is_said(tmp_path: Path) -> None:
    """Where two neighbours of one are out, its rounded corner between them is apart from the rest."""
    drawing, plant_file = CASES / "13-common-rounded-grid.json", CASES / "13-common-rounded-grid.yaml"
    program, plan = tmp_path / "grid.nc", tmp_path / "grid.plan.json"
    ended = kerfwise("solve", drawing, "-p", plant_file, "--work", "0.3", "-o", program, "--plan", plan)
    assert ended.code == 0
    assert all(planned.cut.span is None for planned in read_plan(plan).cuts)
    assert simulate(read_nest(drawing), program.read_text(), **plant(load_profile(plant_file))) == []
    assert (
        "cuts.common: no common cuts for P00.outer, P01.outer, P10.outer, P11.outer: in any order some part would be "
        "left with two stretches to cut, as rounded corners between two neighbours are; these parts are all "
        "cut all round"
    ) in ended.err


def test_a_profile_without_leads_says_what_contradicts_it_and_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="without a lead the torch pierces on its path") as refused:
        load_profile(CASES / "10-lead-none.yaml")
    assert (refused.value.line, refused.value.column) == (2, 15)
    assert "rules: {pierce: off}" in refused.value.message
    mended = tmp_path / "mended.yaml"
    mended.write_text((CASES / "10-lead-none.yaml").read_text() + "rules: {pierce: off}\n")
    assert load_profile(mended).leads.lead == "none"


def test_a_flame_is_heated_wherever_it_begins() -> None:
    """Counted in the text: after each M3 the flame stands for 10 s, also where scrap lines begin at the edge."""
    sheet = read_nest(CASES / "03-oxyfuel-scrap-cold-edge.json")
    profile = load_profile(CASES / "03-oxyfuel-scrap-cold-edge.yaml")
    found = made(sheet, profile)
    assert found.verdict.ok
    rows = [row.split(" ", 1)[-1] for row in found.program.split("\n")]
    lit = [k for k, row in enumerate(rows) if row == "M3 S1"]
    assert len(lit) == 8
    assert {rows[k + 1] for k in lit} == {"G4 P10"}
    at_edge = [k for k in lit if rows[k - 1].split()[1] == "X0" or rows[k - 1].split()[2] in ("Y0", "Y200")]
    assert len(at_edge) >= 2
    cold = [row for k, row in enumerate(found.program.split("\n")) if k - 1 not in at_edge]
    (judged,) = [rule for rule in checked(sheet, "\n".join(cold), profile).rules if rule.id == "pierce-delay"]
    assert len(judged.violations) == len(at_edge)


def test_so_is_one_that_begins_at_holes_that_were_pierced_before() -> None:
    sheet = nest(300, 200, part("A", rect(30, 30, 90, 120)), part("B", rect(160, 30, 90, 120)))
    profile = load_profile("oxyfuel-thick-plate")
    profile = replace(profile, cuts=replace(profile.cuts, pierce_pass="sheet"))
    found = made(sheet, profile)
    assert found.verdict.ok
    rows = [row.split(" ", 1)[-1] for row in found.program.split("\n")]
    assert [rows[k + 1] for k, row in enumerate(rows) if row == "M3 S1"] == ["G4 P10"] * 4


def test_a_conflict_with_what_is_out_after_a_stop_ends_with_1(tmp_path: Path) -> None:
    words = [CASES / "17-resume-conflict.json", "-p", CASES / "17-resume-conflict.yaml"]
    words += ["--lock-from", CASES / "17-resume-conflict.nc", "--upto", "3", "--redo-last", "--work", "0.2"]
    words += ["-o", tmp_path / "rest.nc", "--conflict-picture", tmp_path / "conflict.svg"]
    result = kerfwise("solve", *words)
    assert result.code == 1
    assert (tmp_path / "conflict.svg").exists()
    assert not (tmp_path / "rest.nc").exists()


def test_a_feed_law_holds_for_the_feed_that_it_was_measured_for(tmp_path: Path) -> None:
    """Counted by hand: lengths over the F word, and the waits, are no more than the time in the program's header."""
    (tmp_path / "laser.yaml").write_text("name: laser\nbased_on: laser-st10kp-2mm\nmachine: {cut_feed: 2 m/min}\n")
    own = load_profile(tmp_path / "laser.yaml")
    assert (own.time.model, own.time.feed_by_blocks) == ("acceleration", None)
    assert load_profile("laser-st10kp-2mm").time.model == "blocks"
    sheet = nest(300, 200, part("A", rect(30, 30, 90, 120)), part("B", rect(160, 30, 90, 120)))
    found = made(sheet, own)
    lit_mm = 2 * (2 * (90 + 120) + 4 * 0.1 * math.pi / 2)
    least_s = lit_mm / (2000 / 60) + 2 * own.machine.pierce_time_s
    assert least_s <= found.plan.totals.time_s <= 1.1 * least_s
