"""Programs that earlier runs wrote, of nests that are not given any more: said, and removed only where one asks."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

import pytest

from kerfwise.apps.batch.result import Figures, Row
from kerfwise.apps.batch.run import Batch, Beside, run_batch
from kerfwise.apps.batch.store import Store
from kerfwise.apps.batch.tasks import Machines, Options, machine_of, sources_in
from kerfwise.apps.batch.verbs import printed
from kerfwise.tests.apps.batch.nests import write_nests

FIGURES = Figures(1, 1, 100.0, 10.0, 5.0, None)


class Folder:
    """A batch of the nest `one` on plasma, in a folder that holds what earlier runs wrote; nothing is planned."""

    def __init__(self, place: Path) -> None:
        self.out, self.given = place / "out", write_nests(place / "in", ("one",))
        store = Store(self.out)
        for machine, nest in (("plasma", "one"), ("plasma", "more/gone"), ("laser", "one")):
            stem = Path(nest).name
            row = Row(nest, str(self.given / f"{nest}.json"), machine, "planned", figures=FIGURES)
            store.keep(row, {f"{stem}.nc": "G21\n", f"{stem}.plan.json": "{}", f"{stem}.svg": "<svg/>"})

    def run(self, *, tidied: bool = False) -> Batch:
        def nothing(tasks: Iterable[object], began: object) -> Iterable[object]:
            return ()

        machines = Machines((machine_of("plasma", "plasma-carbon-steel", False),))
        found = sources_in([self.given], self.out)
        return run_batch(found, machines, Store(self.out), Options(), "1", nothing, beside=Beside(tidy=tidied))  # type: ignore[arg-type]

    def files(self) -> set[str]:
        return {str(path.relative_to(self.out).as_posix()) for path in self.out.rglob("*.*") if path.parent != self.out}


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


def test_what_is_left_is_said_and_not_touched(folder: Folder) -> None:
    before = folder.files()
    batch = folder.run()
    assert [(one.program, one.why) for one in batch.left] == [
        ("laser/one.nc", "it is not planned on this machine here"),
        ("plasma/more/gone.nc", "its drawing is gone"),
    ]
    assert folder.files() == before
    assert "1 program is left from earlier runs" in printed(batch, folder.out)
    page = (folder.out / "index.html").read_text(encoding="utf-8")
    assert '<a href="plasma/more/gone.nc">' in page
    data = json.loads((folder.out / "index.json").read_text(encoding="utf-8"))
    assert [one["program"] for one in data["left"]] == ["laser/one.nc", "plasma/more/gone.nc"]


def test_a_drawing_that_is_there_and_not_given_is_told_apart(folder: Folder) -> None:
    (folder.given / "one.json").rename(folder.given / "two.json")
    write_nests(folder.given, ("more/one",))
    (folder.given / "more" / "one.json").rename(folder.given / "more" / "gone.json")
    folder.given /= "two.json"
    found = {one.program: one.why for one in folder.run().left}
    assert found["plasma/more/gone.nc"] == "its drawing is not among those that are given"
    assert found["plasma/one.nc"] == "its drawing is gone"


def test_tidy_removes_what_is_as_it_was_written(folder: Folder) -> None:
    before = folder.files()
    mine = folder.out / "plasma" / "more" / "note.txt"
    mine.write_text("x")
    (mine.parent / "gone.svg").write_text("changed")
    batch = folder.run(tidied=True)
    assert batch.tidied == 1
    assert "1 program removed" in printed(batch, folder.out)
    assert [one.program for one in batch.left] == ["laser/one.nc"]
    gone = {f"plasma/more/gone{ending}" for ending in (".nc", ".plan.json", ".batch.json")}
    assert before - folder.files() == gone
    assert mine.exists()
    assert folder.run(tidied=True).tidied == 0
