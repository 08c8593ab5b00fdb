"""Damaged inputs of every kind end in an answer; who judges that, and who makes a case small, can be trusted."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from kerfwise.tests.fuzz.__main__ import count, table
from kerfwise.tests.fuzz.inputs import seeds
from kerfwise.tests.fuzz.inputs.case import Case
from kerfwise.tests.fuzz.inputs.command_lines import verbs
from kerfwise.tests.fuzz.inputs.kinds import KINDS, SHARES, kind_of, made
from kerfwise.tests.fuzz.runs import worker as workers
from kerfwise.tests.fuzz.runs.judge import differences, findings, unfinished
from kerfwise.tests.fuzz.runs.kept import keep, kept
from kerfwise.tests.fuzz.runs.run import Ended, run
from kerfwise.tests.fuzz.runs.smaller import smaller, what
from kerfwise.tests.fuzz.runs.worker import Report, Worker, reported
from kerfwise.tests.tools.amount import share_of

KEPT = sorted((Path(__file__).parent / "kept_cases").iterdir())
CASES = {
    "profile": 150,
    "arguments": 150,
    "nest": 150,
    "svg": 80,
    "dxf": 60,
    "routing": 80,
    "model": 40,
    "python": 60,
    "job": 150,
}
"""Of the other kinds a hundred: together half a minute. A tenth of each without `--all`."""
PLAIN = Case("nest", {"nest.json": seeds.nest_bytes()}, ("facts", "nest.json"), ("nest.json",))


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    one = Worker()
    yield one
    one.stop()


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_damaged_inputs(kind: str, worker: Worker) -> None:
    cases = share_of(CASES.get(kind, 100))
    done = [worker.ask(made(kind, 77, number), again=number % 15 == 0) for number in range(cases)]
    assert [(report.case.words, report.findings) for report in done if report.findings] == []
    codes = Counter(report.code for report in done)
    assert codes[2] >= cases // 10
    assert codes[0] + codes[1] >= cases // 20


@pytest.mark.full
@pytest.mark.slow
@pytest.mark.parametrize("kind", ["pair", "chart", "list"])
def test_many_files_that_do_not_belong_together(kind: str, worker: Worker) -> None:
    """Plans and programs of other nests, charts and lists under every verb that takes them."""
    done = [worker.ask(made(kind, 78, number)) for number in range(2000)]
    assert [(report.case.words, report.findings) for report in done if report.findings] == []


@pytest.mark.slow
@pytest.mark.parametrize("number", [4, 5])
def test_a_case_in_a_process_of_its_own_gives_the_same(number: int, tmp_path: Path) -> None:
    assert reported(made("nest", 3, number), tmp_path / "case", again=True, apart=True).findings == ()


@pytest.mark.parametrize("folder", KEPT, ids=lambda folder: folder.name)
def test_what_was_found_stays_mended(folder: Path, tmp_path: Path) -> None:
    assert reported(kept(folder), tmp_path / "case").findings == ()


@pytest.mark.parametrize("kind", KINDS)
def test_cases_are_the_same_by_seed(kind: str) -> None:
    assert made(kind, 1, 7) == made(kind, 1, 7)
    assert len({repr(made(kind, seed, number)) for seed in (1, 2) for number in range(5)}) >= 8


def test_kinds_come_by_their_shares() -> None:
    names = list(KINDS)
    assert sum(SHARES.values()) == 100
    assert Counter(kind_of(number, names) for number in range(1000)) == {kind: 10 * SHARES[kind] for kind in names}
    assert {kind_of(number, ["svg"]) for number in range(20)} == {"svg"}


def test_command_lines_know_every_verb_and_write_no_rule_into_the_sources() -> None:
    assert {("solve",), ("profile", "show"), ("rules", "new"), ("bench",)} <= set(verbs())
    words = [made("arguments", 5, number).words for number in range(3000)]
    assert {line[0] for line in words if line} >= {verb[0] for verb in verbs()}
    for line in words:
        if line[:2] == ("dialects", "new"):
            assert line[2:4] == ("--output", "out.yaml")
        elif line[:1] == ("rules",) and "new" in line:
            assert line[:4] == ("rules", "new", "--into", "folder")
            assert all(there in ("folder", "nowhere", "nest.json", "/dev/null") for there in after("--into", line))


def after(option: str, line: tuple[str, ...]) -> list[str]:
    return [line[k + 1] for k, word in enumerate(line[:-1]) if word == option]


DRAWN = "note: written: o.svg: what is read so far\nkerfwise: nest.json: in mm?\n  --answer units=mm\n"
GOOD = Ended(0, "done\n", "", {"nest.json": seeds.nest_bytes()}, 0.0)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"code": 70, "err": "kerfwise: nest.json: a fault of kerfwise itself: KeyError\n"}, "own fault: "),
        ({"code": 130}, "exit code: 130"),
        ({"err": "Traceback (most recent call last):\n"}, "traceback: "),
        ({"err": "x.py:12: RuntimeWarning: overflow\n"}, "warning: x.py:12"),
        ({"code": 1, "out": ""}, "silent: "),
        ({"code": 3, "err": "kerfwise: nest.json: in mm or inches?\n"}, "question: "),
        ({"code": 2, "err": "kerfwise: a number is wrong\n"}, "refusal: no place"),
        ({"code": 2, "err": ""}, "refusal: 0 lines"),
        ({"code": 2, "err": "kerfwise: nest.json: x\nkerfwise: nest.json: y\n"}, "refusal: 2 lines"),
        ({"code": 2, "err": "Usage: x\nError: nest.json\n"}, "refusal: as wrong usage"),
        ({"out": "part \x1b[31m\n"}, "obeyed: '\\x1b'"),
        ({"err": "part \u202e\n"}, "obeyed: '\\u202e'"),
        ({"files": {}}, "lost: nest.json"),
        ({"files": {**GOOD.files, "out.json": b'{"a": '}}, "half written: out.json"),
        ({"files": {**GOOD.files, "out.svg": b"<svg>"}}, "half written: out.svg"),
        ({"files": {**GOOD.files, "out.png": b"\x89PNG"}}, "half written: out.png"),
        ({"files": {**GOOD.files, "out.nc": b"G0 X1"}}, "half written: out.nc"),
        ({"files": {**GOOD.files, "out.nc": "(\u202e)\n".encode()}}, "half written: out.nc"),
        ({"files": {**GOOD.files, ".kerfwise-ab12": b""}}, "half written: .kerfwise-ab12"),
        ({"code": 2, "err": "kerfwise: nest.json: x\n", "files": {**GOOD.files, "o.nc": b"\n"}}, "refused and written"),
        (
            {"code": 3, "err": DRAWN, "files": {**GOOD.files, "o.svg": b"<a/>", "o.nc": b"\n"}},
            "refused and written: ['o.nc",
        ),
        ({"code": 2, "err": DRAWN, "files": {**GOOD.files, "o.svg": b"<a/>"}}, "refused and written"),
    ],
)
def test_the_judge_finds_what_is_wrong(wrong: dict[str, object], said: str) -> None:
    assert findings(PLAIN, GOOD) == []
    found = findings(PLAIN, replace(GOOD, **wrong))  # type: ignore[arg-type]
    assert any(text.startswith(said) for text in found), found


def test_a_refusal_with_its_place_is_none() -> None:
    assert findings(PLAIN, replace(GOOD, code=2, err="note: x\nkerfwise: nest.json:1:2: wrong\n  - more\n")) == []
    assert unfinished("a.png", b"\x89PNG....IEND\xaeB`\x82") == ""


def test_a_picture_of_what_an_open_question_is_about_is_no_fault() -> None:
    assert findings(PLAIN, replace(GOOD, code=3, err=DRAWN, files={**GOOD.files, "o.svg": b"<a/>"})) == []


def test_the_job_that_is_damaged_is_a_good_one(worker: Worker) -> None:
    case = next(case for case in (made("job", 1, number) for number in range(100)) if case.words[0] == "solve")
    whole = yaml.safe_dump(seeds.JOB, sort_keys=False).encode()
    assert worker.ask(replace(case, files={**case.files, "nest.job.yaml": whole})).code == 0


def test_two_runs_are_compared() -> None:
    assert differences(PLAIN, GOOD, replace(GOOD, seconds=3.0)) == []
    for other in (replace(GOOD, code=1), replace(GOOD, out="else\n"), replace(GOOD, err="x"), replace(GOOD, files={})):
        assert len(differences(PLAIN, GOOD, other)) == 1
        assert differences(replace(PLAIN, words=(*PLAIN.words, "--time-limit", "2")), GOOD, other) == []


def test_an_own_fault_is_found_with_its_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from kerfwise.jobs.nest_job import request

    monkeypatch.setattr(request, "plant_of", lambda *names: {}[names])
    report = reported(PLAIN, tmp_path / "case")
    assert report.code == 70
    assert [text.partition(": ")[0] for text in report.findings] == ["own fault", "at"]
    assert what(report) >= {"own fault"}
    monkeypatch.setattr(request, "plant_of", lambda *names: (_ for _ in ()).throw(MemoryError()))
    assert reported(PLAIN, tmp_path / "case").findings[0].startswith("over 3 GB: own fault")
    monkeypatch.setattr(workers, "run", lambda case, folder: {}[0])
    assert reported(PLAIN, tmp_path / "case").findings[0].startswith("traceback: KeyError")


@pytest.mark.full
def test_a_case_that_hangs_or_dies_ends_the_process_and_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    waits = tmp_path / "waits.yaml"
    os.mkfifo(waits)
    one = Worker()
    try:
        one.ask(PLAIN)  # all is loaded: what takes long now is the case
        monkeypatch.setattr(workers, "MOST_S", 3.0)
        hanging = one.ask(replace(PLAIN, words=(*PLAIN.words, "-p", str(waits))))
        assert hanging.findings[0].startswith("hang: ")
        assert "encoder/files.py" in hanging.findings[0]
        monkeypatch.setattr(workers, "MOST_S", 60.0)
        assert (one.ask(PLAIN).code, one.ask(PLAIN).findings) == (0, ())
        one._process.kill()
        assert one.ask(PLAIN).findings[0].startswith("died: ")
        assert one.ask(PLAIN).code == 0
    finally:
        one.stop()


def test_a_case_is_made_small() -> None:
    def ask(case: Case) -> Report:
        shows = b"bad" in (case.files["a"] or b"") and "-v" in case.words
        return Report(case, 70, ("own fault: x", "at: y.py:1") if shows else ())

    case = Case("nest", {"a": b"one\ntwo bad three\nfour\n" * 3, "b": b"", "c": b""}, ("v", "a", "-v", "b"), ("a",))
    small = smaller(ask(case), ask).case
    assert small.files == {"a": b"bad", "b": b""}
    assert small.words == case.words
    words = smaller(ask(replace(case, damaged=())), ask).case
    assert words.words == ("v", "a", "-v")


def test_a_case_is_kept_and_read_again(tmp_path: Path) -> None:
    case = made("arguments", 5, 3)
    keep(Report(case, 70, ("own fault: x",)), tmp_path / "case")
    assert kept(tmp_path / "case") == case


def test_a_file_in_the_place_of_the_folder(tmp_path: Path) -> None:
    assert run(PLAIN, tmp_path / "case").code == 0
    assert run(replace(PLAIN, files={"nest.json": None}), tmp_path / "case").code == 2


def test_the_table() -> None:
    counted: Counter[tuple[str, str]] = Counter()
    for kind, code, found in (
        ("svg", 0, ()),
        ("svg", 2, ()),
        ("dxf", None, ("hang: x",)),
        ("dxf", 70, ("own fault: x",)),
    ):
        count(kind, Report(PLAIN, code, found), counted)
    rows = [row.split() for row in table(["svg", "dxf"], counted).splitlines()[1:]]
    assert rows == [
        ["svg", "2", "1", "0", "1", "0", "0", "0", "0"],
        ["dxf", "2", "0", "0", "0", "2", "1", "1", "0"],
        ["all", "4", "1", "0", "1", "2", "1", "1", "0"],
    ]
