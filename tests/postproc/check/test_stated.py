"""What a program says of itself: its time against the sum over its own words, its state against the check."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise import solve
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check.reader.read_program import read_on_machine
from kerfwise.postproc.check.stated import SHARE, stated_time_s, summed_time, wrong_state, wrong_times
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.plan_state import Place, PlanState
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.time_section import Time, shipped_laws
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.fuzz.inputs import seeds
from kerfwise.tests.postproc import stated_times

ROOT = Path(package.__file__).parent
SHEET = ROOT / "examples" / "nests" / "e1x_6.json"
PAGE = (ROOT / "docs" / "time.md").read_text(encoding="utf-8")
PLASMA = ("linuxcnc", "linuxcnc-qtplasmac", "eia", "burny", "essi")
DIALECTS = [*((dialect, "plasma-carbon-steel") for dialect in PLASMA), ("grbl", "laser-wood")]
MODELS = {
    "constant": Time(),
    "blocks": Time("blocks", shipped_laws()["bystar-3015-amg3m-1mm"]),
    "acceleration": Time("acceleration", acceleration_mm_s2=500.0),
}


def plant(dialect: str, of: str, model: str = "constant") -> Profile:
    profile = load_profile(of)
    return replace(profile, machine=replace(profile.machine, dialect=dialect), time=MODELS[model])


@cache
def planned(of: str) -> tuple[Nest, Plan]:
    profile = load_profile(of)
    return profile.as_cut(read_nest(SHEET)), solve(read_nest(SHEET), profile, work=1).plan


def made(dialect: str, of: str, model: str) -> tuple[Nest, Plan, str, Profile]:
    profile = plant(dialect, of, model)
    nest, plan = planned(of)
    plan = with_times(plan, nest, profile)
    return nest, plan, write_program(plan, nest, profile), profile


@pytest.mark.parametrize("model", MODELS)
def test_six_dialects_say_what_their_words_come_to(model: str) -> None:
    """As the table of docs/time.md has it."""
    rows = []
    for dialect, of in DIALECTS:
        nest, plan, program, profile = made(dialect, of, model)
        read = read_on_machine(program, nest, profile)
        found, header_s = summed_time(read, profile), stated_time_s(read.comments)
        said_s = plan.totals.time_s if header_s is None else header_s
        rows.append(f"| `{dialect}` | {said_s:.1f} | {found.words_s:.1f} |")
        assert found.least_s * (1 - SHARE) <= said_s <= found.most_s * (1 + SHARE)
        assert (header_s is None) == (dialect in ("burny", "essi"))
        assert not list(wrong_times(read, profile, plan.totals.time_s))
        if model == "constant":
            assert said_s == pytest.approx(found.words_s, rel=SHARE)
    if model == "constant":
        assert "\n".join(rows) in PAGE, "\n".join(rows)


@pytest.mark.slow
@pytest.mark.parametrize("asked", ["corners at 0.6", "small holes at half", "tabs"])
def test_programs_in_six_dialects_state_what_their_words_come_to(asked: str) -> None:
    """A part of the table that `python -m kerfwise.tests.postproc.stated_times` prints."""
    found = list(stated_times.rows("e1x_6", read_nest(SHEET), asked))
    assert len(found) == len(stated_times.DIALECTS)
    assert max(row.apart for row in found) <= SHARE
    assert stated_times.table(found).splitlines()[-1] in PAGE


def with_header(program: str, share: float) -> str:
    """The program, its header saying that share of its time."""
    found = re.search(r"ESTIMATED TIME (\d+) H (\d+) MIN (\d+) S", program)
    assert found is not None
    hours, minutes, seconds = map(int, found.groups())
    minutes, seconds = divmod(round((3600 * hours + 60 * minutes + seconds) * share), 60)
    return program.replace(found[0], f"ESTIMATED TIME 0 H {minutes:02d} MIN {seconds:02d} S")


@pytest.mark.parametrize("model", MODELS)
def test_half_of_the_time_is_told_and_thrice_too(model: str) -> None:
    nest, plan, program, profile = made("linuxcnc", "plasma-carbon-steel", model)
    words_s = summed_time(read_on_machine(program, nest, profile), profile).words_s
    for share, word in ((0.5, "short"), (3.0, "long")):
        result = check_program(nest, with_header(program, share), profile, plan=plan)
        (told,) = (text for text in result.warnings if "says that it takes" in text)
        assert told.startswith("the program says that it takes ")
        assert f"which is too {word}: its feeds, waits and ways come to {words_s:.1f} s" in told
    assert not [text for text in check_program(nest, program, profile, plan=plan).warnings if "it takes" in text]


def test_a_plan_is_held_against_a_program_without_comments() -> None:
    nest, plan, program, profile = made("essi", "plasma-carbon-steel", "constant")
    half = replace(plan, totals=replace(plan.totals, time_s=plan.totals.time_s / 2))
    (told,) = (text for text in check_program(nest, program, profile, plan=half).warnings if "it takes" in text)
    assert told.startswith(f"the plan says that it takes {half.totals.time_s:.1f} s, which is too short")


def test_a_law_for_another_feed_was_too_short() -> None:
    """What the laser's program said before: the time by a law for 5.85 m/min over F words of 2 m/min."""
    own = load_profile("laser-st10kp-2mm")
    slow = replace(own, machine=replace(own.machine, cut_feed_mm_s=2000 / 60))
    nest, plan = planned("laser-st10kp-2mm")
    program = write_program(with_times(plan, nest, slow), nest, slow)
    told = list(wrong_times(read_on_machine(program, nest, slow), replace(slow, time=Time("acceleration"))))
    assert len(told) == 1
    assert "too short" in told[0]


KEPT, TWO, BROKEN = (
    PlanState("kept"),
    PlanState.of([Place("excused", "part-rigidity", (f"P{k}.outer",), "thin") for k in (1, 2)]),
    PlanState.of([Place("broken", "pierce-delay", (), "too short")]),
)
STATES = {
    ("STATE KEPT", KEPT): "",
    ("STATE KEPT", TWO): "says of itself that it is kept, and the check finds: ok, but 2 places are not kept",
    ("STATE KEPT", BROKEN): "that it is kept, and the check finds: FAILED: 1 hard rules broken: pierce-delay",
    ("STATE KEPT BUT FOR 1 PLACE", TWO): "kept but for 1 place, and the check finds: ok, but 2 places are not kept",
    ("STATE KEPT BUT FOR 2 PLACES", TWO): "",
    ("STATE KEPT BUT FOR 3 PLACES", TWO): "",
    ("STATE KEPT BUT FOR 2 PLACES", BROKEN): "kept but for 2 places, and the check finds: FAILED",
    ("STATE BROKEN", BROKEN): "",
    ("STATE BROKEN", KEPT): "",
    ("START SIDE LEFT", BROKEN): "",
}


@pytest.mark.parametrize(("said", "found"), STATES)
def test_a_header_that_says_more_than_the_check_finds_is_told(said: str, found: PlanState) -> None:
    told = list(wrong_state(["NEST a.json", said], found))
    assert len(told) == bool(STATES[said, found])
    assert all(STATES[said, found] in text for text in told)


def test_the_check_tells_a_program_that_says_it_is_kept_and_is_not(tmp_path: Path) -> None:
    nest, program = tmp_path / "rich.json", tmp_path / "rich.nc"
    nest.write_bytes(seeds.nest_bytes("rich"))
    text = seeds.made("rich")[0].decode()
    program.write_text(text)
    assert "(STATE KEPT)" in text
    assert "says of itself" not in kerfwise("check", nest, program).out
    program.write_text(text.replace("(STATE KEPT)", "(STATE KEPT)\n(EXCUSED part-rigidity D.outer)"))
    assert "says of itself" not in kerfwise("check", nest, program).out
    program.write_text(text.replace("F2500", "F1500", 1))
    ended = kerfwise("check", nest, program)
    assert ended.code == 1
    assert "warning: the program says of itself that it is kept, and the check finds: FAILED" in ended.out
