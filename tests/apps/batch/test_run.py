"""A batch in this process: what is planned, skipped, refused, written and shown."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable
from html.parser import HTMLParser
from pathlib import Path

import pytest

from kerfwise.apps.batch import tasks as reading
from kerfwise.apps.batch.result import groups_of
from kerfwise.apps.batch.run import Batch, Beside, Watcher, plan_task, plan_task_inputs, run_batch
from kerfwise.apps.batch.store import Store
from kerfwise.apps.batch.tasks import Machine, Machines, NestTask, Options, machine_of, sources_in
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import read_limited
from kerfwise.jobs.process_pool import run_in_process
from kerfwise.tests.apps.batch.nests import BROKEN, NESTS, plate, write_nests
from kerfwise.tests.commands.run_cli import kerfwise

WORK = 0.2
PRICED = "based_on: plasma-carbon-steel\nname: dear\nprices: {machine_hour: 90, gas_hour: 10, currency: EUR}\n"
CHEAP = "based_on: laser-amg3m-1mm\nname: cheap\nprices: {machine_hour: 60, gas_hour: 5, currency: EUR}\n"


class Noted(Watcher):
    """Notes what was begun."""

    def __init__(self) -> None:
        self.names: list[tuple[str, str]] = []

    def began(self, piece: NestTask) -> None:
        self.names.append((piece.name, piece.machine.name))


class Batches:
    """Runs batches of a folder `in` into a folder `out`."""

    def __init__(self, folder: Path) -> None:
        self.given, self.out = folder / "in", folder / "out"
        self.machines = [machine_of("plasma", "plasma-carbon-steel", False)]
        self.begun: list[tuple[str, str]] = []
        self.out.mkdir()

    def run(self, options: Options = Options(work=WORK), **more: object) -> Batch:  # noqa: B008 - frozen
        noted, sources = Noted(), sources_in([self.given], self.out)
        run = more.pop("run", run_in_process(plan_task))
        store = Store(self.out)
        batch = run_batch(sources, Machines(tuple(self.machines)), store, options, "1", run, noted, **more)  # type: ignore[arg-type]
        self.begun = noted.names
        return batch

    def bytes(self) -> dict[str, bytes]:
        return {str(path.relative_to(self.out)): read_limited(path) for path in self.out.rglob("*") if path.is_file()}


@pytest.fixture
def batches(tmp_path: Path) -> Batches:
    return Batches(tmp_path)


@pytest.mark.slow
def test_ten_nests_of_which_two_are_broken(batches: Batches) -> None:
    write_nests(batches.given)
    batch = batches.run()
    assert batch.exit_code == 1
    ended = {row.nest: row.ended for row in batch.rows}
    assert ended == {name: "refused" if name in BROKEN else "planned" for name in NESTS}
    assert len(batches.begun) == len(NESTS)
    programs = {str(path.relative_to(batches.out / "plasma").with_suffix("")) for path in batches.out.rglob("*.nc")}
    assert programs == set(NESTS) - set(BROKEN)
    before = batches.bytes()
    again = batches.run()
    assert (batches.begun, again.again, again.exit_code) == ([], 10, 1)
    assert batches.bytes() == before
    batches.run(beside=Beside(refused_again=True))
    assert sorted(batches.begun) == sorted((name, "plasma") for name in BROKEN)
    assert batches.bytes() == before


def test_the_same_bytes_as_a_single_solve(batches: Batches, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_nests(batches.given, ("three with holes",))
    batches.run()
    monkeypatch.chdir(tmp_path)
    assert kerfwise("solve", batches.given / "three with holes.json", "--work", WORK).code == 0
    for ending in (".nc", ".plan.json", ".svg"):
        name = f"three with holes{ending}"
        assert read_limited(tmp_path / name) == read_limited(batches.out / "plasma" / name)


@pytest.mark.slow
def test_what_has_changed_is_planned_again_and_nothing_else(batches: Batches, tmp_path: Path) -> None:
    write_nests(batches.given, ("one", "two"))
    plant = tmp_path / "plant.yaml"
    plant.write_text("based_on: base.yaml\nname: plant\n")
    (tmp_path / "base.yaml").write_text("based_on: plasma-carbon-steel\nname: base\n")
    batches.machines = [machine_of("plant", str(plant), False)]
    batches.run()
    (batches.given / "one.json").write_text(json.dumps(NESTS["one"] | {"units": "mm"}))
    batches.run()
    assert batches.begun == [("one", "plant")]
    (tmp_path / "base.yaml").write_text("based_on: plasma-carbon-steel\nname: base\nmachine: {cut_feed: 3 m/min}\n")
    batches.machines = [machine_of("plant", str(plant), False)]
    batches.run()
    assert [name for name, _ in batches.begun] == ["one", "two"]
    batches.run(Options(work=WORK, seed=2))
    assert [name for name, _ in batches.begun] == ["one", "two"]
    (batches.out / "plant" / "two.nc").unlink()
    batches.run(Options(work=WORK, seed=2))
    assert [name for name, _ in batches.begun] == ["two"]


@pytest.mark.slow
def test_a_fault_of_one_stops_no_other_and_is_tried_again(batches: Batches, monkeypatch: pytest.MonkeyPatch) -> None:
    write_nests(batches.given, ("one", "two", "three"))
    real = reading.drawn_nest

    def broken(nest: Path, *given: object, **more: object) -> object:
        if nest.stem == "three":
            raise ZeroDivisionError("by nought")
        return real(nest, *given, **more)  # type: ignore[arg-type]

    with monkeypatch.context() as patched:
        patched.setattr(reading, "drawn_nest", broken)
        batch = batches.run()
    assert batch.exit_code == 70
    assert [(name, type(error)) for name, error in batch.faults.items()] == [("three on plasma", ZeroDivisionError)]
    assert [row.ended for row in batch.rows] == ["planned", "fault", "planned"]
    assert batch.rows[1].told == "a fault of kerfwise itself: ZeroDivisionError: by nought"
    assert batches.run().exit_code == 0
    assert batches.begun == [("three", "plasma")]


def test_a_program_that_cannot_be_written_is_no_fault_and_is_made_again(
    batches: Batches, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a full disk."""

    def full(self: Store, row: object, contents: object) -> object:
        raise InputError("cannot write: No space left on device", file="one.nc")

    write_nests(batches.given, ("one",))
    with monkeypatch.context() as patched:
        patched.setattr(Store, "keep", full)
        batch = batches.run()
    assert (batch.exit_code, [row.ended for row in batch.rows], batch.faults) == (1, ["not written"], {})
    (group,) = groups_of(batch.rows)
    assert "Make room in the folder of the programs" in group.remedy
    assert batches.run().exit_code == 0


def test_a_nest_that_changes_while_it_is_planned_is_not_taken(batches: Batches) -> None:
    write_nests(batches.given, ("one",))
    piece = NestTask("one", batches.given / "one.json", batches.machines[0], Options(work=WORK), "1", batches.out)
    made = plan_task_inputs(piece, "another key")
    assert (made.row.ended, made.contents) == ("fault", {})
    assert "its file changed" in made.row.told
    other = Machine("plasma", "plasma-carbon-steel", "another sha256")
    piece = NestTask("one", batches.given / "one.json", other, Options(work=WORK), "1", batches.out)
    assert "the profile plasma-carbon-steel changed" in plan_task_inputs(piece, piece.key()).row.told


@pytest.mark.slow
def test_rules_that_leave_no_plan_say_what_to_do(batches: Batches, tmp_path: Path) -> None:
    write_nests(batches.given, ("two",))
    plant = tmp_path / "plant.yaml"
    lock = "locks:\n  - {contour: P1.outer, position: first}\n  - {contour: P2.outer, position: first}\n"
    plant.write_text(f"based_on: plasma-carbon-steel\nname: plant\n{lock}")
    batches.machines = [machine_of("plant", str(plant), False)]
    batch = batches.run()
    (row,) = batch.rows
    assert (batch.exit_code, row.ended) == (1, "no plan")
    assert "cannot all hold" in row.told
    (group,) = json.loads(read_limited(batches.out / "index.json"))["refused"]
    assert group["what"] == "The rules leave no plan"


@pytest.mark.slow
def test_an_index_that_names_the_better_machine(batches: Batches, tmp_path: Path) -> None:
    write_nests(batches.given, ("one", "off the sheet"))
    (tmp_path / "a.yaml").write_text(PRICED)
    (tmp_path / "b.yaml").write_text(CHEAP)
    batches.machines = [
        machine_of(name, str(tmp_path / file), False) for name, file in (("a", "a.yaml"), ("b", "b.yaml"))
    ]
    batch = batches.run()
    figures = {row.machine: row.figures for row in batch.rows if row.nest == "one"}
    data = json.loads(read_limited(batches.out / "index.json"))
    nest = next(of for of in data["nests"] if of["nest"] == "one")
    for best, amount in (("quickest", "time_s"), ("cheapest", "cost")):
        assert nest[best] == min(figures, key=lambda name: getattr(figures[name], amount))
    assert [(total["planned"], total["refused"]) for total in data["machines"]] == [(1, 1), (1, 1)]
    rows = list(csv.DictReader(io.StringIO(read_limited(batches.out / "index.csv").decode())))
    assert [row["quickest"] == "yes" for row in rows if row["nest"] == "one"] == [
        nest["quickest"] == m for m in ("a", "b")
    ]
    assert all(float(row["time_s"]) > 0 for row in rows if row["nest"] == "one")
    assert len(data["refused"]) == 1, "two machines, one trouble"
    page = read_limited(batches.out / "index.html").decode()
    assert page.count("<svg ") == 2, "the nest that is refused is drawn, too"
    Links(batches.out).feed(page)


class Links(HTMLParser):
    """Every link leads somewhere, and no tag asks for anything from elsewhere."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self.folder = folder

    def handle_starttag(self, tag: str, attrs: Iterable[tuple[str, str | None]]) -> None:
        assert tag not in {"script", "link", "img", "iframe"}
        for name, value in attrs:
            if name == "href" and value and not value.startswith("#"):
                assert (self.folder / value).is_file()


def test_text_from_outside_is_shown_and_not_obeyed(batches: Batches) -> None:
    batches.given.mkdir()
    file = batches.given / "<b>&amp;.json"
    file.write_text(json.dumps(plate(100, {"<i>x": (50, 20, 100, 50)})))
    batches.run()
    page = read_limited(batches.out / "index.html").decode()
    assert "<b>&amp;amp;" not in page.replace("&lt;b&gt;&amp;amp;", "")
    assert "<i>x" not in page


@pytest.mark.slow
def test_a_batch_that_is_interrupted_says_so_and_goes_on(batches: Batches) -> None:
    write_nests(batches.given, ("one", "two", "three"))

    def interrupted(tasks: Iterable[object], began: object) -> Iterable[object]:
        for k, done in enumerate(run_in_process(plan_task)(tasks, began)):  # type: ignore[arg-type]
            if k == 1:
                raise KeyboardInterrupt
            yield done

    batch = batches.run(run=interrupted)
    assert (batch.exit_code, batch.interrupted, len(batch.rows), batch.waiting) == (130, True, 1, 2)
    assert (batches.out / "index.html").exists()
    batch = batches.run()
    assert (batch.exit_code, batch.again, len(batches.begun)) == (0, 1, 2)


JOB = "quantity: 3\norder: 4711\ndue: 2026-12-24\nlocks: ['#2 first']\nset: {machine.cut_feed: 1 m/min}\n"


@pytest.mark.slow
def test_a_job_file_is_kept_and_known(batches: Batches) -> None:
    write_nests(batches.given, ("two",))
    plain = batches.run().rows[0]
    second = json.loads(read_limited(batches.out / "plasma" / "two.plan.json"))["cuts"][1]["contour"]
    job = batches.given / "two.job.yaml"
    job.write_text(JOB)
    batch = batches.run()
    assert batches.begun == [("two", "plasma")]
    (row,) = batch.rows
    assert (row.quantity, row.order, row.due) == (3, "4711", "2026-12-24")
    assert row.figures is not None
    assert plain.figures is not None
    assert row.figures.time_s > plain.figures.time_s, "it is cut more slowly"
    plan = json.loads(read_limited(batches.out / "plasma" / "two.plan.json"))
    assert plan["cuts"][0]["contour"] == second
    (total,) = json.loads(read_limited(batches.out / "index.json"))["machines"]
    assert (total["sheets"], total["time_s"]) == (3, pytest.approx(3 * row.figures.time_s))
    assert "3 sheets, order 4711, due 2026-12-24" in read_limited(batches.out / "index.html").decode()
    batches.run()
    assert batches.begun == []
    job.write_text(JOB.replace("first", "frist"))
    wrong = batches.run()
    assert [(row.ended, "two.job.yaml:4:9" in row.told) for row in wrong.rows] == [("no fit", True)]
    assert not (batches.out / "plasma" / "two.nc").exists()
    job.write_text(JOB)
    assert batches.run().exit_code == 0
    again = json.loads(read_limited(batches.out / "plasma" / "two.plan.json"))
    assert again["cuts"][0]["contour"] == second, "#2 is what it was when the planner looked"


def test_a_nest_is_planned_where_its_job_file_says(batches: Batches, tmp_path: Path) -> None:
    write_nests(batches.given, ("one", "two"))
    plant = tmp_path / "plants" / "the laser.yaml"
    plant.parent.mkdir()
    plant.write_text("based_on: laser-amg3m-1mm\nname: big laser\n")
    batches.machines.append(machine_of("laser", str(plant), False))
    (batches.given / "one.job.yaml").write_text("machine: big Laser\n")
    asked: list[tuple[str, str]] = []

    def noted(tasks: Iterable[object], began: object) -> Iterable[object]:
        asked.extend((task.piece.name, task.piece.machine.name) for task in tasks)  # type: ignore[attr-defined]
        return ()

    batches.run(run=noted)
    assert asked == [("one", "laser"), ("two", "plasma"), ("two", "laser")]
    asked.clear()
    batches.machines = []
    (batches.given / "one.job.yaml").write_text(f"profile: {plant}\n")
    batches.run(run=noted)
    assert asked == [("one", "the-laser"), ("two", "plasma-carbon-steel")]


@pytest.mark.slow
def test_nobody_cuts_on_a_machine_that_the_job_file_means_no_more(batches: Batches) -> None:
    write_nests(batches.given, ("one", "two"))
    batches.machines.append(machine_of("laser", "laser-amg3m-1mm", False))
    batches.run()
    before = batches.bytes()
    job = batches.given / "one.job.yaml"
    job.write_text("machine: laser\n")
    laser, plasma = batches.machines[1], batches.machines[0]
    batches.machines = [laser]
    batches.run()
    assert (batches.out / "plasma" / "one.nc").is_file(), "plasma is no machine of that batch: it is left alone"
    batches.machines = [plasma, laser]
    batches.run()
    gone = {name for name in before if name not in batches.bytes()}
    assert gone == {"plasma/one.nc", "plasma/one.svg", "plasma/one.html"}
    job.unlink()
    batches.run()
    assert batches.bytes() == before


def test_a_profile_of_a_job_file_that_is_not_there(batches: Batches) -> None:
    write_nests(batches.given, ("one",))
    (batches.given / "one.job.yaml").write_text("profile: plants/none.yaml\n")
    batches.machines = []
    (row,) = batches.run().rows
    assert (row.machine, row.ended) == ("none", "no fit")
    assert "plants/none.yaml" in row.told
