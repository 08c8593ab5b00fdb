"""Job files: what they say, and what is wrong in them, by line and column."""

from __future__ import annotations

import datetime
import hashlib
import json
from importlib import resources
from pathlib import Path

import jsonschema
import pytest
import yaml

from kerfwise.encoder.errors import InputError
from kerfwise.jobs.nest_job import job_beside, read_job
from kerfwise.jobs.nest_job.job import Job, job_of, job_schema, schema_text
from kerfwise.rules.lock import Lock

WHOLE = """profile: plants/laser.yaml
machine: big laser
quantity: 3
order: 4711
due: 2026-12-24
locks:
  - P2 first
  - {contour: '#7', before: P3.outer, direction: cw}
tabs: {P3: off, P4: [10, 20], P5: [[1, 2], [3, 4]]}
set:
  rules.pierce.clearance: 1.48 mm
  material: {thickness: 6 mm}
"""
WRONG = {
    "quantity: 0": "1:11: job file.quantity: expected a whole number from 1 to 100000, got '0'",
    "quantity: some": "1:11: job file.quantity: expected a whole number from 1 to 100000, got 'some'",
    "due: tomorrow": "1:6: job file.due: expected a day such as 2026-12-24 (year-month-day), got 'tomorrow'",
    "due: 2026-02-30": "1:6: job file.due: there is no such day as 2026-02-30: day is out of range for month",
    "quantty: 3": "1:1: job file: unknown key 'quantty': did you mean 'quantity'? "
    "(valid: answers, date, due, locks, machine, number, order, profile, quantity, set, tabs)",
    "- P2 first": "1:1: job file: expected a mapping (key: value), got a list of 1",
    "locks: P2 first": "1:8: locks: expected a list, got 'P2 first'",
    "locks:\n  - P2 first\n  - P3 frist": "3:5: locks[2]: lock 'P3 frist': 'frist': did you mean 'first'? expected ID",
    "locks:\n  - P2 first\n  - {contur: P3}": "3:6: locks[2]: unknown key 'contur': did you mean 'contour'?",
    "locks:\n  - {contour: P3}": "2:5: locks[1]: what can be locked of a contour is before, position, entry",
    "locks:\n  - #7 first": "2:4: locks[1]: expected a lock, got nothing; write '#7 first' in quotes",
    "tabs: {P2: on}": "1:12: tabs.P2: expected a point [x, y] in mm, or the word 'off', got 'on'",
    "tabs: {P2: [[1, 2], 3]}": "1:21: tabs.P2: expected a point [x, y] in mm, or the word 'off', got '3'",
    "set: {leads.lead_in: }": "1:7: set: expected a value for 'leads.lead_in'",
    "set: [3]": "1:6: set: expected a mapping (key: value), got a list of 1",
    "order: 1\norder: 2": "2:1: job file: key 'order' is given twice",
    "a: b: c": "1:5: not YAML: mapping values are not allowed here",
    "profile: ''": "1:10: job file.profile: expected a text, got ''",
}


def test_the_whole_file() -> None:
    job = job_of(WHOLE, "nests/plate.job.yaml")
    assert (job.name, job.machine, job.quantity, job.order) == ("plate.job.yaml", "big laser", 3, "4711")
    assert (job.due, job.profile_path) == (datetime.date(2026, 12, 24), str(Path("nests/plants/laser.yaml")))
    assert job.locks == (
        Lock(contour="P2", position="first"),
        Lock(contour="#7", before="P3.outer", direction="cw"),
        Lock(contour="P3", tab="off"),
        Lock(contour="P4", tab=(10.0, 20.0)),
        Lock(contour="P5", tab=(1.0, 2.0)),
        Lock(contour="P5", tab=(3.0, 4.0)),
    )
    assert [str(lock.place) for lock in job.locks[:3]] == [f"nests/plate.job.yaml:{at}" for at in ("7:5", "8:5", "9:8")]
    assert [str(one) for one in job.settings] == ["rules.pierce.clearance=1.48 mm", "material={thickness: 6 mm}"]
    assert str(job.said_at["due"]) == "nests/plate.job.yaml:5:1"


@pytest.mark.parametrize("text", ["", "# nothing yet\n", "locks:\ntabs:\nset:\n"])
def test_a_file_that_says_nothing(text: str) -> None:
    assert job_of(text, "plate.job.yaml") == Job(file="plate.job.yaml")


@pytest.mark.parametrize("text", WRONG)
def test_what_is_wrong_is_said_in_place(text: str) -> None:
    with pytest.raises(InputError) as caught:
        job_of(text, "plate.job.yaml")
    assert str(caught.value).startswith(f"plate.job.yaml:{WRONG[text]}")


def test_all_mistakes_at_once() -> None:
    with pytest.raises(InputError) as caught:
        job_of("quantity: 0\ndue: soon\nlocks: [P2]\nset: {a: }\n", "plate.job.yaml")
    assert (caught.value.line, len(caught.value.details)) == (1, 3)


def test_the_file_beside_a_nest(tmp_path: Path) -> None:
    nest = tmp_path / "plate.dxf"
    assert job_beside(nest) is None
    (tmp_path / "plate.job.yaml").write_text("quantity: 2\n", encoding="utf-8")
    found = job_beside(nest)
    assert found == tmp_path / "plate.job.yaml"
    job = read_job(found)
    assert (job.quantity, job.sha256) == (2, hashlib.sha256(b"quantity: 2\n").hexdigest())
    assert job_beside(tmp_path / "plate.json") == found
    assert job_beside("") is None


@pytest.mark.parametrize(
    ("content", "message"), [(b"\xff\xfe\x00", "not a job file: the file is not UTF-8 text"), (None, "No such file")]
)
def test_files_that_cannot_be_read(tmp_path: Path, content: bytes | None, message: str) -> None:
    file = tmp_path / "plate.job.yaml"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_job(file)


def test_the_published_schema_is_up_to_date_and_says_what_the_reader_does() -> None:
    published = resources.files("kerfwise.jobs.nest_job") / "job.schema.json"
    text = published.read_text(encoding="utf-8")
    assert text == schema_text(), "run python -m kerfwise.jobs.nest_job.job"
    validator = jsonschema.Draft202012Validator(json.loads(text))
    jsonschema.Draft202012Validator.check_schema(job_schema())
    validator.validate({**yaml.load(WHOLE, Loader=yaml.BaseLoader), "quantity": 3, "tabs": {"P3": "off", "P4": [1, 2]}})
    for wrong in ({"quantity": 0}, {"quantty": 1}, {"due": "tomorrow"}, {"locks": [3]}, {"tabs": {"P2": "on"}}):
        assert not validator.is_valid(wrong), wrong
