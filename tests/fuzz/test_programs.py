"""Mutated programs: the check's reader and the control make the same of them."""

from collections import Counter
from pathlib import Path

import pytest

from kerfwise.tests.fuzz import compare
from kerfwise.tests.fuzz.compare import BAD, judge
from kerfwise.tests.fuzz.good_programs import good_programs
from kerfwise.tests.fuzz.programs import case, tried
from kerfwise.tests.fuzz.shrink import smallest
from kerfwise.tests.tools.amount import share_of

pytestmark = pytest.mark.linuxcnc
KEPT = sorted((Path(__file__).parent / "kept").glob("*.ngc"))


@pytest.mark.parametrize("number", range(len(good_programs())))
def test_the_good_ones_are_read_the_same(number: int) -> None:
    control, text = good_programs()[number]
    assert judge(text.encode(), control).kind == "same"


@pytest.mark.parametrize("path", KEPT, ids=lambda path: path.stem)
def test_what_was_found_stays_found(path: Path) -> None:
    verdict = judge(path.read_bytes(), path.suffixes[0][1:])
    assert verdict.kind not in BAD, verdict.text


@pytest.mark.slow
def test_mutated_programs() -> None:
    programs = share_of(300)
    done = [tried(20, number) for number in range(programs)]
    assert [(case.number, case.verdict.text, case.program) for case in done if case.verdict.kind in BAD] == []
    counted = Counter(case.verdict.kind for case in done)
    assert min(counted[kind] for kind in ("same", "both refuse", "refused as not supported")) >= programs // 20


def test_cases_are_the_same_by_seed() -> None:
    assert case(1, 7) == case(1, 7)
    assert case(1, 7) != case(2, 7)


@pytest.mark.parametrize(
    ("here", "there", "text"),
    [
        ("G0 X5", "G0 X5.002", "ends at"),
        ("M5 $0", "M5 $1", "rapid with the torch on"),
        ("G1 X20 F600", "G1 X20 F660", "feeds"),
        ("G4 P0.5", "G4 P0.6", "waits"),
        ("G3 X30 Y0 R5", "G3 X30 Y0 R5.02", "the burns are"),
        ("M5 $0", "M5 $0 $0", "the control refuses it"),
        ("G0 X0 Y9", "G0 X0 Y9\nG0 X0 Y8\nG0 X0 Y9", "travels"),
        ("$0", "$1", "tools"),
    ],
)
def test_the_comparison_can_fail(here: str, there: str, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    program = "G21 G90 G17\nG0 X10\nM3 $0 S1\nG4 P0.5\nG1 X20 F600\nG3 X30 Y0 R5\nM5 $0\nG0 X0 Y9\nG0 X5\nM5 $-1\nM2\n"
    assert judge(program.encode(), "linuxcnc-qtplasmac").kind == "same"
    real = compare.controls.run
    monkeypatch.setattr(
        compare.controls, "run", lambda read, control: real(read.replace(here.encode(), there.encode()), control)
    )
    verdict = judge(program.encode(), "linuxcnc-qtplasmac")
    assert verdict.kind == "differs"
    assert text in verdict.text


def test_a_silent_refusal_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compare.controls, "run", lambda read, control: compare.canon.Run())
    assert judge(b"G1 X5 R5\nM2\n", "linuxcnc").kind == "stricter in silence"
    assert judge(b"G18\nM2\n", "linuxcnc", stricter=True).kind == "stricter"


def test_shrinking() -> None:
    program = b"\n".join(b"%d" % k for k in range(50))
    assert smallest(program, lambda text: b"17" in text and b"33" in text.split(b"\n")) == b"17\n33"
