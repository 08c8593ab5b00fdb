"""Old programs in a better order: as good as a proven plan, never longer than before, every burn as it was."""

import dataclasses
import random
from pathlib import Path

import numpy as np
import pytest

from kerfwise.apps.resequence.resequence import resequence
from kerfwise.apps.resequence.result import Resequenced
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import read_named
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.by_engine import Method
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.programs import ProgramRequest, read_old_job
from kerfwise.jobs.request import options_for
from kerfwise.models.engines import Strategy
from kerfwise.pipeline import plan_nest
from kerfwise.postproc.check.reader.controls import CONTROLS
from kerfwise.postproc.check.reader.read_program import read_old
from kerfwise.postproc.dialects import load_dialect
from kerfwise.postproc.old.program_pieces import reordered, split_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import Links
from kerfwise.tests.apps.resequence.test_resequence_verb import archive
from kerfwise.tests.commands.run_cli import kerfwise
from kerfwise.tests.postproc.dialects.reading import with_dialect
from kerfwise.tests.postproc.old.programs import READ, line, square
from kerfwise.tests.tools import canon
from kerfwise.tests.tools.amount import few

PLAIN = load_profile()


def plates() -> Nest:
    """Six plates in two rows, a hole in each, one with a plate in its window."""
    row = [part(f"A{k}", rect(40 + 130 * k, 30, 100, 80), [circle(90 + 130 * k, 70, 15)]) for k in range(3)]
    more = [part(f"B{k}", rect(40 + 130 * k, 150, 100, 90), [rect(60 + 130 * k, 170, 60, 50)]) for k in range(3)]
    return nest(500, 280, *row, *more, part("C", rect(75, 182, 30, 26)))


def solved(drawn: Nest, profile: Profile = PLAIN, strategy: Strategy = "ours") -> tuple[str, float]:
    """The program of a plan, and its idle travel."""
    limits = options_for(drawn, profile, work=5)
    made = plan_nest(Inputs(profile.as_cut(drawn), profile), limits, Method(strategy=strategy)).made
    return made.program, made.plan.totals.idle_mm


def mixed(text: str, control: str, seed: int = 3) -> str:
    """The same burns in any order, without comments."""
    apart = split_program(read_old(text, CONTROLS[control]))
    order = list(range(len(apart.pieces)))
    random.Random(seed).shuffle(order)
    return reordered(apart, order)


def again(text: str, folder: Path, profile: Profile = PLAIN, **options: object) -> Resequenced:
    file = folder / "old.nc"
    file.write_text(text)
    return resequence(file, profile, **{"work": 5, **options})  # type: ignore[arg-type]


@pytest.mark.scrap("ESSI moves in steps of 0.1 mm, which the simulation of the metal does not know")
@pytest.mark.parametrize("dialect", ["linuxcnc-qtplasmac", "eia", "burny", "grbl", "essi"])
def test_burns_that_were_mixed_get_the_travel_of_the_proven_plan(dialect: str, tmp_path: Path) -> None:
    profile = with_dialect(PLAIN, dialect)
    program, idle_mm = solved(plates(), profile)
    asked = ProgramRequest(sheet_mm=(500, 280))
    made = again(mixed(program, load_dialect(dialect).control), tmp_path, profile, request=asked)
    assert made.before.idle_mm > 1.5 * idle_mm
    assert made.proven
    assert made.after.idle_mm <= idle_mm + (2.0 if dialect == "essi" else 0.01)  # in steps, 26 ends of travel
    assert made.after.verdict is not None
    assert made.after.verdict.ok
    stays = again(program, tmp_path, profile, request=asked)
    assert not stays.changed
    assert stays.program == program


@pytest.mark.linuxcnc
def test_linuxcnc_and_the_old_nest_find_every_burn_as_it_was(tmp_path: Path) -> None:
    drawn = plates()
    old = mixed(solved(drawn)[0], "linuxcnc-qtplasmac")
    made = again(old, tmp_path)
    before, after = canon.run(old, 0.001), canon.run(made.program, 0.001)
    assert after.error is None
    left = list(before.burns)
    for burn in after.burns:
        was = next(b for b in left if len(b.points) == len(burn.points) and _off_mm(b, burn) <= 0.001)
        assert (was.tool, was.feeds_mm_min) == (burn.tool, burn.feeds_mm_min)
        left.remove(was)
    assert left == []
    assert after.idle_mm == pytest.approx(made.after.idle_mm, abs=0.01)
    assert not check_program(drawn, old, PLAIN).ok
    assert check_program(drawn, made.program, PLAIN).ok


def _off_mm(one: canon.Burn, other: canon.Burn) -> float:
    return float(np.abs(np.array(one.points) - np.array(other.points)).max())


def test_names_zones_and_excuses_of_our_own_programs_are_kept(tmp_path: Path) -> None:
    file = tmp_path / "own.nc"
    file.write_text(solved(plates())[0])
    job = read_old_job(file, PLAIN)
    assert job.told is not None
    assert set(job.told.nest.index) == set(plates().index)


def test_contours_planned_afresh_have_about_the_travel_of_the_proven_plan(tmp_path: Path) -> None:
    plain, plain_mm = solved(plates(), strategy="random")
    idle_mm = solved(plates())[1]
    made = again(plain, tmp_path, paths="new", request=ProgramRequest(sheet_mm=(500, 280)))
    assert made.proven
    assert made.after.verdict is not None
    assert made.after.verdict.ok
    assert made.after.idle_mm < plain_mm
    assert made.after.idle_mm == pytest.approx(idle_mm, rel=0.03)


@pytest.mark.parametrize("name", few(READ, 9))
def test_no_program_gets_longer(name: str, tmp_path: Path) -> None:
    made = again(READ[name], tmp_path, request=ProgramRequest(feed_mm_min=2500), without_rules=True)
    assert made.after.idle_mm <= made.before.idle_mm or "longer since the old order breaks" in made.ends
    assert (made.after.idle_mm > made.before.idle_mm) == (name in ("squares", "travel by lines"))
    assert made.after.cut_mm == pytest.approx(made.before.cut_mm)
    assert made.after.pierces == made.before.pierces
    if not made.changed:
        assert made.program == READ[name]


def test_squares_are_put_in_a_row(tmp_path: Path) -> None:
    made = again(READ["squares"], tmp_path)
    assert made.changed
    assert [burn.path.vertices[0, 0] for burn in made.after.burns] in ([15, 115, 215], [215, 115, 15])


def test_an_order_that_breaks_rules_may_get_longer_and_that_is_said(tmp_path: Path) -> None:
    outer_first = READ["squares with holes"].split("G0 ")
    swapped = "G0 ".join([outer_first[0], *outer_first[2:0:-1], *outer_first[3:]])
    made = again(swapped, tmp_path)
    assert made.before.verdict is not None
    assert "inner-before-outer" in made.before.verdict.broken()
    assert made.after.verdict is not None
    assert "inner-before-outer" not in made.after.verdict.broken()
    assert "inner-before-outer" in str(made)


TOLD = {
    "squares", "squares with holes", "slow holes", "travel by lines", "travel by lines at a feed of their own",
    "parameters", "repeats", "from place to place", "only from place to place", "heights, probing and waits",
    "the same height in each travel",
    "a height before the travel", "kerf by the control", "unknown words at the top", "line ends of Windows",
}  # fmt: skip
"""Those of which a nest can be told."""


@pytest.mark.parametrize("name", READ)
def test_without_a_nest_nothing_is_done_unless_it_is_asked_for(name: str, tmp_path: Path) -> None:
    if name in TOLD:
        assert again(READ[name], tmp_path, request=ProgramRequest(feed_mm_min=2500)).nest is not None
        return
    with pytest.raises(InputError, match="take --without-rules") as caught:
        again(READ[name], tmp_path, request=ProgramRequest(feed_mm_min=2500))
    assert caught.value.line is not None
    made = again(READ[name], tmp_path, request=ProgramRequest(feed_mm_min=2500), without_rules=True)
    assert not made.proven or made.ends.endswith("no rule was asked")


def test_without_rules_what_can_be_told_still_breaks_no_hard_rule_oftener(tmp_path: Path) -> None:
    made = again(READ["squares"], tmp_path)
    assert "longer since the old order breaks level-ahead" in made.ends
    open_too = line(300, 20, 340, 20)
    by_rules = made.program.replace("G0 X0 Y0\n", f"{open_too}G0 X0 Y0\n")
    kept = again(by_rules, tmp_path, without_rules=True)
    assert not kept.changed
    assert "as far as can be told, another would break level-ahead" in kept.ends
    breaks_it = READ["squares"].replace("G0 X0 Y0\n", f"{open_too}G0 X0 Y0\n")
    assert again(breaks_it, tmp_path, without_rules=True).after.idle_mm < made.before.idle_mm + 200


def test_materials_keep_their_turn(tmp_path: Path) -> None:
    made = again(READ["materials"], tmp_path, request=ProgramRequest(feed_mm_min=2500), without_rules=True)
    assert not made.changed
    rows = [(20, "M190 P1"), (220, "M190 P1"), (120, "M190 P1"), (80, "M190 P2"), (20, "M190 P2")]
    squares = "".join(f"{m}\nM66 P3 L3 Q1\n{square(x, 80 if m[-1] == '2' else 20, 40)}" for x, m in rows)
    head, _, _ = READ["squares"].partition("G0 ")
    made = again(f"{head}{squares}G0 X0 Y0\nM2\n", tmp_path)
    assert made.before.verdict is not None
    assert "level-ahead" in made.before.verdict.broken()
    assert made.after.verdict is not None
    assert "level-ahead" not in made.after.verdict.broken()
    assert [burn.path.vertices[0, 1] for burn in made.after.burns] == [20, 20, 20, 80, 80]


def test_a_burn_round_several_contours_is_moved_as_one_and_keeps_the_rules(tmp_path: Path) -> None:
    chain = (
        "G0 X360 Y20\nM3 $0 S1\nG1 X400\nG1 Y60\nG1 X360\nG1 Y20\nG1 X350\nG1 X310\nG1 Y60\nG1 X350\nG1 Y20\nM5 $0\n"
    )
    head, _, rest = READ["squares"].partition("G0 ")
    made = again(f"{head}{chain}G0 {rest}", tmp_path)
    assert made.nest is not None
    assert len(made.nest.parts) == 5
    assert made.plan is not None
    assert [planned.cut.linked for planned in made.plan.cuts].count(True) == 1
    assert made.after.idle_mm < made.before.idle_mm
    assert made.proven


def test_a_lead_through_another_part_leaves_the_old_order(tmp_path: Path) -> None:
    text = READ["squares with holes"]
    through = text.replace("G0 X240 Y40\nM3 $0 S1\n", "M3 $0 S1\n", 1)  # from the square before, with the torch on
    assert through != text
    made = again(through, tmp_path)
    assert not made.changed
    assert "no order of these burns keeps the hard rules" in made.ends


def test_leads_of_several_pieces_stay_as_they_are(tmp_path: Path) -> None:
    bent = READ["squares"].replace("G1 X120 Y20\n", "G1 X116 Y24\nG1 X117 Y22\nG1 X120 Y20\n", 1)
    made = again(bent, tmp_path)
    assert made.nest is not None
    assert made.after.cut_mm == pytest.approx(made.before.cut_mm)
    burn = next(b for b in made.after.burns if b.path.vertices[0, 0] == 115)
    assert burn.path.vertices[:4, :2].tolist() == [[115, 20], [116, 24], [117, 22], [120, 20]]


def test_links_and_small_holes_of_the_profile_change_no_burn(tmp_path: Path) -> None:
    links = dataclasses.replace(PLAIN.cuts, links=Links(80.0), narrow="slit")
    holes = dataclasses.replace(PLAIN.small_holes, under="skip", min_hole=40.0)
    made = again(READ["squares with holes"], tmp_path, dataclasses.replace(PLAIN, cuts=links, small_holes=holes))
    assert made.nest is not None
    assert len(made.after.burns) == len(made.before.burns) == 6


def test_the_same_input_gives_the_same_bytes(tmp_path: Path) -> None:
    text = mixed(solved(plates())[0], "linuxcnc-qtplasmac")
    assert again(text, tmp_path).program == again(text, tmp_path).program


def test_the_kerf_of_the_program_counts_and_one_that_is_given_counts_more(tmp_path: Path) -> None:
    file = tmp_path / "old.nc"
    head, _, rest = READ["squares"].partition("F2500\n")
    file.write_text(f"{head}(o=0, kw=1.1, fr=2500)\nF#<_hal[plasmac.cut-feed-rate]>\n{rest}")
    assert read_old_job(file, PLAIN, afresh=True).profile.material.kerf_mm == 1.1
    assert read_old_job(file, PLAIN, ProgramRequest(kerf_mm=0.9), afresh=True).profile.material.kerf_mm == 0.9
    other = dataclasses.replace(PLAIN, material=dataclasses.replace(PLAIN.material, kerf_mm=2.0))
    file.write_text(READ["squares"])
    assert read_old_job(file, other, afresh=True).profile.material.kerf_mm == 2.0


@pytest.mark.slow
def test_what_is_finished_is_not_planned_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from kerfwise.apps.resequence import archive as job

    archive(tmp_path)
    monkeypatch.chdir(tmp_path)
    planned: list[str] = []
    real = job.resequence

    def noted(path: Path, *args: object, **options: object) -> object:
        planned.append(path.name)
        return real(path, *args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(job, "resequence", noted)
    first = kerfwise("resequence", "old", "-o", "new", "--without-rules", "--work", 1)
    assert sorted(planned) == ["loop.ngc", "rows.nc", "slow holes.nc", "squares.nc"]
    planned.clear()
    again = kerfwise("resequence", "old", "-o", "new", "--without-rules", "--work", 1)
    assert planned == ["loop.ngc"]  # what was refused may be mended
    assert again.out == first.out.rstrip("\n") + ", 3 finished before\n"
    planned.clear()
    Path("new/rows.nc").write_text("spoilt")
    Path("old/squares.nc").write_text(READ["squares"].replace("X215", "X214"))
    kerfwise("resequence", "old", "-o", "new", "--without-rules", "--work", 1)
    assert sorted(planned) == ["loop.ngc", "rows.nc", "squares.nc"]
    planned.clear()
    kerfwise("resequence", "old", "-o", "new", "--without-rules", "--work", 1, "--kerf", 1)
    assert len(planned) == 4
    Path("new/resequence.json").write_text("[")
    planned.clear()
    kerfwise("resequence", "old", "-o", "new", "--without-rules", "--work", 1, "--kerf", 1)
    assert len(planned) == 4


def test_a_fault_stops_no_other_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from kerfwise.apps.resequence import archive as job

    archive(tmp_path)
    monkeypatch.chdir(tmp_path)
    real = job.resequence

    def fails(path: Path, *args: object, **options: object) -> object:
        if path.name == "rows.nc":
            raise ZeroDivisionError("by nothing")
        return real(path, *args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(job, "resequence", fails)
    ended = kerfwise("resequence", "old", "-o", "new", "--without-rules", "--work", 1)
    assert ended.code == 70
    assert "a fault of kerfwise itself: ZeroDivisionError: by nothing" in ended.out
    (told,) = [row for row in ended.err.splitlines() if "please send" in row]
    assert told.startswith("rows.nc: a fault of kerfwise itself: ZeroDivisionError: by nothing; please send ")
    report = Path(told.partition("please send ")[2].partition(" to whoever")[0]).read_text()
    assert "raise ZeroDivisionError" in report
    assert "2 of 4 programs read" in ended.out


def test_a_file_that_is_too_large_stops_no_other_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    archive(tmp_path)
    monkeypatch.chdir(tmp_path)
    Path("old/rows.nc").write_text("(-)\n" * 10_000)
    monkeypatch.setattr(read_named, "__defaults__", (30_000,))
    ended = kerfwise("resequence", "old", "-o", "new", "--without-rules", "--work", 1)
    assert ended.code == 2
    assert "refused: old/rows.nc: holds over" in ended.out
    assert "2 of 4 programs read" in ended.out
