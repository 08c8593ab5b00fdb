"""What cannot be used is refused in one message that says what was given and what was expected."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import kerfwise
from kerfwise.tests.api.plates import PAIR

WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "a nest of another type": (lambda: kerfwise.solve(42), "nest: expected a Nest or a path, got int"),  # type: ignore[arg-type]
    "a profile of another type": (
        lambda: kerfwise.solve(PAIR, {}),  # type: ignore[arg-type]
        "profile: expected a Profile, a name or a path, got dict",
    ),
    "a file that is not there": (lambda: kerfwise.solve("nowhere.dxf"), r"^nowhere\.dxf: there is no such file$"),
    "a format that nobody knows": (lambda: kerfwise.read_nest("nest.txt"), r"expected \.dxf, \.json, \.svg"),
    "a mistyped profile": (
        lambda: kerfwise.solve(PAIR, "lasr-wood"),
        "unknown profile 'lasr-wood': did you mean 'laser-wood'",
    ),
    "a profile file that is not there": (
        lambda: kerfwise.solve(PAIR, "shop.yaml"),
        r"^shop\.yaml: cannot read the profile",
    ),
    "a mistyped engine": (lambda: kerfwise.solve(PAIR, engine="portfolo"), "did you mean 'portfolio'"),  # type: ignore[arg-type]
    "a mistyped strategy": (lambda: kerfwise.solve(PAIR, strategy="shortst"), "did you mean 'shortest'"),  # type: ignore[arg-type]
    "no work": (lambda: kerfwise.solve(PAIR, work=0), "work: expected a number over 0, got 0"),
    "a time that is none": (
        lambda: kerfwise.solve(PAIR, time_s=float("nan")),
        "time_s: expected a number over 0, got nan",
    ),
    "a gap in percent": (lambda: kerfwise.solve(PAIR, gap=5), "gap: expected a share from 0 to 1, such as 0.01, got 5"),
    "half a seed": (lambda: kerfwise.solve(PAIR, seed=0.5), "seed: expected a whole number from 0, got 0.5"),  # type: ignore[arg-type]
    "a lock on what is not there": (
        lambda: kerfwise.solve(PAIR, locks="P3.outer position first"),
        "lock 'P3.outer first': unknown contour or part 'P3.outer': did you mean 'P2.outer'",
    ),
    "a lock that is none": (
        lambda: kerfwise.solve(PAIR, locks="P1.outer soon"),
        "lock 'P1.outer soon': 'soon' decides nothing: expected ID before ID",
    ),
    "a lock of another type": (
        lambda: kerfwise.solve(PAIR, locks=[3]),
        "expected a Lock, a line of text or a mapping, got int",
    ),  # type: ignore[list-item]
    "a lock on itself": (
        lambda: kerfwise.solve(PAIR, locks=kerfwise.Lock(contour="P1.outer", before="P1.outer")),
        "P1.outer cannot be cut before itself",
    ),
    "a stop without a count": (lambda: kerfwise.solve(PAIR, resume_from="old.nc"), "in Python: resume_from and upto"),
    "a plan that is not there": (
        lambda: kerfwise.check(PAIR, "old.plan.json"),
        r"^old\.plan\.json: cannot read the plan",
    ),
    "a program that is not there": (lambda: kerfwise.check(PAIR, "old.nc"), r"^old\.nc: cannot read the program"),
    "no plan": (lambda: kerfwise.check(PAIR, None), "expected a plan, a result or a path, got NoneType"),  # type: ignore[arg-type]
    "a picture of another kind": (
        lambda: kerfwise.draw(PAIR, kind="jpg"),  # type: ignore[arg-type]
        r"must end in one of \.svg, \.png, \.pdf, \.html",
    ),
    "a contour that is not there": (
        lambda: kerfwise.draw(PAIR, contours="P9.outer"),
        "no contour 'P9.outer' in the nest",
    ),
    "nothing to compare": (lambda: kerfwise.compare(PAIR), "nothing to compare: give two plans or programs"),
    "B without A": (lambda: kerfwise.compare(PAIR, b="old.nc"), "B is given without A"),
    "a rule on and off": (
        lambda: kerfwise.compare(PAIR, with_="level-ahead", without="level-ahead"),
        "rule level-ahead is to be on and off",
    ),
    "a mistyped rule": (lambda: kerfwise.compare(PAIR, without="level-ahed"), "did you mean 'level-ahead'"),
    "a price below 0": (lambda: kerfwise.trade_off(PAIR, prices_mm=[-1]), "prices_mm: expected numbers from 0, got -1"),
}


@pytest.mark.parametrize("what", WRONG)
def test_refused(what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    call, message = WRONG[what]
    with pytest.raises(kerfwise.InputError, match=message):
        call()
