"""The folder of a batch: one run at a time, files of one generation, nothing of anybody else's."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kerfwise import InputError
from kerfwise.apps.batch.result import Figures, Row, row_of
from kerfwise.apps.batch.store import LOCK, Store, lock_folder
from kerfwise.tests.apps.batch.nests import write_nests
from kerfwise.tests.commands.run_cli import kerfwise

FIGURES = Figures(2, 2, 400.0, 80.0, 12.5, 0.01, ("rule: why",), 1.25, "EUR")
ROW = Row("more/a", "a.json", "plasma", "planned", figures=FIGURES, notes=("warning: x",), thumbnail="<svg/>", key="k")
FILES = {"a.nc": "G21\n", "a.plan.json": "{}", "a.svg": b"<svg/>"}


def test_a_record_is_read_back_as_it_was() -> None:
    assert row_of(json.loads(ROW.as_json())) == ROW
    refused = Row("a", "a.json", "plasma", "no plan", "why", relax=True)
    assert row_of(json.loads(refused.as_json())) == refused


@pytest.mark.parametrize(
    "wrong", ["", "[]", "null", '{"format": "kerfwise-batch/1"}', ROW.as_json().replace('"planned"', '"x"')]
)
def test_what_is_no_record_counts_for_nothing(wrong: str, tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.keep(ROW, FILES)
    (tmp_path / "plasma" / "more" / "a.batch.json").write_text(wrong)
    assert Store(tmp_path).finished("plasma", "more/a", "k") is None


def test_finished_is_what_has_its_key_and_its_files(tmp_path: Path) -> None:
    kept = Store(tmp_path).keep(ROW, FILES)
    store = Store(tmp_path)
    assert store.finished("plasma", "more/a", "k") == kept
    assert store.finished("plasma", "more/a", "other") is None
    assert store.finished("laser", "more/a", "k") is None
    (tmp_path / "plasma" / "more" / "a.nc").write_text("M30\n")
    assert store.finished("plasma", "more/a", "k") is None


def test_a_fault_is_never_finished(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.keep(Row("a", "a.json", "plasma", "fault", "memory", key="k"), {})
    assert store.finished("plasma", "a", "k") is None


def test_a_program_of_an_older_nest_does_not_stay_beside_a_refusal(tmp_path: Path) -> None:
    Store(tmp_path).keep(ROW, FILES)
    Store(tmp_path).keep(Row("more/a", "a.json", "plasma", "refused", "open", key="k2"), {})
    assert sorted(path.name for path in (tmp_path / "plasma" / "more").iterdir()) == ["a.batch.json", "a.plan.json"]


def test_a_record_names_no_file_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("x")
    Store(tmp_path).keep(ROW, FILES)
    record = tmp_path / "plasma" / "more" / "a.batch.json"
    record.write_text(record.read_text().replace('"a.svg"', '"../../mine"'))
    Store(tmp_path).keep(Row("more/a", "a.json", "plasma", "refused", key="k2"), {})
    assert (tmp_path / "mine").exists()


def test_a_second_run_is_refused_until_the_first_has_ended(tmp_path: Path) -> None:
    out = tmp_path / "new" / "out"
    with lock_folder(out):
        with pytest.raises(InputError, match="another batch is writing there"), lock_folder(out):
            pass
        (out / "index.html").write_text("x")
    with lock_folder(out):
        pass


def test_a_folder_of_other_things_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("x")
    with pytest.raises(InputError, match="no batch wrote"), lock_folder(tmp_path):
        pass
    with pytest.raises(InputError, match="this is a file"), lock_folder(tmp_path / "thesis.tex"):
        pass
    assert not (tmp_path / LOCK).exists()


def test_two_at_once_into_one_folder() -> None:
    write_nests(Path("in"), ("one",))
    with lock_folder(Path("out")):
        ended = kerfwise("batch", "in", "-o", "out")
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith("kerfwise: out: another batch is writing there")
