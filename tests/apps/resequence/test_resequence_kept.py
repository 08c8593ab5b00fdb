"""Burns with links, and burns with tabs, put in order by the rules: as good as the proven plan, each as it was."""

from __future__ import annotations

import dataclasses
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from kerfwise.apps.resequence.resequence import resequence
from kerfwise.apps.resequence.result import Resequenced
from kerfwise.encoder.errors import InputError
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.programs import ProgramRequest
from kerfwise.jobs.request import options_for
from kerfwise.pipeline import plan_nest
from kerfwise.postproc.check.reader.read_program import Trusted, old_on_machine
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.old.program_pieces import reordered, split_program
from kerfwise.rules.catalogue.start_side import StartSideOptions
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Links, RuleSetting, Scrap
from kerfwise.tests.postproc.dialects import cases
from kerfwise.tests.postproc.dialects.cases import plates
from kerfwise.tests.postproc.dialects.reading import with_dialect
from kerfwise.tests.postproc.plans import with_tabs
from kerfwise.tests.tools.amount import few

PLAIN = load_profile()
LINKED = dataclasses.replace(PLAIN, cuts=dataclasses.replace(PLAIN.cuts, links=Links(30.0)))
STEPS = pytest.mark.scrap("ESSI moves in steps of 0.1 mm, which the simulation of the metal does not know")
SHEET = ProgramRequest(sheet_mm=(520, 260))


def from_side(profile: Profile, side: Literal["left", "right"] = "left") -> Profile:
    """Where cutting starts: without comments, tenths of a millimetre would decide it in so even a nest."""
    setting = RuleSetting("hard", None, StartSideOptions(side=side))
    return dataclasses.replace(profile, rules=dict(profile.rules) | {"start-side": setting})


CASES = {
    "links": LINKED,
    "links, eia": with_dialect(LINKED, "eia"),
    "links, essi": with_dialect(from_side(LINKED), "essi"),
    "tabs": with_tabs("plasma-carbon-steel", slat_pitch_mm=120.0),
    "tabs, grbl": with_dialect(with_tabs("laser-st10kp-2mm", width_mm=0.5, slat_pitch_mm=120.0), "grbl"),
    "tabs, linuxcnc": with_dialect(with_tabs("laser-st10kp-2mm", width_mm=0.5, slat_pitch_mm=120.0), "linuxcnc"),
}


@cache
def solved(name: str) -> tuple[str, float]:
    """The program of a plan, and its idle travel."""
    made = plan_nest(Inputs(plates(), CASES[name]), options_for(plates(), CASES[name], work=5)).made
    assert any(p.cut.linked or p.cut.tabs for p in made.plan.cuts)
    return made.program, made.plan.totals.idle_mm


def turned_round(text: str, profile: Profile) -> str:
    """The same burns, the last first."""
    apart = split_program(old_on_machine(text, profile, Trusted(2500)))
    return reordered(apart, range(len(apart.pieces))[::-1])


def again(text: str, profile: Profile, folder: Path, **options: object) -> Resequenced:
    (folder / "old.nc").write_text(text)
    return resequence(folder / "old.nc", profile, request=SHEET, work=5, **options)  # type: ignore[arg-type]


@STEPS
@pytest.mark.parametrize("name", CASES)
def test_the_rules_are_kept_and_the_travel_is_that_of_the_proven_plan(name: str, tmp_path: Path) -> None:
    program, idle_mm = solved(name)
    made = again(turned_round(program, CASES[name]), CASES[name], tmp_path)
    assert made.before.verdict is not None
    assert made.before.verdict.broken()
    assert made.after.verdict is not None
    assert made.after.verdict.broken() == ()
    assert made.proven
    assert made.ends.startswith("proven: no order is better by these rules")
    assert made.after.idle_mm <= idle_mm + (1.0 if "essi" in name else 0.1)
    assert made.after.pierces == made.before.pierces
    left = [burn.path.vertices[:, :2] for burn in made.before.burns]
    for burn in made.after.burns:
        at = next(k for k, was in enumerate(left) if was.shape == burn.path.vertices[:, :2].shape
                  and np.abs(was - burn.path.vertices[:, :2]).max() <= 0.001)  # fmt: skip
        left.pop(at)
    assert left == []


@STEPS
@pytest.mark.parametrize("name", CASES)
def test_a_program_that_keeps_the_rules_still_keeps_them(name: str, tmp_path: Path) -> None:
    program, _ = solved(name)
    made = again(program, CASES[name], tmp_path)
    assert made.nest is not None
    assert set(made.nest.index) == set(plates().index) or "essi" in name  # it has no comments
    assert made.before.verdict is not None
    assert made.before.verdict.broken() == made.after.verdict.broken() == ()  # type: ignore[union-attr]
    assert not made.changed
    assert made.program == program


def test_a_profile_without_links_names_them_and_moves_them_all_the_same(tmp_path: Path) -> None:
    made = again(turned_round(solved("links")[0], LINKED), PLAIN, tmp_path)
    assert made.before.verdict is not None
    assert made.after.verdict is not None
    assert made.after.verdict.broken() == ("links",)
    assert "links" in made.before.verdict.broken()
    assert made.after.idle_mm < made.before.idle_mm


@pytest.mark.slow
@pytest.mark.parametrize("name", few(["tabs", "tabs, grbl"]))
def test_tabs_that_the_profile_knows_nothing_of_are_never_guessed(name: str, tmp_path: Path) -> None:
    plain = dataclasses.replace(CASES[name], rules=load_profile("plasma-carbon-steel").rules)
    with pytest.raises(InputError, match="take --without-rules") as caught:
        again(solved(name)[0], plain, tmp_path)
    assert any("have the profile ask for tabs" in text for text in caught.value.details)
    made = again(solved(name)[0], plain, tmp_path, without_rules=True)
    assert "no rule was asked" in made.ends
    assert any("no rule on contours is asked" in note for note in made.notes)


def test_common_cuts_leave_rounds_open_and_each_is_named_with_its_line(tmp_path: Path) -> None:
    common = cases.case("plates with common cuts")
    made = write_program(cases.planned("plates with common cuts"), common.nest, common.profile)
    with pytest.raises(InputError, match="take --without-rules") as caught:
        again(made, common.profile, tmp_path)
    spans = [row for row in cases.planned("plates with common cuts").cuts if row.cut.span is not None]
    assert len(caught.value.details) == len(spans) == 5
    assert all("does not close" in text for text in caught.value.details)


def test_scrap_lines_that_the_profile_makes_are_asked_of_no_old_program(tmp_path: Path) -> None:
    program, _ = solved("links")
    grid = dataclasses.replace(LINKED, cuts=dataclasses.replace(LINKED.cuts, scrap=Scrap(grid_mm=100.0)))
    made = again(program, grid, tmp_path)
    assert made.before.verdict is not None
    assert made.before.verdict.broken() == ()


def test_contours_planned_afresh_that_are_no_better_leave_the_old_program(tmp_path: Path) -> None:
    program, _ = solved("links")
    made = again(program, LINKED, tmp_path, paths="new")
    assert made.paths == "new"
    assert not made.changed
    assert made.program == program
    assert "the old program stays: planned afresh it is no better (before " in str(made)
    assert not made.proven


def test_an_old_program_that_breaks_rules_is_left_for_one_that_is_no_better_otherwise(tmp_path: Path) -> None:
    made = again(solved("links")[0], PLAIN, tmp_path, paths="new")
    assert made.changed
    assert made.after.pierces > made.before.pierces
    assert "; it is no better otherwise (before " in made.ends
    assert made.ends.endswith("but the old program breaks links")


@STEPS
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_program_that_does_not_state_its_side_is_judged_from_where_it_keeps_the_rules(
    side: Literal["left", "right"], tmp_path: Path
) -> None:
    open_side = with_dialect(LINKED, "essi")
    fixed = with_dialect(from_side(LINKED, side), "essi")
    program = plan_nest(Inputs(plates(), fixed), options_for(plates(), fixed, work=5)).made.program
    made = again(program, open_side, tmp_path)
    assert made.before.verdict is not None
    assert made.before.verdict.broken() == ()
    assert made.program == program
    assert [note for note in made.notes if f"both orders are judged from the {side}" in note]
