"""Job files on the command line: found beside the nest, laid over the profile, told, kept, and left out."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kerfwise as package
from kerfwise import read_plan
from kerfwise.tests.commands.run_cli import kerfwise

PLATE = {
    "format": "kerfwise-nest/1",
    "units": "mm",
    "sheet": {"width": 600, "height": 200},
    "parts": [
        {"id": f"P{k}", "outer": [[x, 20], [x + 80, 20], [x + 80, 100], [x, 100]],
         "holes": [[[x + 30, 50], [x + 50, 50], [x + 50, 70], [x + 30, 70]]] if k == 2 else []}
        for k, x in ((1, 20), (2, 220), (3, 420))
    ],
}  # fmt: skip
JOB = """profile: plants/shop.yaml
machine: Shop
quantity: 3
order: 4711
due: 2026-12-24
locks: [P3.outer first, P1 last]
set:
  leads.lead_in: 4 mm
"""
FOUND = (
    "note: the job file plate.job.yaml belongs to the nest and is read (--no-job, in Python job=False, goes without it)"
)


@pytest.fixture(autouse=True)
def plate(in_an_empty_folder: Path) -> Path:
    """A nest, its job file, and the plant's profile that this names."""
    Path("plate.json").write_text(json.dumps(PLATE))
    Path("plate.job.yaml").write_text(JOB)
    Path("plants").mkdir()
    Path("plants/shop.yaml").write_text("name: shop\nrules: {level-ahead: off, zone-order: off, start-side: off}\n")
    return in_an_empty_folder


def order(file: str = "plate.plan.json") -> list[str]:
    return [planned.cut.contour for planned in read_plan(file).cuts]


def test_the_job_beside_the_nest_is_found_told_and_kept() -> None:
    made = kerfwise("solve", "plate.json", "--work", 1)
    assert (made.code, made.err.splitlines()) == (0, [FOUND])
    plan = read_plan("plate.plan.json")
    assert (plan.profile["name"], order()[0], order()[-1]) == ("shop", "P3.outer", "P1.outer")
    assert plan.made_with is not None
    assert (plan.made_with.file, len(plan.made_with.sha256)) == ("plate.job.yaml", 64)
    assert all(planned.cut.lead_in is None or planned.cut.lead_in.length_mm < 4.01 for planned in plan.cuts)
    assert f"(JOB plate.job.yaml SHA256 {plan.made_with.sha256[:12]})" in Path("plate.nc").read_text().splitlines()
    for verb in (("check",), ("time",), ("explain",), ("plot", "-o", "p.svg")):
        ended = kerfwise(
            verb[0], "plate.json", "plate.plan.json", *(["P2.outer"] if verb[0] == "explain" else verb[1:])
        )
        assert (ended.code, ended.err.splitlines()) == (0, [FOUND]), verb


def test_another_job_is_noticed_and_none_too() -> None:
    kerfwise("solve", "plate.json", "--work", 1)
    none = kerfwise("check", "plate.json", "plate.plan.json", "--no-job", "-p", "plants/shop.yaml")
    assert none.err == "note: the plan was made with the job file plate.job.yaml, which is not given here\n"
    Path("plate.job.yaml").write_text(JOB.replace("P3.outer first", "P2.hole1 first"))
    other = kerfwise("check", "plate.json", "plate.plan.json")
    assert other.code == 1
    assert "note: the job file is not the one the plan was made with (its sha256 differs)" in other.err.splitlines()
    assert "P2.hole1 is cut 2 in order, not first: locked by the operator (plate.job.yaml:6:9)" in other.out


def test_a_profile_that_is_given_goes_before_that_of_the_job() -> None:
    Path("other.yaml").write_text("name: other\nbased_on: plants/shop.yaml\n")
    made = kerfwise("solve", "plate.json", "--work", 1, "-p", "other.yaml")
    assert made.err.splitlines() == [
        FOUND,
        "note: plate.job.yaml names the profile plants/shop.yaml: the one that is given, other, goes before it",
        "note: plate.job.yaml is for the machine Shop, and the profile is other",
    ]
    assert (read_plan("plate.plan.json").profile["name"], order()[0]) == ("other", "P3.outer")


def test_the_command_line_says_the_same_and_goes_before_all() -> None:
    asked = ("--lock", "P2 before P3", "--set", "leads.lead_in=3mm", "--set", "machine.cut_feed=2000")
    made = kerfwise("solve", "plate.json", "--work", 1, *asked)
    assert made.code == 0
    assert made.err.splitlines()[1:] == [
        "note: the lock 'P3.outer first' (plate.job.yaml:6:9) gives way to the lock 'P2 before P3' (locked by the "
        "operator (--lock 'P2 before P3'))"
    ]
    plan = read_plan("plate.plan.json")
    assert plan.made_with is not None
    assert plan.made_with.settings == ("leads.lead_in=3mm", "machine.cut_feed=2000")
    assert plan.made_with.locks == ("P2 before P3",)
    assert order() == ["P2.hole1", "P2.outer", "P3.outer", "P1.outer"]
    assert kerfwise("check", "plate.json", "plate.plan.json", *asked).code == 0
    bare = kerfwise("check", "plate.json", "plate.plan.json")
    assert "note: the plan was made with --lock P2 before P3, which is not given here" in bare.err.splitlines()


def test_a_number_is_a_cut_of_the_last_plan_and_stays_it() -> None:
    Path("plate.job.yaml").write_text(JOB.replace("P3.outer first, P1 last", '"#2 last"'))
    none = kerfwise("solve", "plate.json", "--work", 1)
    assert none.code == 2
    assert none.err.splitlines()[-1].startswith(
        "kerfwise: plate.job.yaml:6:9: lock '#2 last': #N is cut N of the last plan, and there is none beside the nest"
    )
    bare = kerfwise("solve", "plate.json", "--work", 1, "--no-job", "-p", "plants/shop.yaml", "--lock", "P3 2nd")
    assert (bare.code, order()[1]) == (0, "P3.outer")
    plans = []
    for _ in range(2):  # the plan has another second cut now, and the same is meant
        made = kerfwise("solve", "plate.json", "--work", 1)
        assert "note: #2 is P3.outer, as in plate.plan.json" in made.err.splitlines()
        assert order()[-1] == "P3.outer"
        plans.append(Path("plate.plan.json").read_text().split('"solve"')[0])
    assert plans[0] == plans[1]
    assert kerfwise("check", "plate.json", "plate.plan.json").code == 0


WRONG = {
    "quantity: 0": "plate.job.yaml:1:11: job file.quantity: expected a whole number from 1",
    "due: never": "plate.job.yaml:1:6: job file.due: expected a day such as 2026-12-24",
    "profil: shop": "plate.job.yaml:1:1: job file: unknown key 'profil': did you mean 'profile'?",
    "locks: [P9 first]": "plate.job.yaml:1:9: lock 'P9 first': unknown contour or part 'P9'",
    "profile: plants/shop": "plate.job.yaml:1:1: profile: plants/shop: cannot read the profile",
    "profile: laser-wod": "plate.job.yaml:1:1: profile: unknown profile 'laser-wod': did you mean 'laser-wood'?",
    "set: {leads.led_in: 3}": "plate.job.yaml:1:7: leads: unknown key 'led_in': did you mean 'lead_in'?",
    "set: {leads.lead_in: 3 kg}": "plate.job.yaml:1:22: leads.lead_in: unknown unit 'kg'",
    "set: {locks: []}": "plate.job.yaml:1:7: set: there is no key 'locks' here, it belongs under locks",
    "set: {leads.lead_in: 3, leads: {lead_in: 4}}": "plate.job.yaml:1:33: set: leads.lead_in is set twice",
}


@pytest.mark.parametrize("text", WRONG)
def test_a_wrong_job_file_is_answered_in_its_place_and_nothing_is_written(text: str) -> None:
    Path("plate.job.yaml").write_text(text)
    for asked in (("solve", "plate.json"), ("job", "check", "plate.job.yaml")):
        ended = kerfwise(*asked)
        assert ended.code == 2
        assert ended.err.splitlines()[-1].startswith(f"kerfwise: {WRONG[text]}"), ended.err
    assert not Path("plate.nc").exists()


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (
            ("--set", "leads.lead_in"),
            "--set (in Python: settings) 'leads.lead_in': expected KEY=VALUE, such as leads.lead_in=4mm",
        ),
        (
            ("--set", "leads.led_in=4mm"),
            "--set (in Python: settings): leads: unknown key 'led_in': did you mean 'lead_in'?",
        ),
        (("--set", "lead.lead_in=4mm"), "--set (in Python: settings): unknown key 'lead': did you mean 'leads'?"),
        (("--set", "leads.lead_in=[4"), "--set (in Python: settings) 'leads.lead_in=[4': not YAML"),
        (("--lock", "P2 frist"), "--lock 'P2 frist': 'frist': did you mean 'first'?"),
        (("--lock", "P7 first"), "plate.json: lock 'P7 first': unknown contour or part 'P7'"),
        (("--job", "none.job.yaml"), "none.job.yaml: cannot read the job file: No such file or directory"),
        (("-o", "plate.job.yaml"), "plate.job.yaml: would be written over, and is read from"),
        (("--no-job", "-o", "plate.job.yaml"), "plate.job.yaml: would be written over, and is read from"),
        (("-p", "plants/shop.yaml", "-o", "plants/shop.yaml"), "plants/shop.yaml: would be written over, and is read"),
        (("-o", "other.job.yaml"), "other.job.yaml: this is the name of a job file, which is read with its nest"),
        (("--plan", "PLATE.job.yml"), "PLATE.job.yml: this is the name of a job file, which is read with its nest"),
    ],
)
def test_what_is_wrong_on_the_command_line(asked: tuple[str, ...], message: str) -> None:
    ended = kerfwise("solve", "plate.json", *asked)
    assert ended.code == 2
    assert ended.err.splitlines()[-1].startswith(f"kerfwise: {message}"), ended.err
    assert Path("plate.job.yaml").read_text() == JOB
    both = kerfwise("solve", "plate.json", "--job", "plate.job.yaml", "--no-job")
    assert (both.code, "give one of them" in both.err) == (2, True)


def test_a_tab_that_no_rule_would_make_is_refused_before_the_work() -> None:
    Path("plate.job.yaml").write_text("tabs: {P1: [60, 20]}\n")
    ended = kerfwise("solve", "plate.json", "--work", 1)
    assert ended.code == 2
    told = "P1.outer is locked to have a tab, and rule hold-small-parts, which makes tabs, is off"
    assert ended.err.splitlines()[-1] == f"kerfwise: plate.job.yaml: {told}"


def test_a_file_that_is_nearly_called_so_is_told() -> None:
    Path("plate.job.yaml").rename("plate.json.job.yaml")
    told = "note: plate.json.job.yaml is not read: the job file of plate.json is called plate.job.yaml"
    assert kerfwise("facts", "plate.json", "-o", "f.json").err.splitlines()[0] == told


def test_what_all_sheets_take_is_told() -> None:
    made = kerfwise("solve", "plate.json", "--work", 1, "--set", "prices.machine_hour=60")
    time_s = read_plan("plate.plan.json").totals.time_s
    minutes, seconds = divmod(round(3 * time_s), 60)
    money = f"{3 * read_plan('plate.plan.json').cost.total:.2f} EUR"  # type: ignore[union-attr]
    told = f"order 4711, due 2026-12-24: 3 sheets, {minutes} min {seconds:02d} s, {money}"
    assert told in made.out.splitlines()


def test_locks_of_a_profile_are_read_with_a_note() -> None:
    Path("plants/shop.yaml").write_text("name: shop\nlocks:\n  - {contour: P2.outer, position: last}\n")
    told = "note: plants/shop.yaml:3:5: the profile has locks; they belong to one nest: write them in its job file"
    made = kerfwise("facts", "plate.json", "-o", "f.json", "--no-job", "-p", "plants/shop.yaml")
    assert (made.code, made.err.startswith(told)) == (0, True)
    assert kerfwise("profile", "check", "plants/shop.yaml").err.startswith(told)


def test_show_says_where_each_value_is_from() -> None:
    shown = kerfwise("profile", "show", "--job", "plate.job.yaml", "--sources", "--set", "machine.travel=9 m/min",
                     "--lock", "P2 cw")  # fmt: skip
    assert shown.code == 0
    said = [line.split("#", 1) for line in shown.out.splitlines() if "#" in line]
    where = {line[0].strip().rstrip(":"): line[1].split("; ")[-1].strip() for line in said}
    assert where["lead_in: 4 mm"] == "plate.job.yaml:8"
    assert where["travel: 9000 mm/min"] == "--set"
    assert where["lead: line"] == "default"
    assert where["- {contour: P3.outer, position: first}"] == "plate.job.yaml:6:9"
    assert where["- {contour: P2, direction: cw}"] == "--lock"
    assert kerfwise("profile", "show").code == 2


def test_check_and_schema_of_job_files() -> None:
    fine = kerfwise("job", "check", "plate.job.yaml")
    assert fine.out == (
        "plate.job.yaml: fine, profile shop, 3 sheets, order 4711, due 2026-12-24, 2 locks, 1 value of its own\n"
    )
    Path("plate.json").rename("sheet.json")
    alone = kerfwise("job", "check", "plate.job.yaml")
    assert (alone.code, "there is no nest beside the job file" in alone.err) == (0, True)
    assert kerfwise("job", "check", "plate.job.yaml", "sheet.json").err == ""
    assert json.loads(kerfwise("job", "schema").out)["title"] == "kerfwise job"


def test_check_says_what_prices_lack() -> None:
    with Path("plate.job.yaml").open("a") as job:
        job.write("  prices.torch_kw: 40\n")
    said = kerfwise("job", "check", "plate.job.yaml")
    assert said.code == 0
    assert "note: prices" in said.err


def test_python_reads_the_same_job() -> None:
    result = package.solve("plate.json", work=1)
    assert result.plan.made_with == read_made_with()
    assert result.notes[0].startswith("the job file plate.job.yaml belongs to the nest")
    assert package.check("plate.json", result).ok
    bare = package.solve("plate.json", "plants/shop.yaml", job=False, work=1)
    assert bare.plan.made_with is None
    job = package.read_job("plate.job.yaml")
    assert (job.quantity, job.order) == (3, "4711")
    nest = package.read_nest("plate.json")
    same = package.solve(nest, job=job, work=1)
    assert same.plan.cuts[0].cut.contour == "P3.outer"
    own = package.solve(nest, job=job, locks="P2 before P3", settings={"leads.lead_in": 3}, work=1)
    assert [p.cut.contour for p in own.plan.cuts] == ["P2.hole1", "P2.outer", "P3.outer", "P1.outer"]
    assert package.check(nest, own, own.profile).ok


def read_made_with() -> object:
    kerfwise("solve", "plate.json", "--work", 1)
    return read_plan("plate.plan.json").made_with
