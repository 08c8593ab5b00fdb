"""The work sheets of a batch: what is printed, kept, made again and removed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kerfwise.apps.batch import reports
from kerfwise.apps.batch.run import Batch, Beside, plan_task, run_batch
from kerfwise.apps.batch.store import Store
from kerfwise.apps.batch.tasks import Machines, Options, machine_of, sources_in
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.files import read_limited
from kerfwise.jobs.process_pool import run_in_process
from kerfwise.tests.apps.batch.nests import write_nests
from kerfwise.tests.paper import pages_of

pytestmark = pytest.mark.slow


class Folder:
    """Runs batches of a folder `in` into a folder `out`."""

    def __init__(self, place: Path) -> None:
        self.given, self.out = write_nests(place / "in", ("one", "off the sheet")), place / "out"
        self.out.mkdir()
        self.pdf = self.out / "plasma.pdf"

    def run(self, *, sheets: bool = True, seed: int = 1) -> Batch:
        machines = Machines((machine_of("plasma", "plasma-carbon-steel", False),))
        options = Options(work=0.2, seed=seed)
        found = sources_in([self.given], self.out)
        run = run_in_process(plan_task)
        return run_batch(found, machines, Store(self.out), options, "1", run, beside=Beside(sheets=sheets))

    def index(self) -> str:
        return (self.out / "index.html").read_text(encoding="utf-8")

    def text(self) -> list[str]:
        return [page.text for page in pages_of(self.pdf)]


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


def test_one_pdf_of_what_is_planned_which_the_index_links(folder: Folder) -> None:
    (folder.given / "one.job.yaml").write_text("order: A-77\nquantity: 4\n")
    assert folder.run().papers.files == {"plasma": "plasma.pdf"}
    assert '<a href="plasma.pdf">PDF</a>' in folder.index()
    assert json.loads((folder.out / "index.json").read_text())["machines"][0]["sheets_pdf"] == "plasma.pdf"
    (page,) = folder.text()
    assert "A-77" in page
    assert "4 of the same" in page
    row = json.loads((folder.out / "plasma" / "one.batch.json").read_text())
    assert row["files"]["one.nc"] in "".join(page.split())


def test_it_is_kept_while_the_plans_are_the_same_and_the_same_bytes(
    folder: Folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder.run()
    before = read_limited(folder.pdf)
    folder.pdf.unlink()
    folder.run()
    assert read_limited(folder.pdf) == before
    with monkeypatch.context() as patched:
        patched.setattr(reports, "work_sheet", None)  # whoever would make a sheet now fails
        folder.run()
        assert folder.run(sheets=False).papers.files == {"plasma": "plasma.pdf"}
    assert read_limited(folder.pdf) == before
    folder.pdf.write_bytes(b"not this")
    folder.run()
    assert read_limited(folder.pdf) == before


def test_an_old_one_is_made_again_or_removed(folder: Folder) -> None:
    folder.run()
    write_nests(folder.given, ("two",))
    folder.run()
    assert len(folder.text()) == 2
    (folder.given / "two.json").unlink()
    assert folder.run(sheets=False).papers.files == {}
    assert not list(folder.out.glob("plasma.*"))
    assert "PDF" not in folder.index()


def test_a_nest_without_a_sheet_is_said_and_tried_again(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    write_nests(folder.given, ("two",))
    real = reports.work_sheet

    def refused(given: Any, *more: Any, **named: Any) -> Any:
        if Path(given.nest.file).stem == "two":
            raise RulesConflict("the check refuses the plan")
        return real(given, *more, **named)

    with monkeypatch.context() as patched:
        patched.setattr(reports, "work_sheet", refused)
        assert folder.run().papers.told == ("no work sheet for two on plasma: the check refuses the plan",)
    assert len(folder.text()) == 1
    assert folder.run().papers.told == ()
    assert len(folder.text()) == 2


def test_no_plan_no_paper(folder: Folder) -> None:
    (folder.given / "one.json").unlink()
    assert folder.run().papers.files == {}
    assert not list(folder.out.glob("*.pdf"))
