"""docs/job-files.md: its example is read, and each lock that it names."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest

import kerfwise
from kerfwise.jobs.nest_job.job import job_of
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.overrides import lines_of, read_lock, with_settings

PAGE = (Path(kerfwise.__file__).parent / "docs" / "job-files.md").read_text(encoding="utf-8")
ROWS = PAGE.partition("| words | what holds |\n|---|---|\n")[2].partition("\n\n")[0].splitlines()
LOCKS = [lock for row in ROWS for lock in re.findall("`([^`]+)`", row.split(" | ")[0])]


def test_the_example_is_read_and_can_be_used() -> None:
    [example] = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    job = job_of(example, "plate.job.yaml")
    assert (job.machine, job.quantity, job.order, str(job.due)) == ("laser 2", 4, "4711", "2026-12-24")
    assert [next(lines_of(lock)) for lock in job.locks] == [
        "P2 first", "P2.outer before P3.outer", "#7 last", "no link P4", "P5 tab (525, 220)", "no tab P6"
    ]  # fmt: skip
    laid = with_settings(load_profile(), job.settings, job.file)
    assert (laid.material.thickness_mm, laid.rules["pierce"].options.clearance_mm) == (8.0, 1.48)


def test_the_table_has_all_that_a_lock_decides() -> None:
    assert len(LOCKS) == 13
    decided = {
        field.name for text in LOCKS for field in fields(Lock) if getattr(read_lock(text), field.name) is not None
    }
    assert {"before", "position", "entry", "direction", "linked", "tab", "zone"} <= decided
    assert decided == {field.name for field in fields(Lock)} - {"place"}  # a new decision is missing from the table


@pytest.mark.parametrize("text", LOCKS)
def test_each_lock_of_the_table_is_read(text: str) -> None:
    assert len(list(lines_of(read_lock(text)))) == 1
